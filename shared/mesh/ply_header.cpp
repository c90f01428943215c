#include "shared/mesh/ply_header.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "shared/input_error.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

struct TypeName {
  std::string_view name, other_name;
  PlyType type;
  std::size_t bytes;
};
// In the order of PlyType.
constexpr std::array<TypeName, 8> types{{{"char", "int8", PlyType::int8, 1},
                                         {"uchar", "uint8", PlyType::uint8, 1},
                                         {"short", "int16", PlyType::int16, 2},
                                         {"ushort", "uint16", PlyType::uint16, 2},
                                         {"int", "int32", PlyType::int32, 4},
                                         {"uint", "uint32", PlyType::uint32, 4},
                                         {"float", "float32", PlyType::float32, 4},
                                         {"double", "float64", PlyType::float64, 8}}};
constexpr std::size_t most_elements = 64, most_properties = 256;  // real files have ten and twenty

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file) : lines_(bytes), file_(file) {}

  PlyHeader read() {
    if (!lines_.next() || Words(lines_.line()).next() != "ply")
      refuse("does not begin with 'ply': it is damaged, or no PLY; export it anew");
    bool has_format = false;
    for (;;) {
      if (!lines_.next()) refuse("has no end_header: it was cut off; export it anew");
      Words words(lines_.line());
      const std::string_view keyword = words.next();
      if (keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "end_header") break;
      if (keyword == "format") {
        if (has_format) refuse("states its format a second time: remove one");
        read_format(words);
        has_format = true;
      } else if (keyword == "element") {
        read_element(words);
      } else if (keyword == "property") {
        read_property(words);
      } else {
        refuse("has " + shown(keyword) + " in its header, which PLY has not: correct it, or export the file anew");
      }
      if (const std::string_view more = words.next(); !more.empty())
        refuse("has " + shown(more) + " behind what the line says: export the file anew");
    }
    if (lines_.is_cut()) refuse("ends with its header: it was cut off; export it anew");
    if (!has_format) refuse("states no format: export it anew");
    header_.body = lines_.rest();
    header_.lines = lines_.number();
    check_size();
    return header_;
  }

 private:
  void read_format(Words& words) {
    const std::string_view encoding = words.next(), version = words.next();
    if (encoding == "ascii")
      header_.encoding = PlyEncoding::text;
    else if (encoding == "binary_little_endian")
      header_.encoding = PlyEncoding::little_endian;
    else if (encoding == "binary_big_endian")
      header_.encoding = PlyEncoding::big_endian;
    else
      refuse("has the format " + shown(encoding) + ": it has to be ascii, binary_little_endian or binary_big_endian");
    if (version != "1.0") refuse("has version " + shown(version) + ": this reader knows 1.0");
  }

  void read_element(Words& words) {
    const std::string_view name = words.next();
    const std::optional<std::int64_t> count = integer(words.next());
    if (name.empty() || !count || *count < 0) refuse("an element needs a name and a count: element vertex 8");
    if (header_.elements.size() == most_elements) refuse("has more than " + std::to_string(most_elements) + " elements: is it a mesh?");
    for (const PlyElement& element : header_.elements)
      if (element.name == name) refuse("has the element " + shown(name) + " a second time: export it anew");
    header_.elements.push_back({std::string(name), static_cast<std::uint64_t>(*count), lines_.number(), {}});
  }

  void read_property(Words& words) {
    if (header_.elements.empty()) refuse("has a property before any element: export it anew");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    PlyProperty property;
    std::string_view word = words.next();
    if (word == "list") {
      property.is_list = true;
      property.count_type = type_of(words.next());
      if (!is_whole(property.count_type)) refuse("counts a list with a type that is not whole: export it anew");
      word = words.next();
    }
    property.type = type_of(word);
    property.name = words.next();
    if (property.name.empty()) refuse("has a property without a name: export it anew");
    if (properties.size() == most_properties)
      refuse("has an element of more than " + std::to_string(most_properties) + " properties: is it a mesh?");
    for (const PlyProperty& other : properties)
      if (other.name == property.name) refuse("has the property " + shown(property.name) + " a second time: export it anew");
    properties.push_back(property);
  }

  PlyType type_of(std::string_view word) const {
    for (const TypeName& type : types)
      if (word == type.name || word == type.other_name) return type.type;
    refuse("has a property of type " + shown(word) + ": PLY has char, uchar, short, ushort, int, uint, float and double");
  }

  // Before memory is taken for what the counts say.
  void check_size() const {
    const bool is_text = header_.encoding == PlyEncoding::text;
    for (const PlyElement& element : header_.elements) {
      if (element.count == 0) continue;
      std::uint64_t least = 0;  // bytes of one; of text a digit and a blank each
      for (const PlyProperty& property : element.properties)
        least += is_text ? 2 : size_of(property.is_list ? property.count_type : property.type);
      if (least == 0)
        throw InputError(file_, element.line, "has the element " + shown(element.name) + " without a property: export it anew");
      if (element.count > (header_.body.size() + 1) / least)
        throw InputError(file_, element.line,
                         "says " + std::to_string(element.count) + " of element " + shown(element.name) + ", but only " +
                             std::to_string(header_.body.size()) + " bytes follow its header: it was cut off; export it anew");
    }
  }

  [[noreturn]] void refuse(const std::string& text) const { throw InputError(file_, lines_.number(), text); }

  Lines lines_;
  const std::string& file_;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) { return types[static_cast<std::size_t>(type)].bytes; }

PlyHeader read_ply_header(std::string_view bytes, const std::string& file) { return HeaderReader(bytes, file).read(); }

}  // namespace lf::mesh
