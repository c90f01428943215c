// What the readers of cloud files share: numbers as files store them, lines of text with their number, and points by the names of their columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/record/cloud_file.hpp"

namespace lf::record {

enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
enum class ByteOrder : std::uint8_t { little, big };

std::size_t size_of(NumberType type);
double number_at(const char* bytes, NumberType type, ByteOrder order);
// Decimal text, "nan" and "inf" too; false when anything else is in it.
bool number_from_text(std::string_view text, double& value);
// Not negative, without a sign; false when it is not that.
bool count_from_text(std::string_view text, std::size_t& value);

// Lines without their ends (\n or \r\n), counted from 1.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  bool next(std::string_view& line);
  int line_number() const { return number_; }
  std::string_view rest() const { return text_.substr(position_); }  // from after the last line given

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  int number_ = 0;
};

// Split at any of `separators`; runs of blanks and tabs count as one.
std::vector<std::string_view> words_of(std::string_view line, std::string_view separators = " \t");

// Which columns of a row are x, y, z and intensity.
struct PointColumns {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t x = none, y = none, z = none, intensity = none;

  // By names, whatever their case.
  static PointColumns from_names(const std::vector<std::string>& names);
  bool complete() const { return x != none && y != none && z != none; }
};

// Keeps the point, or counts it as skipped when it is not finite.
void add_point(CloudFile& cloud, double x, double y, double z, double intensity);

// `name` is for messages.
CloudFile read_pcd(const std::string& name, std::string_view bytes);
CloudFile read_ply(const std::string& name, std::string_view bytes);
CloudFile read_csv(const std::string& name, std::string_view bytes);
CloudFile read_xyz(const std::string& name, std::string_view bytes);

}  // namespace lf::record
