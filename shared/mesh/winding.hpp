// Whether a point lies inside of a closed mesh. Hosted side only.
#pragma once

#include <span>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh {

// How often the surface goes round the point: 1 inside and 0 outside of a closed mesh whose triangles are counter-clockwise from outside. The sum of the triangles'
// solid angles (Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30, 1983) over 4 pi. On the surface itself anything in between. O(n).
double winding_number(std::span<const Vec3> vertices_m, std::span<const Triangle> triangles, const Vec3& point_m);

}  // namespace lf::mesh
