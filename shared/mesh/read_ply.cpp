#include "shared/mesh/read_ply.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "shared/input_error.hpp"
#include "shared/mesh/faces.hpp"
#include "shared/mesh/ply_header.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

// The numbers of a body in text: one element a line.
class TextValues {
 public:
  TextValues(const PlyHeader& header, const std::string& file)
      : lines_(header.body), words_(""), file_(file), header_lines_(header.lines) {}

  int line() const { return header_lines_ + lines_.number(); }
  void begin(const std::string& element) {
    do
      if (!lines_.next()) throw InputError(file_, line(), "ends before its " + element + ": it was cut off; export it anew");
    while (is_blank());
    words_ = Words(lines_.line());
  }
  // May be infinite, or not a number.
  double take(PlyType) {
    const std::string_view word = words_.next();
    if (word.empty()) refuse("has too few numbers for its element's properties: it was cut off, or is damaged; export the file anew");
    const std::optional<double> value = number(word);
    if (!value) refuse("has " + shown(word) + ", which is no number: correct it, or export the file anew");
    return *value;
  }
  void end() {
    if (const std::string_view word = words_.next(); !word.empty())
      refuse("has " + shown(word) + " behind its element's properties: it is damaged; export the file anew");
  }
  // Throws when something is left. True when the last line has no end.
  bool finish() {
    const bool is_cut = lines_.is_cut();
    while (lines_.next())
      if (!is_blank()) refuse("follows what the header counts: it is damaged; export the file anew");
    return is_cut;
  }

 private:
  bool is_blank() const { return Words(lines_.line()).next().empty(); }
  [[noreturn]] void refuse(const std::string& text) const { throw InputError(file_, line(), text); }

  Lines lines_;
  Words words_;
  const std::string& file_;
  int header_lines_;
};

// The numbers of a binary body.
class BinaryValues {
 public:
  BinaryValues(const PlyHeader& header, const std::string& file)
      : rest_(header.body),
        file_(file),
        is_swapped_((header.encoding == PlyEncoding::big_endian) == (std::endian::native == std::endian::little)) {}

  static int line() { return 0; }
  void begin(const std::string& element) { element_ = &element; }
  double take(PlyType type) {
    switch (type) {
      case PlyType::int8: return bits<std::int8_t>();
      case PlyType::uint8: return bits<std::uint8_t>();
      case PlyType::int16: return bits<std::int16_t>();
      case PlyType::uint16: return bits<std::uint16_t>();
      case PlyType::int32: return bits<std::int32_t>();
      case PlyType::uint32: return bits<std::uint32_t>();
      case PlyType::float32: return bits<float>();
      case PlyType::float64: return bits<double>();
    }
    return 0;
  }
  static void end() {}
  bool finish() const {
    if (!rest_.empty())
      throw InputError(file_, 0, "has " + counted(rest_.size(), "byte") + " behind what its header counts: it is damaged; export it anew");
    return false;
  }

 private:
  template <class Number>
  double bits() {
    std::array<char, sizeof(Number)> bytes{};
    if (rest_.size() < bytes.size()) throw InputError(file_, 0, "ends in its " + *element_ + ": it was cut off; export it anew");
    std::copy_n(rest_.begin(), bytes.size(), bytes.begin());
    rest_.remove_prefix(bytes.size());
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<Number>(bytes));
  }

  std::string_view rest_;
  const std::string& file_;
  const std::string* element_ = nullptr;
  bool is_swapped_;
};

bool is_index_list(const PlyProperty& property) { return property.name == "vertex_indices" || property.name == "vertex_index"; }

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Reading& reading) : header_(header), reading_(reading), faces_(reading.file, 0) {}

  void read() {
    check_elements();
    if (header_.encoding == PlyEncoding::text) {
      refuse_zero_bytes(header_.body, reading_.file);
      read_body(TextValues(header_, reading_.file));
    } else {
      read_body(BinaryValues(header_, reading_.file));
    }
    // Behind all vertices: the faces may be the first element.
    reading_.mesh.triangles = faces_.triangles(reading_.mesh.vertices_m);
  }

 private:
  void check_elements() {
    const PlyElement* vertices = nullptr;
    const PlyElement* faces = nullptr;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        check_vertex(element);
        vertices = &element;
      } else if (element.name == "face") {
        check_face(element);
        faces = &element;
      } else if (element.name == "tristrips") {
        throw InputError(reading_.file, element.line, "has strips of triangles (tristrips): export the mesh as faces");
      } else {
        tell_unused(element.line, "the element " + shown(element.name));
      }
    }
    if (vertices == nullptr) throw InputError(reading_.file, 0, "has no element 'vertex': export it anew");
    if (faces == nullptr || faces->count == 0) throw InputError(reading_.file, 0, "has no faces: is it a cloud of points? Export a mesh");
    refuse_too_many_vertices(vertices->count, reading_.file, vertices->line);
    refuse_too_many_triangles(faces->count, reading_.file, faces->line);
  }

  void check_vertex(const PlyElement& element) {
    std::string further;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const auto found =
          std::find_if(element.properties.begin(), element.properties.end(), [&](const PlyProperty& p) { return p.name == name; });
      if (found == element.properties.end() || found->is_list)
        throw InputError(reading_.file, element.line, "has vertices without the number " + name + ": export it anew");
    }
    for (const PlyProperty& property : element.properties)
      if (property.name != "x" && property.name != "y" && property.name != "z")
        further.append(further.empty() ? "" : ", ").append(property.name);
    if (!further.empty()) tell_unused(element.line, shown(further) + " of its vertices");
  }

  void check_face(const PlyElement& element) {
    std::string further;
    std::size_t lists = 0;
    for (const PlyProperty& property : element.properties) {
      if (!is_index_list(property)) {
        further.append(further.empty() ? "" : ", ").append(property.name);
        continue;
      }
      ++lists;
      if (!property.is_list || !is_whole(property.type))
        throw InputError(reading_.file, element.line,
                         "has a " + shown(property.name) + " that is no list of whole numbers: export it anew");
    }
    if (lists != 1)
      throw InputError(reading_.file, element.line,
                       "has faces with " + counted(lists, "list") + " of their vertices, not with one vertex_indices: export it anew");
    if (!further.empty()) tell_unused(element.line, shown(further) + " of its faces");
  }

  template <class Values>
  void read_body(Values values) {
    for (const PlyElement& element : header_.elements) {
      const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
      if (is_vertex) reading_.mesh.vertices_m.reserve(element.count);
      const std::string name = "last " + shown(element.name);
      for (std::uint64_t i = 0; i < element.count; ++i) {
        values.begin(name);
        if (is_vertex)
          read_vertex(element, values);
        else if (is_face)
          read_face(element, values);
        else
          for (const PlyProperty& property : element.properties) skip(property, values);
        values.end();
      }
    }
    const int line = values.line();
    if (values.finish()) reading_.note(line, "has no end of line, and is the last: was it cut off?");
  }

  template <class Values>
  void skip(const PlyProperty& property, Values& values) {
    if (!property.is_list) return (void)values.take(property.type);
    for (std::uint32_t left = count(property, values); left > 0; --left) values.take(property.type);
  }

  template <class Values>
  std::uint32_t count(const PlyProperty& property, Values& values) {
    return whole(values.take(property.count_type), "the count of a list", values.line());
  }

  std::uint32_t whole(double value, const std::string& noun, int line) const {
    if (value >= 0 && value <= std::numeric_limits<std::uint32_t>::max() && value == std::floor(value))
      return static_cast<std::uint32_t>(value);
    throw InputError(reading_.file, line,
                     noun + " is " + shown(value) + where(line) + ": it has to be a whole number from 0; export the file anew");
  }
  // Of a binary file, which has no lines.
  std::string where(int line) const {
    if (line > 0) return "";
    return " after " + counted(reading_.mesh.vertices_m.size(), "vertex") + " and " + counted(faces_.size(), "face");
  }

  template <class Values>
  void read_vertex(const PlyElement& element, Values& values) {
    Vec3 vertex = Vec3::Zero();
    for (const PlyProperty& property : element.properties) {
      const bool is_axis = property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
      if (!is_axis) {
        skip(property, values);
        continue;
      }
      const double value = values.take(property.type);
      if (!is_coordinate(value))
        throw InputError(reading_.file, values.line(),
                         "a vertex has the coordinate " + shown(value) + where(values.line()) +
                             ": it has to be finite, and below 1e12; repair the mesh");
      vertex[property.name[0] - 'x'] = value;
    }
    reading_.mesh.vertices_m.push_back(vertex);
  }

  template <class Values>
  void read_face(const PlyElement& element, Values& values) {
    corners_.clear();
    for (const PlyProperty& property : element.properties) {
      if (!is_index_list(property)) {
        skip(property, values);
        continue;
      }
      // Not reserved: the count may be anything.
      for (std::uint32_t left = count(property, values); left > 0; --left) {
        corners_.push_back(whole(values.take(property.type), "a face's index of a vertex", values.line()));
        refuse_too_many_corners(corners_.size(), reading_.file, values.line());
      }
    }
    faces_.add(corners_, values.line());
  }

  void tell_unused(int line, const std::string& what) { reading_.note(line, "not used: " + what); }

  const PlyHeader& header_;
  Reading& reading_;
  Faces faces_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

void read_ply(std::string_view bytes, Reading& reading) {
  const PlyHeader header = read_ply_header(bytes, reading.file);
  PlyReader(header, reading).read();
}

}  // namespace lf::mesh
