#include "shared/mesh/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "shared/input_error.hpp"

namespace lf::mesh {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

}  // namespace

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return result + (text.size() > longest ? "...'" : "'");
}

std::string shown(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr};
}

std::string shown(const Vec3& place) { return "(" + shown(place.x()) + ", " + shown(place.y()) + ", " + shown(place.z()) + ")"; }

std::string counted(std::size_t count, std::string_view noun) {
  if (count == 1) return std::string("1 ").append(noun);
  if (noun.ends_with("ex")) return std::to_string(count).append(" ").append(noun.substr(0, noun.size() - 2)).append("ices");
  return std::to_string(count).append(" ").append(noun).append("s");
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

bool Lines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  is_cut_ = end == std::string_view::npos;
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(is_cut_ ? rest_.size() : end + 1);
  ++number_;
  return true;
}

std::string_view Words::next() {
  std::size_t begin = 0;
  while (begin < rest_.size() && is_space(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !is_space(rest_[end])) ++end;
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::optional<double> number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

bool is_coordinate(double value) { return std::abs(value) <= most_coordinate; }

double coordinate(std::string_view word, std::string_view noun, const std::string& file, int line) {
  if (word.empty()) throw InputError(file, line, std::string(noun) + " lacks a coordinate: it has x, y and z; was the file cut off?");
  const std::optional<double> value = number(word);
  if (!value)
    throw InputError(file, line,
                     std::string(noun) + " has " + shown(word) + ", which is no number: " +
                         (word.find(',') == std::string_view::npos ? "correct it, or export the file anew"
                                                                   : "write a decimal point in place of the comma"));
  if (!is_coordinate(*value))
    throw InputError(file, line,
                     std::string(noun) + " has the coordinate " + shown(word) + ": it has to be finite, and below 1e12; repair the mesh");
  return *value;
}

void refuse_zero_bytes(std::string_view text, const std::string& file) {
  const std::size_t zero = text.find('\0');
  if (zero == std::string_view::npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
  throw InputError(file, static_cast<int>(line), "holds a byte 0, which no text has: save it as UTF-8, or export it anew");
}

}  // namespace lf::mesh
