#include "firmware/arm/kinematics.hpp"

#include "firmware/arm/planar_chain.hpp"

namespace lf::arm {
namespace {

// A child's frame: its joint's place on the parent, turned by `angle_rad` about the joint's own axis, which takes `from` to `to`: x to y about z.
Pose turned(const Pose& base_from_parent, const Pose& origin, double angle_rad, Eigen::Index from, Eigen::Index to) {
  Pose pose = base_from_parent * origin;
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const Vec3 a = pose.linear().col(from);
  const Vec3 b = pose.linear().col(to);
  pose.linear().col(from) = c * a + s * b;
  pose.linear().col(to) = c * b - s * a;
  return pose;
}

Pose tool_at_roll_zero(const PlanarChain& chain) {
  Pose pose = Pose::Identity();
  pose.linear().col(0) = chain.tool_x();
  pose.linear().col(1) = chain.across();
  pose.linear().col(2) = chain.tool_z();
  pose.translation() = chain.tool();
  return pose;
}

}  // namespace

Arm::Arm(const ArmModel& model) : model_(model) {
  const ArmModel::Planar& n = model.planar;
  forearm_.length_squared_m2 = n.a2_m * n.a2_m + n.d_m * n.d_m;
  forearm_.length_m = std::sqrt(forearm_.length_squared_m2);
  forearm_.angle_rad = std::atan2(-n.d_m, n.a2_m);
}

Pose Arm::base_from_tool(const JointVector& q_rad) const {
  const PlanarChain chain(model_.planar, q_rad);
  const double c = std::cos(q_rad[3]);
  const double s = std::sin(q_rad[3]);
  const Vec3 x = chain.tool_x();
  const Vec3 y = chain.across();
  Pose pose = Pose::Identity();
  pose.linear().col(0) = c * x + s * y;
  pose.linear().col(1) = c * y - s * x;
  pose.linear().col(2) = chain.tool_z();
  pose.translation() = chain.tool();
  return pose;
}

Vec3 Arm::approach_axis(const JointVector& q_rad) const { return PlanarChain(model_.planar, q_rad).tool_z(); }

Pose Arm::base_from_laser(const JointVector& q_rad, const LaserCalibration& laser) const {
  return tool_at_roll_zero(PlanarChain(model_.planar, q_rad)) * laser.tool_from_laser;
}

Jacobian Arm::jacobian(const JointVector& q_rad) const {
  const PlanarChain chain(model_.planar, q_rad);
  const Vec3 across = chain.across();
  Jacobian j = Jacobian::Zero();
  const auto set = [&j](int column, const Vec3& linear, const Vec3& angular) {
    j.block<3, 1>(0, column) = linear;
    j.block<3, 1>(3, column) = angular;
  };
  // Turning by `across` within the arm's plane takes (r, z) to (-z, r); turning about z takes the plane's r to -across.
  set(0, -chain.tool_r_m * across, Vec3::UnitZ());
  set(1, chain.in_base(-chain.tool_z_m, chain.tool_r_m - model_.planar.a0_m), across);
  set(2, chain.in_base(chain.elbow_z_m - chain.tool_z_m, chain.tool_r_m - chain.elbow_r_m), across);
  set(3, Vec3::Zero(), chain.tool_z());
  return j;
}

LinkPoses Arm::base_from_links(const JointVector& q_rad, double jaw_rad) const {
  constexpr Eigen::Index x = 0, y = 1, z = 2;
  LinkPoses links;
  Pose parent = Pose::Identity();
  for (std::size_t i = 0; i < arm_joint_count; ++i) parent = links[i] = turned(parent, model_.origins[i], q_rad[i], x, y);
  links[4] = turned(parent, model_.origins[4], jaw_rad, x, z);  // about -y
  links[5] = turned(parent, model_.origins[5], jaw_rad, z, x);
  return links;
}

LinkCapsules Arm::link_capsules(const JointVector& q_rad, double jaw_rad) const {
  const LinkPoses links = base_from_links(q_rad, jaw_rad);
  LinkCapsules capsules;
  for (const ArmModel::Capsule& n : model_.capsules) {
    const Pose& base_from_link = links[n.link - 1];
    capsules.push_back({n.link, base_from_link * n.a_m, base_from_link * n.b_m, n.radius_m});
  }
  return capsules;
}

JointLimits Arm::limits(double position_margin_rad, double speed_fraction, double jerk_time_s) const {
  JointLimits limits;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const ArmModel::Joint& joint = model_.joints[i];
    limits.lower_rad[i] = joint.lower_rad + position_margin_rad;
    limits.upper_rad[i] = joint.upper_rad - position_margin_rad;
    limits.velocity_rad_s[i] = joint.velocity_rad_s * speed_fraction;
    limits.acceleration_rad_s2[i] = joint.acceleration_rad_s2;
    limits.jerk_rad_s3[i] = joint.acceleration_rad_s2 / jerk_time_s;
  }
  return limits;
}

}  // namespace lf::arm
