#include "shared/mesh/read_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "shared/input_error.hpp"
#include "shared/mesh/format.hpp"
#include "shared/mesh/read_obj.hpp"
#include "shared/mesh/read_ply.hpp"
#include "shared/mesh/read_stl.hpp"
#include "shared/mesh/text.hpp"
#include "shared/regular_file.hpp"

namespace lf::mesh {
namespace {

void refuse_too_large(std::uintmax_t size, const std::string& file) {
  if (size > most_bytes)
    throw InputError(file, 0,
                     "has " + std::to_string(size >> 20) + " MB; " + std::to_string(most_bytes >> 20) +
                         " MB are read: decimate it in a mesh editor, or export it in binary");
}

// One that is too large is refused by its size, before it is read.
std::string load(const std::string& file) {
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown) refuse_too_large(size, file);
  return bytes_of_regular_file(file, most_bytes);
}

void check_scale(const Vec3& scale, const std::string& file) {
  // From a thousandth of a micrometre to a thousand kilometres.
  for (const double factor : scale)
    if (!(std::abs(factor) >= 1e-9 && std::abs(factor) <= 1e6))
      throw InputError(file, 0, "has the scale " + shown(scale) + ": each factor has to be from 1e-9 to 1e6; 0.001 for millimetres");
}

// From the file's unit to metres.
void apply_scale(const Vec3& scale, Reading& reading) {
  for (Vec3& vertex : reading.mesh.vertices_m) vertex = vertex.cwiseProduct(scale);
  const bool is_scaled = scale != Vec3::Ones();
  reading.note(0, std::string("states no unit and no axes: its numbers are taken as metres") +
                      (is_scaled ? " after the scale " + shown(scale) : "") + ", and its axes as they are");
  if (scale.prod() > 0) return;
  for (Triangle& triangle : reading.mesh.triangles) std::swap(triangle[1], triangle[2]);
  reading.note(0, "is mirrored by its scale: its triangles are turned, so that their outside stays outside");
}

// "0.001", or "(0.001, 0.001, 0.002)".
std::string factor(const Vec3& scale) { return scale.x() == scale.y() && scale.y() == scale.z() ? shown(scale.x()) : shown(scale); }

void check_size(const Reading& reading, const Vec3& scale) {
  const std::vector<Vec3>& vertices = reading.mesh.vertices_m;
  Vec3 least = vertices.front(), most = vertices.front();
  for (const Vec3& vertex : vertices) {
    least = least.cwiseMin(vertex);
    most = most.cwiseMax(vertex);
  }
  const double side_m = (most - least).maxCoeff(), farthest_m = std::max(least.cwiseAbs().maxCoeff(), most.cwiseAbs().maxCoeff());
  if (side_m > most_side_m)
    throw InputError(reading.file, 0,
                     "is " + shown(side_m) + " m long, more than " + shown(most_side_m) +
                         " m: is it in millimetres? Then give it scale: " + factor(0.001 * scale));
  if (side_m < least_side_m)
    throw InputError(reading.file, 0,
                     "is " + shown(side_m) +
                         " m long, less than 1 mm: was it scaled from millimetres twice? Then give it scale: " + factor(1000 * scale));
  if (farthest_m > most_coordinate_m)
    throw InputError(reading.file, 0, "lies " + shown(farthest_m) + " m from its origin: move it there in a mesh editor");
}

}  // namespace

void Reading::note(int line, const std::string& text) { notes.push_back({line, text}); }

std::string Reading::told(const Note& note) const { return InputError(file, note.line, note.text).what(); }

Reading read_mesh(const std::string& file, const Vec3& scale) { return parse_mesh(file, load(file), scale); }

Reading parse_mesh(const std::string& file, std::string_view bytes, const Vec3& scale) {
  check_scale(scale, file);
  refuse_too_large(bytes.size(), file);
  if (bytes.empty()) throw InputError(file, 0, "is empty: export the mesh anew");
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // that a text is UTF-8
  Reading reading;
  reading.file = file;
  switch (format_of(file, bytes)) {
    case Format::obj: read_obj(bytes, reading); break;
    case Format::stl: read_stl(bytes, reading); break;
    case Format::ply: read_ply(bytes, reading); break;
  }
  if (reading.mesh.triangles.empty())
    throw InputError(file, 0, "has no triangles: was the file cut off, or is it a cloud of points? Export a mesh");
  apply_scale(scale, reading);
  check_size(reading, scale);
  return reading;
}

}  // namespace lf::mesh
