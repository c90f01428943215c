// PCD 0.7, https://pointclouds.org/documentation/tutorials/pcd_file_format.html. Reading it here keeps PCL out, and a damaged file harmless.
#include <algorithm>
#include <map>
#include <vector>

#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"

namespace lf::record {
namespace {

// LZF (Lehmann's liblzf): a control byte below 32 announces that many plus one literal bytes; else its upper three bits and, where these
// are 7, another byte give a length less two, and its lower five bits and the next byte a distance back less one. False when the data does not fit.
bool decode_lzf(std::string_view in, std::vector<char>& out) {
  std::size_t read = 0, written = 0;
  while (read < in.size()) {
    const unsigned control = static_cast<unsigned char>(in[read++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > in.size() - read || length > out.size() - written) return false;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(read), length, out.begin() + static_cast<std::ptrdiff_t>(written));
      read += length;
      written += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7 && read < in.size()) length += static_cast<unsigned char>(in[read++]);
    length += 2;
    if (read >= in.size()) return false;
    const std::size_t back = (static_cast<std::size_t>(control & 31) << 8 | static_cast<unsigned char>(in[read++])) + 1;
    if (back > written || length > out.size() - written) return false;
    for (std::size_t i = 0; i < length; ++i, ++written) out[written] = out[written - back];  // may overlap itself
  }
  return written == out.size();
}

struct Header {
  std::vector<std::string> names;
  std::vector<NumberType> types;
  std::vector<std::size_t> counts;
  std::size_t points = 0;
  std::string data;
};

class PcdReader {
 public:
  PcdReader(const std::string& name, std::string_view bytes) : name_(name), lines_(bytes) {}

  CloudFile read() {
    read_header();
    columns_ = PointColumns::from_names(header_.names);
    if (!columns_.complete()) refuse("has no fields x, y and z");
    if (header_.data == "ascii") {
      read_ascii();
    } else if (header_.data == "binary") {
      read_rows(lines_.rest());
    } else if (header_.data == "binary_compressed") {
      read_compressed(lines_.rest());
    } else {
      refuse("unknown DATA '" + header_.data + "'");
    }
    return std::move(cloud_);
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const { throw InputError(name_, lines_.line_number(), message); }
  [[noreturn]] void refuse_truncated(std::size_t found) const {
    throw InputError(name_, 0, "is truncated: " + std::to_string(found) + " of " + std::to_string(header_.points) + " points");
  }

  void read_header() {
    std::map<std::string, std::vector<std::string_view>, std::less<>> entries;
    std::string_view line;
    while (!entries.contains("DATA")) {
      if (!lines_.next(line)) refuse("has no PCD header that ends with DATA");
      if (line.size() > 4096) refuse("is no PCD file");
      const auto words = words_of(line);
      if (words.empty() || words[0].starts_with('#')) continue;
      static constexpr std::string_view known[] = {"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                                                   "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
      if (std::find(std::begin(known), std::end(known), words[0]) == std::end(known)) refuse("is no line of a PCD header");
      entries[std::string(words[0])] = {words.begin() + 1, words.end()};
    }
    if (entries.contains("COLUMNS")) entries["FIELDS"] = entries["COLUMNS"];
    for (const std::string_view field : entries["FIELDS"]) header_.names.emplace_back(field);
    read_types(entries["SIZE"], entries["TYPE"], entries["COUNT"]);
    read_size(entries["POINTS"], entries["WIDTH"], entries["HEIGHT"]);
    if (!entries["DATA"].empty()) header_.data = entries["DATA"][0];
  }

  void read_types(const std::vector<std::string_view>& sizes, const std::vector<std::string_view>& types,
                  const std::vector<std::string_view>& counts) {
    const std::size_t fields = header_.names.size();
    if (sizes.size() != fields || types.size() != fields || (!counts.empty() && counts.size() != fields)) {
      refuse("FIELDS, SIZE, TYPE and COUNT do not go together");
    }
    static const std::map<std::string, NumberType, std::less<>> known{
        {"I1", NumberType::i8},  {"U1", NumberType::u8},  {"I2", NumberType::i16}, {"U2", NumberType::u16}, {"I4", NumberType::i32},
        {"U4", NumberType::u32}, {"I8", NumberType::i64}, {"U8", NumberType::u64}, {"F4", NumberType::f32}, {"F8", NumberType::f64}};
    for (std::size_t i = 0; i < fields; ++i) {
      const auto type = known.find(std::string(types[i]).append(sizes[i]));
      if (type == known.end()) refuse("field " + header_.names[i] + " has an unknown type");
      header_.types.push_back(type->second);
      std::size_t count = 1;
      if (!counts.empty() && (!count_from_text(counts[i], count) || count == 0 || count > 65536)) refuse("a COUNT is out of range");
      header_.counts.push_back(count);
    }
  }

  void read_size(const std::vector<std::string_view>& points, const std::vector<std::string_view>& width,
                 const std::vector<std::string_view>& height) {
    constexpr std::size_t most = std::size_t{1} << 31;
    std::size_t w = 0, h = 1;
    const bool sized = width.size() == 1 && count_from_text(width[0], w) && (height.empty() || count_from_text(height[0], h));
    if (sized && w <= most && h <= most) header_.points = w * h;
    if (!points.empty() && !count_from_text(points[0], header_.points)) refuse("POINTS is not a number");
    if ((points.empty() && !sized) || header_.points > most) refuse("POINTS is missing or out of range");
    if (sized && w * h != header_.points) refuse("WIDTH x HEIGHT is not POINTS");
  }

  std::size_t row_size() const {
    std::size_t size = 0;
    for (std::size_t i = 0; i < header_.types.size(); ++i) size += size_of(header_.types[i]) * header_.counts[i];
    return size;
  }

  void read_ascii() {
    std::size_t width = 0;
    std::vector<std::size_t> first;  // column of each field
    for (const std::size_t count : header_.counts) {
      first.push_back(width);
      width += count;
    }
    std::string_view line;
    for (std::size_t row = 0; row < header_.points; ++row) {
      std::vector<std::string_view> words;
      while (words.empty()) {
        if (!lines_.next(line)) refuse_truncated(row);
        words = words_of(line);
      }
      if (words.size() != width) refuse("has " + std::to_string(words.size()) + " numbers, not " + std::to_string(width));
      const auto value = [&](std::size_t field) {
        double number = 0;
        if (field != PointColumns::none && !number_from_text(words[first[field]], number)) {
          refuse("'" + std::string(words[first[field]]) + "' is not a number");
        }
        return number;
      };
      add_point(cloud_, value(columns_.x), value(columns_.y), value(columns_.z), value(columns_.intensity));
    }
  }

  void read_rows(std::string_view bytes) {
    const std::size_t size = row_size();
    const std::size_t whole = size > 0 ? bytes.size() / size : 0;
    if (whole < header_.points) refuse_truncated(whole);
    std::vector<std::size_t> offsets;
    std::size_t offset = 0;
    for (std::size_t i = 0; i < header_.types.size(); ++i) {
      offsets.push_back(offset);
      offset += size_of(header_.types[i]) * header_.counts[i];
    }
    take_points([&](std::size_t row, std::size_t field) { return bytes.data() + row * size + offsets[field]; });
  }

  // All values of a field stand together.
  void read_compressed(std::string_view bytes) {
    if (bytes.size() < 8) refuse_truncated(0);
    const auto compressed = static_cast<std::size_t>(number_at(bytes.data(), NumberType::u32, ByteOrder::little));
    const auto uncompressed = static_cast<std::size_t>(number_at(bytes.data() + 4, NumberType::u32, ByteOrder::little));
    if (uncompressed != header_.points * row_size()) throw InputError(name_, 0, "its compressed block does not have the header's size");
    if (compressed > bytes.size() - 8) throw InputError(name_, 0, "is truncated within its compressed block");
    // LZF writes at most 264 bytes for 3: a header that asks for more memory than that lies.
    std::vector<char> block(uncompressed <= 88 * compressed ? uncompressed : 0);
    if (block.size() != uncompressed || !decode_lzf(bytes.substr(8, compressed), block)) {
      throw InputError(name_, 0, "its compressed block is damaged");
    }
    std::vector<std::size_t> starts, strides;
    std::size_t start = 0;
    for (std::size_t i = 0; i < header_.types.size(); ++i) {
      starts.push_back(start);
      strides.push_back(size_of(header_.types[i]) * header_.counts[i]);
      start += strides[i] * header_.points;
    }
    take_points([&](std::size_t row, std::size_t field) { return block.data() + starts[field] + row * strides[field]; });
  }

  template <class Place>
  void take_points(const Place& place) {
    const auto value = [&](std::size_t row, std::size_t field) {
      return field == PointColumns::none ? 0 : number_at(place(row, field), header_.types[field], ByteOrder::little);
    };
    cloud_.points.reserve(header_.points);
    for (std::size_t row = 0; row < header_.points; ++row) {
      add_point(cloud_, value(row, columns_.x), value(row, columns_.y), value(row, columns_.z), value(row, columns_.intensity));
    }
  }

  std::string name_;
  LineReader lines_;
  Header header_;
  PointColumns columns_;
  CloudFile cloud_;
};

}  // namespace

CloudFile read_pcd(const std::string& name, std::string_view bytes) { return PcdReader(name, bytes).read(); }

}  // namespace lf::record
