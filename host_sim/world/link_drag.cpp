#include "host_sim/world/link_drag.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lf::world {
namespace {

constexpr int slices_a_rod = 6;  // of a rod that turns about its end the moment is 1.4 % too small

// The shape's box, and its middle in the shape.
struct Box {
  Vec3 middle_m = Vec3::Zero();
  Vec3 size_m = Vec3::Zero();
};

Box box_of(const scene::Shape& shape) {
  if (shape.kind == scene::ShapeKind::box) return {Vec3::Zero(), shape.size_m};
  if (shape.vertices_m.empty()) return {};
  Vec3 low = shape.vertices_m.front(), high = low;
  for (const Vec3& vertex : shape.vertices_m) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return {(low + high) / 2, high - low};
}

// With its z along the longest side.
Pose along_longest(const Pose& from_shape, const Box& box, int longest) {
  Pose pose = from_shape;
  pose.translation() = from_shape * box.middle_m;
  pose.linear() = from_shape.linear() * Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), Vec3::Unit(longest)).toRotationMatrix();
  return pose;
}

}  // namespace

LinkDrag::LinkDrag(const std::vector<scene::Shape>& shapes, const Pose& frame_from_link) {
  for (const scene::Shape& shape : shapes) {
    if (!shape.collides) continue;
    const Pose frame_from_shape = frame_from_link * shape.body_from_shape;
    const double radius_m = shape.size_m.x();
    switch (shape.kind) {
      case scene::ShapeKind::cylinder: cut(frame_from_shape, shape.size_m.z(), 2 * radius_m); break;
      case scene::ShapeKind::capsule: cut(frame_from_shape, shape.size_m.z() + 2 * radius_m, 2 * radius_m); break;
      case scene::ShapeKind::sphere:
        slices_.push_back({frame_from_shape.translation(), Vec3::Zero(), std::numbers::pi * radius_m * radius_m});
        break;
      case scene::ShapeKind::box:
      case scene::ShapeKind::mesh: {
        const Box box = box_of(shape);
        int longest = 0;
        const double length_m = box.size_m.maxCoeff(&longest);
        cut(along_longest(frame_from_shape, box, longest), length_m, (box.size_m.sum() - length_m) / 2);
        break;
      }
    }
  }
}

void LinkDrag::cut(const Pose& frame_from_rod, double length_m, double diameter_m) {
  const double slice_m = length_m / slices_a_rod;
  for (int i = 0; i < slices_a_rod; ++i)
    slices_.push_back(
        {frame_from_rod * Vec3(0, 0, (i + 0.5) * slice_m - length_m / 2), frame_from_rod.linear().col(2), diameter_m * slice_m});
}

LinkDrag::Wrench LinkDrag::at(const Vec3& velocity_m_s, const Vec3& turn_rad_s, double coefficient) const {
  Wrench wrench;
  for (const Slice& slice : slices_) {
    const Vec3 velocity = velocity_m_s + turn_rad_s.cross(slice.place_m);
    const Vec3 across = velocity - velocity.dot(slice.axis) * slice.axis;
    const Vec3 force_n = -0.5 * sea_water_kg_m3 * coefficient * slice.area_m2 * across.norm() * across;
    wrench.force_n += force_n;
    wrench.torque_nm += slice.place_m.cross(force_n);
  }
  return wrench;
}

}  // namespace lf::world
