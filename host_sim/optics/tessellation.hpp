// Shapes as triangles: no surface is further than 20 um from its true place, round ones above 33 mm of radius 0.6 permille of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/scene/scene.hpp"

namespace lf::optics {

struct TriangleMesh {
  std::vector<std::array<float, 3>> vertices_m;  // in the body's frame
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Throws InputError for a size that is not positive or not finite, or a mesh that points past its vertices.
TriangleMesh tessellate(const scene::Shape& shape);

}  // namespace lf::optics
