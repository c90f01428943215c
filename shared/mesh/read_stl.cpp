#include "shared/mesh/read_stl.hpp"

#include <bit>
#include <cstring>

#include "shared/input_error.hpp"
#include "shared/mesh/faces.hpp"
#include "shared/mesh/format.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// The triangles of a file, and how many stated normals do not agree with them.
class Soup {
 public:
  explicit Soup(Reading& reading) : reading_(reading) {}

  std::size_t size() const { return reading_.mesh.triangles.size(); }

  void add(const Vec3& normal, const std::array<Vec3, 3>& corners, int line) {
    Mesh& mesh = reading_.mesh;
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.insert(mesh.vertices_m.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    // Of 0 0 0 nothing is said; programs write "not a number" for a triangle without area.
    if (normal.allFinite() && normal.cwiseAbs().maxCoeff() <= most_coordinate &&
        normal.dot((corners[1] - corners[0]).cross(corners[2] - corners[0])) >= 0)
      return;
    if (contrary_++ == 0) first_contrary_ = {line, size()};
  }

  void finish() {
    if (contrary_ > 0)
      reading_.note(first_contrary_.line, "the normal of triangle " + std::to_string(first_contrary_.number) +
                                              (contrary_ > 1 ? " (and " + std::to_string(contrary_ - 1) + " more)" : "") +
                                              " does not agree with the order of its corners, which is what counts here");
    merge_vertices(reading_.mesh);
  }

 private:
  struct Place {
    int line = 0;
    std::size_t number = 0;
  };
  Reading& reading_;
  std::size_t contrary_ = 0;
  Place first_contrary_;
};

void read_binary(std::string_view bytes, Reading& reading) {
  const std::string& file = reading.file;
  if (bytes.size() < stl_header_bytes)
    throw InputError(
        file, 0,
        "is neither text nor a binary STL: that has a header of 84 bytes, this file " + counted(bytes.size(), "byte") + "; export it anew");
  const std::uint32_t count = stl_count(bytes);
  refuse_too_many_triangles(count, file, 0);
  if (!has_size_of_binary_stl(bytes))
    throw InputError(file, 0,
                     "says " + counted(count, "triangle") + ", which makes " +
                         std::to_string(stl_header_bytes + stl_triangle_bytes * count) + " bytes, but has " + std::to_string(bytes.size()) +
                         ": it was cut off, or is damaged; export it anew");
  Soup soup(reading);
  reading.mesh.vertices_m.reserve(std::size_t{3} * count);
  reading.mesh.triangles.reserve(count);
  bool has_attributes = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* const at = bytes.data() + stl_header_bytes + stl_triangle_bytes * i;
    std::array<Vec3, 4> vectors;  // the normal, and the corners
    for (int k = 0; k < 12; ++k)
      vectors[static_cast<std::size_t>(k / 3)][k % 3] =
          std::bit_cast<float>(little_endian(at + std::size_t{4} * static_cast<std::size_t>(k)));
    for (std::size_t k = 1; k < 4; ++k)
      for (const double value : vectors[k])
        if (!is_coordinate(value))
          throw InputError(file, 0,
                           "triangle " + std::to_string(i + 1) + " has the coordinate " + shown(value) +
                               ": it has to be finite, and below 1e12; repair the mesh");
    soup.add(vectors[0], {vectors[1], vectors[2], vectors[3]}, 0);
    has_attributes = has_attributes || at[48] != 0 || at[49] != 0;
  }
  if (has_attributes) reading.note(0, "not used: its triangles' attributes (colours)");
  soup.finish();
}

// The words of a text STL, whatever lines they stand in.
class Tokens {
 public:
  Tokens(std::string_view text, const std::string& file) : lines_(text), words_(""), file_(file) {}

  // "" at the file's end.
  std::string_view next() {
    for (;;) {
      const std::string_view word = words_.next();
      if (!word.empty() || !lines_.next()) return word;
      words_ = Words(lines_.line());
    }
  }
  // Of a solid: the rest of its line. A facet there would be dropped without a word.
  void skip_name() {
    std::string_view before;
    for (std::string_view word = words_.next(); !word.empty(); word = words_.next()) {
      if (lower_case(before) == "facet" && lower_case(word) == "normal")
        throw InputError(file_, line(), "has a facet in the line of a solid's name: begin it in a line of its own");
      before = word;
    }
  }
  void need(std::string_view keyword) {
    const std::string_view word = next();
    if (lower_case(word) != keyword) refuse(word, keyword);
  }
  [[noreturn]] void refuse(std::string_view word, std::string_view wanted) const {
    if (word.empty())
      throw InputError(file_, line(), "ends where '" + std::string(wanted) + "' has to stand: it was cut off; export it anew");
    throw InputError(file_, line(),
                     "has " + shown(word) + " where '" + std::string(wanted) + "' has to stand: it is damaged, or no STL; export it anew");
  }
  int line() const { return lines_.number(); }

 private:
  Lines lines_;
  Words words_;
  const std::string& file_;
};

void read_facet(Tokens& tokens, Soup& soup, const std::string& file) {
  const int line = tokens.line();
  refuse_too_many_triangles(soup.size() + 1, file, line);
  tokens.need("normal");
  Vec3 normal;
  for (double& value : normal) {
    const std::string_view word = tokens.next();
    const std::optional<double> found = number(word);
    if (!found) tokens.refuse(word, "a number of the normal");
    value = *found;
  }
  tokens.need("outer");
  tokens.need("loop");
  std::array<Vec3, 3> corners;
  for (Vec3& corner : corners) {
    tokens.need("vertex");
    for (double& value : corner) {
      const std::string_view word = tokens.next();
      value = coordinate(word, "a vertex", file, tokens.line());
    }
  }
  const std::string_view end = tokens.next();
  if (lower_case(end) == "vertex")
    throw InputError(file, tokens.line(), "a facet has a fourth vertex: STL has triangles; triangulate it when exporting");
  if (lower_case(end) != "endloop") tokens.refuse(end, "endloop");
  tokens.need("endfacet");
  soup.add(normal, corners, line);
}

void read_text(std::string_view text, Reading& reading) {
  refuse_zero_bytes(text, reading.file);
  Tokens tokens(text, reading.file);
  Soup soup(reading);
  int solids = 0;
  for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
    if (lower_case(word) != "solid") tokens.refuse(word, "solid");
    tokens.skip_name();
    ++solids;
    for (word = tokens.next(); lower_case(word) == "facet"; word = tokens.next()) read_facet(tokens, soup, reading.file);
    if (lower_case(word) != "endsolid") tokens.refuse(word, "facet or endsolid");
    tokens.skip_name();
  }
  if (solids > 1) reading.note(0, "its " + std::to_string(solids) + " solids are merged into one mesh");
  soup.finish();
}

}  // namespace

std::uint32_t stl_count(std::string_view bytes) { return little_endian(bytes.data() + 80); }

void read_stl(std::string_view bytes, Reading& reading) {
  if (is_text_stl(bytes))
    read_text(bytes, reading);
  else
    read_binary(bytes, reading);
}

}  // namespace lf::mesh
