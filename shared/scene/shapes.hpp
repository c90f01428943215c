// What the simulator's own shapes are made with. Hosted side only.
#pragma once

#include <array>

#include "shared/scene/scene.hpp"

namespace lf::scene {

using Albedo = std::array<float, 3>;

inline Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Vec3(x, y, z);
  return pose;
}

// The shape's z turned into `z_direction`.
inline Pose along(const Vec3& centre, const Vec3& z_direction) {
  Pose pose = at(centre.x(), centre.y(), centre.z());
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), z_direction).toRotationMatrix();
  return pose;
}

inline Shape shape(ShapeKind kind, const Vec3& size_m, const Pose& body_from_shape, const Albedo& albedo) {
  Shape made;
  made.kind = kind;
  made.size_m = size_m;
  made.body_from_shape = body_from_shape;
  made.albedo = albedo;
  made.friction = 0.6;
  return made;
}

}  // namespace lf::scene
