#include "firmware/scan/triangulate.hpp"

#include <cmath>

namespace lf::scan {

std::optional<Vec3> Triangulator::point(const Vec2& pixel, const Pose& base_from_laser) const {
  const std::optional<Vec3> camera_ray = camera_.ray(pixel);
  if (!camera_ray) return std::nullopt;
  const Vec3 ray = base_from_camera_.linear() * *camera_ray;
  const Vec3& origin = base_from_camera_.translation();
  const Vec3 normal = base_from_laser.linear().col(0);

  // The sine of the angle between ray and plane.
  const double approach = ray.dot(normal);
  if (!(std::abs(approach) >= std::sin(config_.min_angle_rad))) return std::nullopt;
  const double range_m = (base_from_laser.translation() - origin).dot(normal) / approach;
  if (!(range_m >= config_.min_range_m && range_m <= config_.max_range_m)) return std::nullopt;

  const Vec3 point_m = origin + range_m * ray;
  const Vec3 from_emitter = base_from_laser.linear().transpose() * (point_m - base_from_laser.translation());
  if (!(std::abs(std::atan2(from_emitter.y(), from_emitter.z())) <= fan_half_angle_rad_ + config_.fan_margin_rad)) return std::nullopt;
  if ((point_m.array() < config_.region_min_m.array()).any() || (point_m.array() > config_.region_max_m.array()).any()) return std::nullopt;
  return point_m;
}

}  // namespace lf::scan
