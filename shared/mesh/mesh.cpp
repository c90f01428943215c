#include "shared/mesh/mesh.hpp"

#include <algorithm>
#include <numeric>

namespace lf::mesh {

std::size_t merge_vertices(Mesh& mesh) {
  std::vector<Vec3>& vertices = mesh.vertices_m;
  const auto place = [&](std::uint32_t i) { return std::array<double, 3>{vertices[i].x(), vertices[i].y(), vertices[i].z()}; };
  // A sort and not a hash table: its time does not depend on how the file chose its coordinates.
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto place_a = place(a), place_b = place(b);
    return place_a != place_b ? place_a < place_b : a < b;
  });
  std::vector<std::uint32_t> first_of(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first_of[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? first_of[order[i - 1]] : order[i];
  std::vector<std::uint32_t> new_index(vertices.size());
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (first_of[i] != i) {
      new_index[i] = new_index[first_of[i]];
      continue;
    }
    vertices[kept] = vertices[i];
    new_index[i] = kept++;
  }
  const std::size_t removed = vertices.size() - kept;
  vertices.resize(kept);
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = new_index[corner];
  return removed;
}

}  // namespace lf::mesh
