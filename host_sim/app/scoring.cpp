#include "host_sim/app/scoring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/campaign/statistics/percentile.hpp"

namespace lf::app {

namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// Signed distance to a box of half extents `half`, from outside positive.
double box_distance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

double cylinder_distance(const Vec3& p, double radius, double half_height) {
  const Vec2 q(p.head<2>().norm() - radius, std::abs(p.z()) - half_height);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

// Whether the depth has no jump and no crease within the stripe's width about a pixel.
bool on_smooth_surface(const optics::Frame& truth, std::int32_t u, std::int32_t v) {
  constexpr std::int32_t reach = 5;  // px: three standard deviations of a stripe in clear water
  constexpr double bend_m = 2e-3;    // a face of the panel seen at a slant bends by 0.1 mm over the reach, its arris by 5 mm
  if (u < reach || v < reach || u + reach >= truth.width || v + reach >= truth.height) return false;
  const auto depth_m = [&](std::int32_t x, std::int32_t y) {
    return double(truth.depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(truth.width) + static_cast<std::size_t>(x)]);
  };
  const double centre_m = depth_m(u, v);
  return std::abs(depth_m(u, v - reach) + depth_m(u, v + reach) - 2 * centre_m) < bend_m &&
         std::abs(depth_m(u - reach, v) + depth_m(u + reach, v) - 2 * centre_m) < bend_m;
}

}  // namespace

double plane_normal_error_deg(const Plane& found, const Pose& true_base_from_panel) {
  const Vec3 normal = true_base_from_panel.linear().col(2);
  return deg_from_rad(std::atan2(found.normal.cross(normal).norm(), std::abs(found.normal.dot(normal))));
}

double plane_offset_error_mm(const Plane& found, const Pose& true_base_from_panel, const PanelLayout& layout) {
  const Vec2 centre = 0.5 * (layout.plate_min_m + layout.plate_max_m);
  return 1e3 * std::abs(found.signed_distance_m(true_base_from_panel * Vec3(centre.x(), centre.y(), 0)));
}

double handle_error_deg(double found_rad, double true_rad) { return deg_from_rad(std::abs(wrap(found_rad - true_rad, pi / 2))); }

double distance_to_surface_m(const Vec3& point_m, const scene::Shape& shape) {
  const Vec3 p = shape.body_from_shape.inverse() * point_m;
  switch (shape.kind) {
    case scene::ShapeKind::box: return std::abs(box_distance(p, 0.5 * shape.size_m));
    case scene::ShapeKind::cylinder: return std::abs(cylinder_distance(p, shape.size_m.x(), 0.5 * shape.size_m.z()));
    default: return std::numeric_limits<double>::infinity();
  }
}

double cloud_truth_p95_mm(std::span<const CloudPoint> cloud, const scene::Scene& scene, const scene::BodyPoses& poses) {
  std::array<Pose, scene::body_count> body_from_base;
  constexpr auto first = static_cast<std::size_t>(scene::BodyId::panel);
  for (std::size_t body = first; body < scene::body_count; ++body) body_from_base[body] = poses[body].inverse();
  std::vector<double> distances;
  distances.reserve(cloud.size());
  for (const CloudPoint& point : cloud) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t body = first; body < scene::body_count; ++body) {
      const Vec3 p = body_from_base[body] * point.p_m.cast<double>();
      for (const scene::Shape& shape : scene[body].shapes) nearest = std::min(nearest, distance_to_surface_m(p, shape));
    }
    distances.push_back(1e3 * nearest);
  }
  return percentile(std::move(distances), 0.95);
}

void PeakScore::add(const optics::Frame& truth, std::span<const scan::Peak> peaks) {
  const auto width = static_cast<std::size_t>(truth.width);
  if (truth.stripe_v.size() < width || truth.stripe_grey.size() < width) return;
  // A column can hold two peaks; the true centre is that of the brightest piece, so the nearer of the two is meant for it.
  std::vector<double> errors(width, std::numeric_limits<double>::infinity());
  for (const scan::Peak& peak : peaks) {
    const auto column = static_cast<std::size_t>(std::lround(peak.u_px));
    if (column >= width) continue;
    const double error = double(peak.v_px) - double(truth.stripe_v[column]);
    if (std::abs(error) < std::abs(errors[column])) errors[column] = error;
  }
  const bool has_depth = truth.depth_m.size() == width * static_cast<std::size_t>(truth.height);
  for (std::size_t u = 0; u < width; ++u) {
    if (!std::isfinite(truth.stripe_v[u]) || !(truth.stripe_grey[u] >= visible_grey)) continue;
    ++visible_;
    if (!(std::abs(errors[u]) <= match_px)) continue;
    ++matched_;
    squares_ += errors[u] * errors[u];
    if (!has_depth || !on_smooth_surface(truth, static_cast<std::int32_t>(u), static_cast<std::int32_t>(std::lround(truth.stripe_v[u]))))
      continue;
    ++smooth_;
    smooth_squares_ += errors[u] * errors[u];
  }
}

double PeakScore::rms_px() const { return matched_ > 0 ? std::sqrt(squares_ / static_cast<double>(matched_)) : not_known; }

double PeakScore::smooth_rms_px() const { return smooth_ > 0 ? std::sqrt(smooth_squares_ / static_cast<double>(smooth_)) : not_known; }

double PeakScore::recall() const { return visible_ > 0 ? static_cast<double>(matched_) / static_cast<double>(visible_) : not_known; }

double percentile(std::vector<double> values, double share) { return campaign::nearest_rank(values, share); }

}  // namespace lf::app
