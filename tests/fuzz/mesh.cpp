// Any mesh of each format: one that keeps what its headers promise, or an InputError that begins with the file.
#include <cmath>
#include <string_view>

#include "shared/input_error.hpp"
#include "shared/mesh/judge.hpp"
#include "shared/mesh/read_mesh.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using lf::fuzz::expect;

void expect_valid(const lf::mesh::Reading& reading) {
  const lf::mesh::Mesh& mesh = reading.mesh;
  expect(!mesh.triangles.empty() && mesh.triangles.size() <= lf::mesh::most_triangles, "triangles are within their bound");
  for (const lf::mesh::Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) expect(corner < mesh.vertices_m.size(), "a corner is a vertex");
  for (const lf::Vec3& vertex : mesh.vertices_m) expect(vertex.cwiseAbs().maxCoeff() <= lf::mesh::most_coordinate_m, "a vertex is near");
  expect(!reading.notes.empty(), "the unit is told");
  for (const lf::mesh::Note& note : reading.notes) expect(note.line >= 0 && !note.text.empty(), "a note has a text");
  const lf::mesh::MeshMeasures measures = lf::mesh::measure(mesh);
  const double side_m = (measures.most_m - measures.least_m).maxCoeff();
  expect(side_m >= lf::mesh::least_side_m && side_m <= lf::mesh::most_side_m, "a model is of a model's size");
  expect(std::isfinite(measures.volume_m3) && std::isfinite(measures.area_m2) && measures.shells > 0, "a mesh has measures");
  const lf::mesh::MeshFaults faults = lf::mesh::judge(mesh);
  expect(faults.any() == !lf::mesh::sentences(faults).empty(), "a fault has a sentence");
  if (!faults.any()) expect(measures.volume_m3 > 0, "a solid has a volume");
  if (!faults.any()) expect(measures.edges * 2 == mesh.triangles.size() * 3, "of a closed surface two triangles have an edge");
}

void try_as(const char* file, std::string_view bytes) {
  try {
    expect_valid(lf::mesh::parse_mesh(file, bytes));
  } catch (const lf::InputError& refused) {
    const std::string_view why = refused.what();
    expect(why.starts_with(file) && why.size() > std::string_view(file).size() + 8, "a refusal says where and why");
    expect(why.find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const char* file : {"a.obj", "a.stl", "a.ply"}) try_as(file, bytes);
  return 0;
}
