// What a mesh measures, and what keeps it from being the surface of a solid. Hosted side only.
//
// Volume and centroid are sums over tetrahedra between each triangle and one point (divergence theorem; Zhang, Chen, ICIP 2001).
#pragma once

#include <string>
#include <vector>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh {

struct MeshMeasures {
  double volume_m3 = 0;  // signed: positive where triangles are counter-clockwise from outside. Means something of a closed mesh only
  Vec3 centroid_m = Vec3::Zero();  // of that volume; the middle of the bounds when there is none
  double area_m2 = 0;
  Vec3 least_m = Vec3::Zero(), most_m = Vec3::Zero();  // of all vertices
  std::size_t edges = 0;
  std::size_t shells = 0;  // pieces that share no vertex
  // Vertices in use - edges + triangles: 2 for each shell like a sphere, 0 like a torus.
  std::ptrdiff_t euler = 0;
};
// Of an empty mesh all is 0. O(n log n).
MeshMeasures measure(const Mesh& mesh);

// Indices count from 0. `triangles` are two that have the edge; of an open edge the one, twice.
struct EdgePlace {
  std::array<std::uint32_t, 2> vertices{};
  std::array<Vec3, 2> ends_m{Vec3::Zero(), Vec3::Zero()};
  std::array<std::size_t, 2> triangles{};
};
struct TrianglePlace {
  std::size_t triangle = 0;
  std::array<Vec3, 3> corners_m{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};
struct VertexPlace {
  std::uint32_t vertex = 0;
  Vec3 at_m = Vec3::Zero();
};

template <class Place>
struct Found {
  std::size_t count = 0;
  Place first;  // the one with the lowest indices, when there is any
};

// One cause is told once: edges are those between triangles that are neither duplicates nor have a vertex twice. Surfaces that cross each other are not sought.
struct MeshFaults {
  Found<EdgePlace> open_edges;           // of one triangle
  std::size_t open_edges_that_meet = 0;  // of these: that lie upon another, end on end
  Found<EdgePlace> crowded_edges;        // of more than two
  Found<EdgePlace> inconsistent_edges;   // of two that go along it in the same direction: one of them is turned over
  // Of negative volume, or of none, with their first triangle. They are sought when every edge is right, and are cavities inside the box of a larger shell.
  Found<TrianglePlace> inside_out_shells;
  // A vertex twice, or a height below the longest side's last bit in single precision, in which rays are cast.
  Found<TrianglePlace> degenerate;
  Found<TrianglePlace> duplicates;     // the vertices of an earlier triangle, in any order
  Found<VertexPlace> unused_vertices;  // which still widen bounds and hulls

  bool any() const;
};
// O(n log n). Of more than 2000 shells it is not asked which is inside which: one of negative volume is then a cavity, unless the sum is negative, too.
MeshFaults judge(const Mesh& mesh);

// One sentence a fault, with its first place and the remedy. Triangles count from 1. Empty without faults.
std::vector<std::string> sentences(const MeshFaults& faults);

// Throws InputError, "name: sentence" a line, when the mesh has any fault, or no triangle: every fault at once.
void require_solid(const Mesh& mesh, const std::string& name);

}  // namespace lf::mesh
