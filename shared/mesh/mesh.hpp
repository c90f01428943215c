// A triangle mesh of a scene's object. Hosted side only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/geometry/pose.hpp"

namespace lf::mesh {

using Triangle = std::array<std::uint32_t, 3>;  // indices of vertices, from 0; counter-clockwise as seen from outside

// What is read from a file is finite and has every index in range; so must be what others make.
struct Mesh {
  std::vector<Vec3> vertices_m;
  std::vector<Triangle> triangles;
};

// Makes one vertex of those that stand at exactly the same place (0 and -0 are the same), in the order of their first ones. Returns how many it removed.
// Nothing moves: vertices that lie merely close stay apart. O(n log n).
std::size_t merge_vertices(Mesh& mesh);

}  // namespace lf::mesh
