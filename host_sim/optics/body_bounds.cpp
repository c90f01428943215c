#include "host_sim/optics/body_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

constexpr double margin_m = 1e-3;  // over the tessellation's and rounding's micrometres

struct Box {
  Vec3 centre = Vec3::Zero(), half = Vec3::Zero();
};

Box box_of(const scene::Shape& shape) {
  const Vec3& s = shape.size_m;
  switch (shape.kind) {
    case scene::ShapeKind::box: return {Vec3::Zero(), 0.5 * s};
    case scene::ShapeKind::cylinder: return {Vec3::Zero(), {s.x(), s.x(), 0.5 * s.z()}};
    case scene::ShapeKind::capsule: return {Vec3::Zero(), {s.x(), s.x(), 0.5 * s.z() + s.x()}};
    case scene::ShapeKind::sphere: return {Vec3::Zero(), Vec3::Constant(s.x())};
    case scene::ShapeKind::mesh: break;
  }
  if (shape.vertices_m.empty()) return {};
  Vec3 low = shape.vertices_m.front(), high = low;
  for (const Vec3& vertex : shape.vertices_m) low = low.cwiseMin(vertex), high = high.cwiseMax(vertex);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

}  // namespace

Cone Cone::about_sphere(const Vec3& apex, const Vec3& centre, double radius_m) {
  Cone cone;
  cone.apex = apex;
  const Vec3 way = centre - apex;
  const double distance = way.norm();
  cone.whole_space = !(radius_m < 0.99 * distance);
  if (cone.whole_space) return cone;
  cone.axis = way / distance;
  cone.sine = radius_m / distance;
  cone.cosine = std::sqrt(1 - cone.sine * cone.sine);
  cone.reach_m = distance + radius_m;
  return cone;
}

// A long shape becomes a row of spheres, each about a slice that is as long as the shape is wide.
BodyBounds::BodyBounds(const scene::Scene& scene, const std::function<bool(const scene::Body&)>& has) {
  for (std::size_t body = 0; body < scene.size(); ++body) {
    if (!has(scene[body])) continue;
    for (const scene::Shape& shape : scene[body].shapes) {
      if (!shape.visible) continue;
      const Box box = box_of(shape);
      Vec3::Index longest = 0;
      const double length = box.half.maxCoeff(&longest);
      const double width = std::max(box.half[(longest + 1) % 3], box.half[(longest + 2) % 3]);
      const int slices = width > 0 ? std::clamp(static_cast<int>(std::ceil(length / width)), 1, 16) : 1;
      Vec3 slice = box.half;
      slice[longest] /= slices;
      for (int i = 0; i < slices; ++i) {
        Vec3 centre = box.centre;
        centre[longest] += slice[longest] * (2 * i + 1 - slices);
        spheres_.push_back({body, shape.body_from_shape * centre, slice.norm() + margin_m});
      }
    }
  }
  packets_.resize((spheres_.size() + lane_count - 1) / lane_count);
}

void BodyBounds::set_poses(const scene::BodyPoses& base_from_body) {
  for (std::size_t i = 0; i < packets_.size() * lane_count; ++i) {
    const Sphere& sphere = spheres_[std::min(i, spheres_.size() - 1)];
    const Vec3 centre = base_from_body[sphere.body] * sphere.centre_m;
    Packet& packet = packets_[i / lane_count];
    const std::size_t lane = i % lane_count;
    packet.centre.x[lane] = static_cast<float>(centre.x());
    packet.centre.y[lane] = static_cast<float>(centre.y());
    packet.centre.z[lane] = static_cast<float>(centre.z());
    packet.radius[lane] = static_cast<float>(sphere.radius_m);
  }
}

// A sphere meets the cone where its centre lies within the cone's angle plus the angle at which the sphere is seen.
bool BodyBounds::may_meet(const Cone& cone) const {
  if (cone.whole_space) return !packets_.empty();
  const Lanes3 apex(cone.apex), axis(cone.axis);
  const auto apex_radius = static_cast<float>(cone.apex_radius_m), reach = static_cast<float>(cone.reach_m);
  const auto cosine = static_cast<float>(cone.cosine), sine = static_cast<float>(cone.sine);
  LaneMask met{};
  for (const Packet& sphere : packets_) {
    const Lanes3 way = sphere.centre - apex;
    const Lanes radius = sphere.radius + apex_radius;
    const Lanes tangent = dot(way, way) - radius * radius;  // squared length to where the sphere is touched
    const Lanes limit = cosine * sqrt(max(tangent, Lanes{})) - sine * radius;
    const Lanes far = reach + radius;
    met |= ((tangent <= 0.f) | (dot(way, axis) >= limit)) & (dot(way, way) <= far * far);
  }
  return any(met);
}

}  // namespace lf::optics
