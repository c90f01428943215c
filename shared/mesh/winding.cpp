#include "shared/mesh/winding.hpp"

#include <cmath>

namespace lf::mesh {

double winding_number(std::span<const Vec3> vertices_m, std::span<const Triangle> triangles, const Vec3& point_m) {
  double sum = 0;
  for (const Triangle& triangle : triangles) {
    const Vec3 a = vertices_m[triangle[0]] - point_m, b = vertices_m[triangle[1]] - point_m, c = vertices_m[triangle[2]] - point_m;
    const double na = a.norm(), nb = b.norm(), nc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return sum / (4 * pi);
}

}  // namespace lf::mesh
