// PLY 1.0 (Turk, 1994): the vertex element, which has to be the first.
#include <map>
#include <vector>

#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"

namespace lf::record {
namespace {

class PlyReader {
 public:
  PlyReader(const std::string& name, std::string_view bytes) : name_(name), lines_(bytes) {}

  CloudFile read() {
    read_header();
    columns_ = PointColumns::from_names(names_);
    if (!columns_.complete()) refuse("has no vertex properties x, y and z");
    if (format_ == "ascii") {
      read_ascii();
    } else {
      read_binary(lines_.rest(), format_ == "binary_big_endian" ? ByteOrder::big : ByteOrder::little);
    }
    return std::move(cloud_);
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const { throw InputError(name_, lines_.line_number(), message); }
  [[noreturn]] void refuse_truncated(std::size_t found) const {
    throw InputError(name_, 0, "is truncated: " + std::to_string(found) + " of " + std::to_string(points_) + " points");
  }

  void read_header() {
    std::string_view line;
    if (!lines_.next(line) || line != "ply") refuse("is no PLY file");
    std::string element;
    while (true) {
      if (!lines_.next(line) || line.size() > 4096) refuse("has no PLY header that ends with end_header");
      const auto words = words_of(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() == 3) {
        format_ = words[1];
      } else if (words[0] == "element" && words.size() == 3) {
        if (element.empty() && words[1] != "vertex") refuse("its first element is not vertex");
        element = words[1];
        if (element == "vertex" && !count_from_text(words[2], points_)) refuse("the number of vertices is not a number");
      } else if (words[0] == "property" && words.size() >= 3) {
        if (element == "vertex") read_property(words);
      } else {
        refuse("is no line of a PLY header");
      }
    }
    if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian")
      refuse("unknown format '" + format_ + "'");
    if (points_ > std::size_t{1} << 31) refuse("the number of vertices is out of range");
  }

  void read_property(const std::vector<std::string_view>& words) {
    static const std::map<std::string, NumberType, std::less<>> known{
        {"char", NumberType::i8},   {"uchar", NumberType::u8},   {"short", NumberType::i16},   {"ushort", NumberType::u16},
        {"int", NumberType::i32},   {"uint", NumberType::u32},   {"float", NumberType::f32},   {"double", NumberType::f64},
        {"int8", NumberType::i8},   {"uint8", NumberType::u8},   {"int16", NumberType::i16},   {"uint16", NumberType::u16},
        {"int32", NumberType::i32}, {"uint32", NumberType::u32}, {"float32", NumberType::f32}, {"float64", NumberType::f64}};
    const auto type = known.find(words[1]);
    if (words.size() != 3 || type == known.end()) refuse("a vertex property that is not a plain number");
    types_.push_back(type->second);
    names_.emplace_back(words[2]);
  }

  void read_ascii() {
    std::string_view line;
    for (std::size_t row = 0; row < points_; ++row) {
      if (!lines_.next(line)) refuse_truncated(row);
      const auto words = words_of(line);
      if (words.size() != names_.size()) refuse("has " + std::to_string(words.size()) + " numbers, not " + std::to_string(names_.size()));
      const auto value = [&](std::size_t column) {
        double number = 0;
        if (column != PointColumns::none && !number_from_text(words[column], number)) {
          refuse("'" + std::string(words[column]) + "' is not a number");
        }
        return number;
      };
      add_point(cloud_, value(columns_.x), value(columns_.y), value(columns_.z), value(columns_.intensity));
    }
  }

  void read_binary(std::string_view bytes, ByteOrder order) {
    std::vector<std::size_t> offsets;
    std::size_t size = 0;
    for (const NumberType type : types_) {
      offsets.push_back(size);
      size += size_of(type);
    }
    if (bytes.size() / size < points_) refuse_truncated(bytes.size() / size);
    cloud_.points.reserve(points_);
    for (std::size_t row = 0; row < points_; ++row) {
      const auto value = [&](std::size_t column) {
        return column == PointColumns::none ? 0 : number_at(bytes.data() + row * size + offsets[column], types_[column], order);
      };
      add_point(cloud_, value(columns_.x), value(columns_.y), value(columns_.z), value(columns_.intensity));
    }
  }

  std::string name_;
  LineReader lines_;
  std::string format_;
  std::size_t points_ = 0;
  std::vector<std::string> names_;
  std::vector<NumberType> types_;
  PointColumns columns_;
  CloudFile cloud_;
};

}  // namespace

CloudFile read_ply(const std::string& name, std::string_view bytes) { return PlyReader(name, bytes).read(); }

}  // namespace lf::record
