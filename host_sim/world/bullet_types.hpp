// Between Eigen and Bullet. Only for the sources of this folder and its tests: Bullet's headers go no further.
#pragma once

#include <LinearMath/btTransform.h>

#include "shared/geometry/pose.hpp"

namespace lf::world {

inline btVector3 to_bullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline btQuaternion to_bullet(const Mat3& rotation) {
  const Eigen::Quaterniond q(rotation);
  return {q.x(), q.y(), q.z(), q.w()};
}

inline btTransform to_bullet(const Pose& pose) { return btTransform(to_bullet(Mat3(pose.linear())), to_bullet(Vec3(pose.translation()))); }

inline Pose from_bullet(const btTransform& transform) {
  const btQuaternion q = transform.getRotation();
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).toRotationMatrix();
  pose.translation() = from_bullet(transform.getOrigin());
  return pose;
}

}  // namespace lf::world
