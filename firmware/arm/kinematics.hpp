// Where the arm's parts are for given joint angles: closed forms of its one chain, with numbers made of the URDF.
//
// The slew turns a vertical plane about base z; shoulder and elbow move within that plane; the roll axis lies in it. So a pose is a planar sum:
// with psi = slew + mount yaw, e = (cos psi, sin psi, 0), beta = shoulder + its offset, gamma = beta + elbow + its offset,
//   elbow = (a0 + a1 cos beta) e + (a1 sin beta) z,   tool = elbow + a2 (cos gamma e + sin gamma z) + d (sin gamma e - cos gamma z).
#pragma once

#include <array>
#include <cstddef>

#include "shared/arm/arm_geometry.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::arm {

// slew, shoulder, elbow, roll, in radians (or rad/s, rad/s^2 where so named).
using JointVector = Eigen::Matrix<double, 4, 1>;
// Linear velocity of the tool point (m/s) above angular velocity (rad/s), both in the base frame, per rad/s of each joint.
using Jacobian = Eigen::Matrix<double, 6, 4>;

// The tool frame in the base frame.
Pose base_from_tool(const JointVector& q_rad);

// The tool axis (tool z) in the base frame; it does not depend on the roll.
Vec3 approach_axis(const JointVector& q_rad);

// The laser, given in the tool frame at roll 0 and carried by slew, shoulder and elbow: the roll in `q_rad` is ignored.
Pose base_from_laser(const JointVector& q_rad, const LaserCalibration& laser);

// Geometric Jacobian of the tool point.
Jacobian jacobian(const JointVector& q_rad);

// base_from_link of slew, upper_arm, forearm, wrist, finger_a and finger_b, in this order; `jaw_rad` is the jaw's angle.
inline constexpr std::size_t moving_link_count = 6;
using LinkPoses = std::array<Pose, moving_link_count>;
LinkPoses base_from_links(const JointVector& q_rad, double jaw_rad);

// A link's outline for clearances: all points within `radius_m` of the segment a-b, base frame. Contains the link's collision shape.
struct Capsule {
  std::size_t link = 0;  // its scene::BodyId: 1 slew .. 6 finger_b
  Vec3 a_m = Vec3::Zero();
  Vec3 b_m = Vec3::Zero();
  double radius_m = 0;
};
using LinkCapsules = std::array<Capsule, arm_geometry::capsules.size()>;
LinkCapsules link_capsules(const JointVector& q_rad, double jaw_rad);

// What each joint may do; from the URDF by default.
struct JointLimits {
  JointVector lower_rad = JointVector::Zero(), upper_rad = JointVector::Zero();
  JointVector velocity_rad_s = JointVector::Zero(), acceleration_rad_s2 = JointVector::Zero(), jerk_rad_s3 = JointVector::Zero();
};

// The URDF's limits: positions drawn in by `position_margin_rad` on both sides, speeds times `speed_fraction`. The jerk takes `jerk_time_s` to reach
// full acceleration; 0.1 s is 25 control periods, above the drives' bandwidth and below what sets the arm swinging.
JointLimits joint_limits(double position_margin_rad = 0, double speed_fraction = 1, double jerk_time_s = 0.1);

}  // namespace lf::arm
