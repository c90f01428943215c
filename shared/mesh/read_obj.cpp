#include "shared/mesh/read_obj.hpp"

#include <algorithm>
#include <map>

#include "shared/input_error.hpp"
#include "shared/mesh/faces.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

constexpr std::int64_t most_index = 0xFFFF'FFFE;

// What is valid and of no use here, and how it is told.
struct Unused {
  std::string_view keyword;
  std::string_view what;
};
constexpr std::array<Unused, 19> unused_statements{{{"vt", "texture coordinates (vt)"},
                                                    {"vn", "normals (vn)"},
                                                    {"s", "smoothing groups (s)"},
                                                    {"mtllib", "a library of materials (mtllib)"},
                                                    {"usemtl", "materials (usemtl)"},
                                                    {"usemap", "textures (usemap)"},
                                                    {"maplib", "a library of textures (maplib)"},
                                                    {"l", "lines (l)"},
                                                    {"p", "points (p)"},
                                                    {"mg", "merging groups (mg)"},
                                                    {"bevel", "bevel"},
                                                    {"c_interp", "c_interp"},
                                                    {"d_interp", "d_interp"},
                                                    {"lod", "lod"},
                                                    {"shadow_obj", "shadow_obj"},
                                                    {"trace_obj", "trace_obj"},
                                                    {"ctech", "ctech"},
                                                    {"stech", "stech"},
                                                    {"vp", "points of free-form curves (vp)"}}};
constexpr std::array<std::string_view, 17> free_form{"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf", "parm", "trim",
                                                     "hole",   "scrv", "sp",   "end",  "con",  "cdc",   "cdp",  "bzp"};

class ObjReader {
 public:
  ObjReader(std::string_view text, Reading& reading) : lines_(text), reading_(reading), faces_(reading.file, 1) {}

  void read() {
    while (lines_.next()) {
      line_ = lines_.number();
      read_statement(whole_statement());
    }
    if (lines_.is_cut()) reading_.note(line_, "has no end of line, and is the last: was it cut off?");
    // Behind all vertices: a face may be stated before them.
    reading_.mesh.triangles = faces_.triangles(reading_.mesh.vertices_m);
    tell();
  }

 private:
  // A backslash at a line's end continues it. That of a comment does not: what follows it would be dropped without a word.
  std::string_view whole_statement() {
    if (!is_continued(lines_.line()) || Words(lines_.line()).next().starts_with('#')) return lines_.line();
    joined_.clear();
    while (is_continued(lines_.line())) {
      joined_.append(without_backslash(lines_.line())).append(" ");
      if (!lines_.next()) refuse("ends with a backslash, which continues a line: it was cut off; export it anew");
    }
    joined_.append(lines_.line());
    return joined_;
  }
  static std::string_view without_return(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  static bool is_continued(std::string_view line) { return without_return(line).ends_with('\\'); }
  static std::string_view without_backslash(std::string_view line) {
    line = without_return(line);
    line.remove_suffix(1);
    return line;
  }

  void read_statement(std::string_view statement) {
    Words words(statement);
    const std::string_view keyword = words.next();
    if (keyword.empty() || keyword.starts_with('#')) return;
    if (keyword == "v") return read_vertex(words);
    if (keyword == "f") return read_face(words);
    if (keyword == "o") return (void)++objects_;
    if (keyword == "g") return (void)++groups_;
    const auto* const unused =
        std::find_if(unused_statements.begin(), unused_statements.end(), [&](const Unused& u) { return u.keyword == keyword; });
    if (unused != unused_statements.end()) return tell_unused(unused->what);
    if (std::find(free_form.begin(), free_form.end(), keyword) != free_form.end())
      refuse("has " + shown(keyword) + " of a free-form curve or surface: export the mesh as polygons");
    refuse("begins with " + shown(keyword) + ", which is no statement of an OBJ file: correct it, or export the file anew");
  }

  void read_vertex(Words words) {
    refuse_too_many_vertices(reading_.mesh.vertices_m.size() + 1, reading_.file, line_);
    Vec3 vertex;
    for (double& value : vertex) value = coordinate(words.next(), "a vertex", reading_.file, line_);
    // A weight, or a colour, or both.
    std::size_t further = 0;
    for (std::string_view word = words.next(); !word.empty() && !word.starts_with('#'); word = words.next(), ++further)
      if (!number(word)) refuse("a vertex has " + shown(word) + ", which is no number: correct it, or export the file anew");
    if (further == 2 || further > 4)
      refuse("a vertex has " + counted(3 + further, "number") +
             ": it has x, y, z, and may have a weight and a colour; export the file anew");
    if (further == 1 || further == 4) tell_unused("weights of vertices");
    if (further >= 3) tell_unused("colours of vertices");
    reading_.mesh.vertices_m.push_back(vertex);
  }

  void read_face(Words words) {
    corners_.clear();
    for (std::string_view word = words.next(); !word.empty() && !word.starts_with('#'); word = words.next()) {
      corners_.push_back(corner(word));
      refuse_too_many_corners(corners_.size(), reading_.file, line_);
    }
    faces_.add(corners_, line_);
  }

  // "v", "v/t", "v//n" or "v/t/n"; counts from 1, or with a minus backwards from the last vertex so far.
  std::uint32_t corner(std::string_view word) const {
    const std::size_t slash = word.find('/');
    const std::optional<std::int64_t> index = integer(word.substr(0, slash));
    if (!index || (slash != std::string_view::npos && !are_references(word.substr(slash + 1))))
      refuse("a face has the corner " + shown(word) + ": write v, v/t, v//n or v/t/n with whole numbers");
    const auto vertices = static_cast<std::int64_t>(reading_.mesh.vertices_m.size());
    if (*index == 0) refuse("a face has vertex 0: OBJ counts from 1; export the file anew");
    if (*index < -vertices)
      refuse("a face has vertex " + std::to_string(*index) + ", counted backwards, but there are " +
             counted(static_cast<std::size_t>(vertices), "vertex") + " before it: export the file anew");
    if (*index > most_index) refuse("a face has vertex " + std::to_string(*index) + ", and no file has so many: export it anew");
    return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : vertices + *index);
  }
  // "t", "/n" or "t/n". They point at what is not used.
  static bool are_references(std::string_view text) {
    const std::size_t slash = text.find('/');
    const std::string_view first = text.substr(0, slash);
    if (slash == std::string_view::npos) return integer(first).has_value();
    return (first.empty() || integer(first)) && integer(text.substr(slash + 1));
  }

  void tell_unused(std::string_view what) { first_line_.try_emplace(what, line_); }

  void tell() {
    for (const auto& [what, line] : first_line_) reading_.note(line, "not used: " + std::string(what));
    std::stable_sort(reading_.notes.begin(), reading_.notes.end(), [](const Note& a, const Note& b) { return a.line < b.line; });
    if (objects_ > 1 || groups_ > 1)
      reading_.note(0, "its " + counted(objects_, "object") + " (o) and " + counted(groups_, "group") + " (g) are merged into one mesh");
  }

  [[noreturn]] void refuse(const std::string& text) const { throw InputError(reading_.file, line_, text); }

  Lines lines_;
  int line_ = 0;
  Reading& reading_;
  Faces faces_;
  std::string joined_;
  std::vector<std::uint32_t> corners_;
  std::size_t objects_ = 0, groups_ = 0;
  std::map<std::string_view, int> first_line_;  // of what is not used
};

}  // namespace

void read_obj(std::string_view text, Reading& reading) {
  refuse_zero_bytes(text, reading.file);
  ObjReader(text, reading).read();
}

}  // namespace lf::mesh
