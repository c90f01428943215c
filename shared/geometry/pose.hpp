// Eigen's fixed-size types under the names used here, and the frames of reference.
//
// A transform is named by what it maps: `base_from_tool` takes tool coordinates to base coordinates.
//
//   world   z up, x toward the panel; the simulator's own
//   base    B: the arm's mounting frame. x toward the panel, y right, z down; the core works in it
//   arm     the DH base of the published kinematics: base turned by pi about z (the folded-under mount)
//   tool    E: the DH end effector. z the tool axis; the jaw's fingers move along x; x is up when the tool is level at roll 0
//   laser   on the forearm, it does not turn with the jaw: x the laser plane's normal, z the fan's central ray, origin the emitter
//   camera  optical: z forward, x right, y down
//   panel   P: origin at the valve's base on the panel's plane, x right, y up as the robot sees it, z out of the panel, toward the robot
//   tag     the marker: origin its centre, x right, y up, z out of the marker
//
// A handle angle is measured about panel z from panel y: 0 is a vertical bar, positive is counter-clockwise as the robot sees it.
// A bar's direction is therefore (-sin angle, cos angle, 0) in the panel frame, and is the same after half a turn.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lf {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Pose = Eigen::Isometry3d;

// normal . p + offset_m = 0, unit normal.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;

  double signed_distance_m(const Vec3& p) const { return normal.dot(p) + offset_m; }
};

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double rad_from_deg(double deg) { return deg * (pi / 180.0); }
inline constexpr double deg_from_rad(double rad) { return rad * (180.0 / pi); }

// Turns any angle into (-half_period, half_period].
inline double wrap(double angle_rad, double half_period_rad = pi) {
  const double period = 2 * half_period_rad;
  return angle_rad - period * std::ceil((angle_rad - half_period_rad) / period);
}

}  // namespace lf
