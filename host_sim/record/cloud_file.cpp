#include "host_sim/record/cloud_file.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::record {
namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The first `size` bytes as one number.
std::uint64_t bits_at(const char* bytes, std::size_t size, ByteOrder order) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t place = order == ByteOrder::little ? i : size - 1 - i;
    bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * place);
  }
  return bits;
}

}  // namespace

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::i8:
    case NumberType::u8: return 1;
    case NumberType::i16:
    case NumberType::u16: return 2;
    case NumberType::i32:
    case NumberType::u32:
    case NumberType::f32: return 4;
    default: return 8;
  }
}

double number_at(const char* bytes, NumberType type, ByteOrder order) {
  const std::uint64_t bits = bits_at(bytes, size_of(type), order);
  switch (type) {
    case NumberType::i8: return static_cast<std::int8_t>(bits);
    case NumberType::i16: return static_cast<std::int16_t>(bits);
    case NumberType::i32: return static_cast<std::int32_t>(bits);
    case NumberType::i64: return static_cast<double>(static_cast<std::int64_t>(bits));
    case NumberType::f32: return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case NumberType::f64: return std::bit_cast<double>(bits);
    default: return static_cast<double>(bits);
  }
}

bool number_from_text(std::string_view text, double& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error != std::errc::invalid_argument && end == text.data() + text.size() && !text.empty();
}

bool count_from_text(std::string_view text, std::size_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

bool LineReader::next(std::string_view& line) {
  if (position_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  line = text_.substr(position_, end - position_);
  if (line.ends_with('\r')) line.remove_suffix(1);
  position_ = std::min(end + 1, text_.size());
  ++number_;
  return true;
}

std::vector<std::string_view> words_of(std::string_view line, std::string_view separators) {
  const auto trimmed = [](std::string_view word) {
    while (!word.empty() && (word.front() == ' ' || word.front() == '\t')) word.remove_prefix(1);
    while (!word.empty() && (word.back() == ' ' || word.back() == '\t')) word.remove_suffix(1);
    return word;
  };
  const bool blanks = separators.find(' ') != separators.npos;
  std::vector<std::string_view> words;
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t end = line.find_first_of(separators);
    words.push_back(trimmed(line.substr(0, end)));
    if (end == line.npos) break;
    line = line.substr(end + 1);
    if (blanks) line = trimmed(line);
    if (!blanks && line.empty()) words.emplace_back();  // "1,2," has an empty third
  }
  return words;
}

PointColumns PointColumns::from_names(const std::vector<std::string>& names) {
  PointColumns columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = lower_case(names[i]);
    if (name == "x") columns.x = i;
    if (name == "y") columns.y = i;
    if (name == "z") columns.z = i;
    if (name == "intensity") columns.intensity = i;
  }
  return columns;
}

void add_point(CloudFile& cloud, double x, double y, double z, double intensity) {
  CloudPoint point;
  point.p_m = Vec3(x, y, z).cast<float>();
  point.amplitude = std::isfinite(intensity) ? static_cast<float>(intensity) : 0;
  if (point.p_m.allFinite()) {
    cloud.points.push_back(point);
  } else {
    ++cloud.skipped;
  }
}

CloudFile read_cloud_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string ending = lower_case(path.extension().string());
  const bool known = ending == ".pcd" || ending == ".ply" || ending == ".csv" || ending == ".xyz";
  if (!known) throw InputError(name, 0, "is not a cloud: .pcd, .ply, .csv or .xyz is read");
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw unreadable(path);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (ending == ".pcd") return read_pcd(name, bytes);
  if (ending == ".ply") return read_ply(name, bytes);
  return ending == ".csv" ? read_csv(name, bytes) : read_xyz(name, bytes);
}

}  // namespace lf::record
