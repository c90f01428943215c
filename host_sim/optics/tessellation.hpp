// Shapes as triangles: cylinders stay within 20 um of their true surface, spheres within 60 um; above 33 mm of radius within 0.6 and 1.8 permille of it.
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
