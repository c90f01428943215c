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

double share(std::uint64_t part, std::uint64_t all) { return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : not_known; }

double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = along.squaredNorm() > 0 ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

// To the plane where the point lies over the triangle, else to its nearest side.
double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const auto inside_of = [&](const Vec3& from, const Vec3& to) { return normal.dot((to - from).cross(p - from)) >= 0; };
  if (normal.squaredNorm() > 0 && inside_of(a, b) && inside_of(b, c) && inside_of(c, a)) return std::abs(normal.normalized().dot(p - a));
  return std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
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
    case scene::ShapeKind::sphere: return std::abs(p.norm() - shape.size_m.x());
    case scene::ShapeKind::capsule: {
      const Vec3 axis(0, 0, std::clamp(p.z(), -0.5 * shape.size_m.z(), 0.5 * shape.size_m.z()));
      return std::abs((p - axis).norm() - shape.size_m.x());
    }
    case scene::ShapeKind::mesh: break;
  }
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& triangle : shape.triangles)
    nearest = std::min(nearest,
                       triangle_distance(p, shape.vertices_m[triangle[0]], shape.vertices_m[triangle[1]], shape.vertices_m[triangle[2]]));
  return nearest;
}

std::vector<double> cloud_errors_mm(std::span<const CloudPoint> cloud, const scene::Scene& scene, const scene::BodyPoses& poses) {
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
  return distances;
}

void PeakScore::add(const optics::Frame& truth, std::span<const scan::Peak> peaks) {
  const auto width = static_cast<std::size_t>(truth.width);
  if (truth.stripe_v.size() < width || truth.stripe_grey.size() < width) return;
  std::vector<std::vector<const optics::StripePiece*>> pieces(width);
  for (const optics::StripePiece& piece : truth.pieces) pieces[static_cast<std::size_t>(piece.u)].push_back(&piece);
  const auto nearest_in = [&](std::size_t column, double v) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const optics::StripePiece* piece : pieces[column]) {
      if (const double error = v - double(piece->v); std::abs(error) < std::abs(nearest)) nearest = error;
    }
    return nearest;
  };
  const bool has_depth = truth.depth_m.size() == width * static_cast<std::size_t>(truth.height);
  std::vector<bool> brightest_found(width), other_found(width);
  for (const scan::Peak& peak : peaks) {
    const auto column = static_cast<std::size_t>(std::lround(peak.u_px));
    if (column >= width) continue;
    ++peaks_;
    const double v = double(peak.v_px), error = nearest_in(column, v);
    if (!(std::abs(error) <= match_px)) {
      bool beside = false;
      for (std::int32_t step = -beside_px; step <= beside_px; ++step) {
        const auto other = static_cast<std::int64_t>(column) + step;
        if (other < 0 || other >= truth.width) continue;
        beside = beside || std::abs(nearest_in(static_cast<std::size_t>(other), v)) <= match_px;
      }
      if (!beside) ++false_;
      continue;
    }
    (std::abs(v - double(truth.stripe_v[column])) <= match_px ? brightest_found : other_found)[column] = true;
    ++matched_;
    squares_ += error * error;
    if (!has_depth || !on_smooth_surface(truth, static_cast<std::int32_t>(column), static_cast<std::int32_t>(std::lround(v - error))))
      continue;
    ++smooth_;
    smooth_squares_ += error * error;
  }
  for (std::size_t u = 0; u < width; ++u) {
    if (!std::isfinite(truth.stripe_v[u]) || !(truth.stripe_grey[u] >= visible_grey)) continue;
    ++visible_;
    found_ += brightest_found[u] ? 1 : 0;
    elsewhere_ += !brightest_found[u] && other_found[u] ? 1 : 0;
  }
}

double PeakScore::rms_px() const { return matched_ > 0 ? std::sqrt(squares_ / static_cast<double>(matched_)) : not_known; }

double PeakScore::smooth_rms_px() const { return smooth_ > 0 ? std::sqrt(smooth_squares_ / static_cast<double>(smooth_)) : not_known; }

double PeakScore::recall() const { return share(found_, visible_); }

double PeakScore::false_share() const { return share(false_, peaks_); }

double PeakScore::elsewhere_share() const { return share(elsewhere_, visible_); }

double percentile(std::vector<double> values, double share) { return campaign::nearest_rank(values, share); }

}  // namespace lf::app
