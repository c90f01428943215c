#include "host_sim/app/checks.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>

namespace lf::app {

namespace {

template <class Number>
std::optional<Number> read(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

std::optional<double> finite(const std::string& text) {
  const std::optional<double> number = read<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

}  // namespace

std::string check_seed(const std::string& text) {
  if (read<std::uint64_t>(text)) return "";
  return "takes a whole number from 0 to 18446744073709551615, not " + text;
}

std::string check_positive(const std::string& text) {
  const std::optional<double> number = finite(text);
  return number && *number > 0 ? "" : "takes a number above 0, not " + text;
}

std::string check_filled(const std::string& text) {
  return text.find_first_not_of(" \t") != std::string::npos ? "" : "is empty: give it a value, or leave the option out";
}

std::string check_printable(const std::string& text) {
  const bool printable = std::none_of(text.begin(), text.end(), [](unsigned char letter) { return letter < ' ' || letter == 0x7F; });
  return printable ? check_filled(text) : "has a letter that cannot be printed";
}

std::string check_folder(const std::string& text) {
  std::error_code error;
  return std::filesystem::is_directory(text, error) ? "" : "takes a folder that is there, not '" + text + "': correct its path, or make it";
}

std::string check_png(const std::string& text) {
  std::string ending = std::filesystem::path(text).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending.empty() || ending == ".png" ? "" : "takes the name of a .png, not " + text;
}

std::function<std::string(const std::string&)> within(double low, double high) {
  return [low, high](const std::string& text) -> std::string {
    const std::optional<double> number = finite(text);
    if (number && *number >= low && *number <= high) return "";
    char range[64];
    std::snprintf(range, sizeof range, "takes a number from %g to %g, not ", low, high);
    return range + text;
  };
}

}  // namespace lf::app
