#include "host_sim/optics/tiles.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

// The rays through the corners of eight pixels three times their size.
template <class Visit>
void visit_corners(const RayPacket& rays, Visit visit) {
  for (const float du : {-1.5f, 1.5f}) {
    for (const float dv : {-1.5f, 1.5f}) {
      const Lanes3 origin = rays.origin + rays.origin_du * all_lanes(du) + rays.origin_dv * all_lanes(dv);
      const Lanes3 direction = rays.direction + rays.direction_du * all_lanes(du) + rays.direction_dv * all_lanes(dv);
      for (int i = 0; i < lane_count; ++i) {
        visit(Vec3(origin.x[i], origin.y[i], origin.z[i]), Vec3(direction.x[i], direction.y[i], direction.z[i]).normalized());
      }
    }
  }
}

Cone cone_of(const Camera& camera, int first_u, int first_v) {
  const int end_u = std::min(first_u + Tiles::width_px, camera.width()), end_v = std::min(first_v + Tiles::height_px, camera.height());
  const auto visit_all = [&](auto visit) {
    for (int v = first_v; v < end_v; ++v) {
      for (int u = first_u; u < end_u; u += lane_count) visit_corners(camera.row(u, v), visit);
    }
  };
  Cone cone;
  Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9), sum = Vec3::Zero();
  visit_all([&](const Vec3& origin, const Vec3& direction) {
    low = low.cwiseMin(origin), high = high.cwiseMax(origin);
    sum += direction;
  });
  cone.apex = 0.5 * (low + high);
  cone.apex_radius_m = 0.5 * (high - low).norm();
  cone.axis = sum.normalized();
  double least = 1;
  visit_all([&](const Vec3&, const Vec3& direction) { least = std::min(least, cone.axis.dot(direction)); });
  const double angle = std::acos(std::clamp(least, -1.0, 1.0)) + 1e-4;
  cone.whole_space = angle > 1.5;
  cone.cosine = std::cos(angle), cone.sine = std::sin(angle);
  return cone;
}

}  // namespace

Tiles::Tiles(const Camera& camera)
    : image_height_(camera.height()),
      columns_((camera.width() + width_px - 1) / width_px),
      rows_((camera.height() + height_px - 1) / height_px) {
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) view_.push_back(cone_of(camera, column * width_px, row * height_px));
  }
}

}  // namespace lf::optics
