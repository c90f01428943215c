#include "shared/mesh/format.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "shared/input_error.hpp"
#include "shared/mesh/read_stl.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

struct Known {
  std::string_view mark;  // an extension, or a file's first bytes
  std::string_view name;
};

constexpr std::array<Known, 24> other_extensions{
    {{".dae", "COLLADA"}, {".gltf", "glTF"}, {".glb", "glTF"},    {".3mf", "3MF"},   {".fbx", "FBX"},   {".blend", "Blender's"},
     {".3ds", "3DS"},     {".off", "OFF"},   {".amf", "AMF"},     {".x3d", "X3D"},   {".wrl", "VRML"},  {".usd", "USD"},
     {".usda", "USD"},    {".usdc", "USD"},  {".usdz", "USD"},    {".step", "STEP"}, {".stp", "STEP"},  {".iges", "IGES"},
     {".igs", "IGES"},    {".dxf", "DXF"},   {".mesh", "OGRE's"}, {".sdf", "SDF"},   {".urdf", "URDF"}, {".pcd", "PCD"}}};
constexpr std::array<Known, 7> other_beginnings{{{"glTF", "glTF"},
                                                 {"{", "JSON, as glTF is"},
                                                 {"PK\x03\x04", "a ZIP archive, as 3MF is"},
                                                 {"<", "XML, as COLLADA is"},
                                                 {"Kaydara FBX", "FBX"},
                                                 {"BLENDER", "Blender's"},
                                                 {"ISO-10303-21", "STEP"}}};
constexpr std::array<std::string_view, 10> obj_words{"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl", "l"};
constexpr const char* export_it = ": export it as OBJ, STL or PLY";

std::string_view name_of(Format format) { return format == Format::obj ? "OBJ" : format == Format::stl ? "STL" : "PLY"; }

std::optional<Format> format_by_name(const std::string& file) {
  const std::string extension = lower_case(std::filesystem::path(file).extension().string());
  if (extension == ".obj") return Format::obj;
  if (extension == ".stl") return Format::stl;
  if (extension == ".ply") return Format::ply;
  for (const Known& other : other_extensions)
    if (extension == other.mark) throw InputError(file, 0, "is " + std::string(other.name) + " by its name" + export_it);
  return std::nullopt;
}

std::string_view first_word(std::string_view bytes) {
  Lines lines(bytes);
  while (lines.next()) {
    const std::string_view word = Words(lines.line()).next();
    if (!word.empty() && !word.starts_with('#')) return word;
  }
  return "";
}

std::optional<Format> format_by_content(const std::string& file, std::string_view bytes) {
  if (has_size_of_binary_stl(bytes)) return Format::stl;
  for (const Known& other : other_beginnings)
    if (bytes.starts_with(other.mark)) throw InputError(file, 0, "holds " + std::string(other.name) + export_it);
  const std::string_view word = first_word(bytes.substr(0, 65536));
  if (word == "ply" && bytes.starts_with("ply")) return Format::ply;
  if (is_text_stl(bytes)) return Format::stl;
  if (std::find(obj_words.begin(), obj_words.end(), word) != obj_words.end()) return Format::obj;
  return std::nullopt;
}

}  // namespace

bool has_size_of_binary_stl(std::string_view bytes) {
  return bytes.size() >= stl_header_bytes && bytes.size() == stl_header_bytes + stl_triangle_bytes * std::size_t{stl_count(bytes)};
}

bool is_text_stl(std::string_view bytes) {
  const bool has_zero = bytes.substr(0, stl_header_bytes).find('\0') != std::string_view::npos;
  return !has_zero && !has_size_of_binary_stl(bytes) && lower_case(Words(bytes.substr(0, 4096)).next()) == "solid";
}

Format format_of(const std::string& file, std::string_view bytes) {
  const std::optional<Format> named = format_by_name(file), held = format_by_content(file, bytes);
  if (!named)
    throw InputError(file, 0,
                     held ? "holds " + std::string(name_of(*held)) + ": let its name end in ." + lower_case(name_of(*held))
                          : "is of no known format" + std::string(export_it) + ", and let its name say which");
  if (held && *held != *named)
    throw InputError(file, 0,
                     "is " + std::string(name_of(*named)) + " by its name, but holds " + std::string(name_of(*held)) +
                         ": let its name end in ." + lower_case(name_of(*held)));
  if (!held && *named == Format::ply) throw InputError(file, 0, "does not begin with 'ply': it is damaged, or no PLY; export it anew");
  return *named;
}

}  // namespace lf::mesh
