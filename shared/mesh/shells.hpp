// Edges and connected pieces of a mesh. Inside this folder only.
#pragma once

#include <vector>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh {

// A side of a triangle.
struct Side {
  std::uint32_t low = 0, high = 0;  // its vertices
  std::uint32_t triangle = 0;
  bool rises = true;  // the triangle goes along it from low to high
};
// Sorted by vertices, then by triangles: the sides of an edge are neighbours. Sides whose ends are one vertex are left out.
std::vector<Side> sides_of(const Mesh& mesh, const std::vector<bool>& left_out);

// Pieces that share no vertex, in the order of their first triangles.
struct Shell {
  std::size_t first_triangle = 0;
  double volume_m3 = 0;  // signed
  Vec3 least_m = Vec3::Zero(), most_m = Vec3::Zero();
};
std::vector<Shell> shells_of(const Mesh& mesh, const std::vector<bool>& left_out);

// Six times the signed volume between `origin` and a triangle.
double six_volumes(const Mesh& mesh, const Triangle& triangle, const Vec3& origin);

}  // namespace lf::mesh
