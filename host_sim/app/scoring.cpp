#include "host_sim/app/scoring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "host_sim/app/triangle_tree.hpp"
#include "host_sim/campaign/statistics/percentile.hpp"

namespace lf::app {

namespace {

// Signed distance to a box of half extents `half`, from outside positive.
double box_distance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

double cylinder_distance(const Vec3& p, double radius, double half_height) {
  const Vec2 q(p.head<2>().norm() - radius, std::abs(p.z()) - half_height);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

}  // namespace

double plane_normal_error_deg(const Plane& found, const Pose& true_base_from_panel) {
  const Vec3 normal = true_base_from_panel.linear().col(2);
  return deg_from_rad(std::atan2(found.normal.cross(normal).norm(), std::abs(found.normal.dot(normal))));
}

double panel_over_doubt(const Pose& found_base_from_panel, const Pose& true_base_from_panel, const arm::PanelDoubt& doubt) {
  const Eigen::AngleAxisd off(Mat3(found_base_from_panel.linear() * true_base_from_panel.linear().transpose()));
  const Vec3 shift_m = found_base_from_panel.translation() - true_base_from_panel.translation(), turn_rad = off.angle() * off.axis();
  const Vec3 normal = true_base_from_panel.linear().col(2);
  const double spin_rad = turn_rad.dot(normal);
  const Vec3 tilt_rad = turn_rad - spin_rad * normal;
  return std::max({shift_m.cwiseAbs().maxCoeff() / doubt.shift_m, tilt_rad.cwiseAbs().maxCoeff() / doubt.turn_rad,
                   std::abs(spin_rad) / (doubt.turn_rad + doubt.spin_rad)});
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
                       triangle_distance_m(p, shape.vertices_m[triangle[0]], shape.vertices_m[triangle[1]], shape.vertices_m[triangle[2]]));
  return nearest;
}

std::vector<double> cloud_errors_mm(std::span<const CloudPoint> cloud, const scene::Scene& scene, const scene::BodyPoses& poses) {
  const scene::BodyId first = scene::own_bodies(scene).panel();
  scene::BodyPoses body_from_base;
  for (const Pose& base_from_body : poses) body_from_base.push_back(base_from_body.inverse());
  std::vector<std::vector<std::optional<TriangleTree>>> meshes(scene.size());  // of each body's shapes
  for (std::size_t body = first; body < scene.size(); ++body) {
    for (const scene::Shape& shape : scene[body].shapes) {
      auto& tree = meshes[body].emplace_back();
      if (shape.kind == scene::ShapeKind::mesh) tree.emplace(shape.vertices_m, shape.triangles);
    }
  }
  std::vector<double> distances;
  distances.reserve(cloud.size());
  for (const CloudPoint& point : cloud) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t body = first; body < scene.size(); ++body) {
      const Vec3 p = body_from_base[body] * point.p_m.cast<double>();
      for (std::size_t i = 0; i < scene[body].shapes.size(); ++i) {
        const scene::Shape& shape = scene[body].shapes[i];
        const std::optional<TriangleTree>& mesh = meshes[body][i];
        nearest = mesh ? mesh->nearest_m(shape.body_from_shape.inverse() * p, nearest) : std::min(nearest, distance_to_surface_m(p, shape));
      }
    }
    distances.push_back(1e3 * nearest);
  }
  return distances;
}

double percentile(std::vector<double> values, double share) { return campaign::nearest_rank(values, share); }

}  // namespace lf::app
