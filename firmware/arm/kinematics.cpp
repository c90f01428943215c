#include "firmware/arm/kinematics.hpp"

#include <algorithm>
#include <cmath>

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

Pose unrolled_tool(const PlanarChain& chain) {
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

Pose Arm::base_from_unrolled_tool(const JointVector& q_rad) const {
  if (is_planar()) return unrolled_tool(PlanarChain(model_.planar, q_rad));
  Pose pose = Pose::Identity();
  for (std::size_t i = 0; i < pointing_joints(); ++i) pose = turned(pose, model_.origins[i], q_rad[i], 0, 1);
  if (!rolls()) return pose * model_.last_from_tool();
  pose = pose * model_.origins[roll_joint()];
  pose.translation() += model_.tool_z_m * pose.linear().col(2);
  return pose;
}

Pose Arm::base_from_tool(const JointVector& q_rad) const {
  Pose pose = base_from_unrolled_tool(q_rad);
  if (!rolls()) return pose;
  const double c = std::cos(q_rad[roll_joint()]);
  const double s = std::sin(q_rad[roll_joint()]);
  const Vec3 x = pose.linear().col(0);
  const Vec3 y = pose.linear().col(1);
  pose.linear().col(0) = c * x + s * y;
  pose.linear().col(1) = c * y - s * x;
  return pose;
}

Vec3 Arm::approach_axis(const JointVector& q_rad) const {
  return is_planar() ? PlanarChain(model_.planar, q_rad).tool_z() : Vec3(base_from_unrolled_tool(q_rad).linear().col(2));
}

Pose Arm::base_from_laser(const JointVector& q_rad, const LaserCalibration& laser) const {
  return base_from_unrolled_tool(q_rad) * laser.tool_from_laser;
}

Jacobian Arm::jacobian(const JointVector& q_rad) const {
  Jacobian j = Jacobian::Zero();
  const auto set = [&j](std::size_t column, const Vec3& linear, const Vec3& angular) {
    j.block<3, 1>(0, static_cast<Eigen::Index>(column)) = linear;
    j.block<3, 1>(3, static_cast<Eigen::Index>(column)) = angular;
  };
  if (!is_planar()) {
    const LinkPoses links = base_from_links(q_rad, 0);
    const Vec3 tool_m = links[arm_joints() - 1] * tool_on_last_m();
    for (std::size_t i = 0; i < arm_joints(); ++i) {
      const Vec3 axis = links[i].linear().col(2);
      set(i, axis.cross(tool_m - links[i].translation()), axis);
    }
    return j;
  }
  const PlanarChain chain(model_.planar, q_rad);
  const Vec3 across = chain.across();
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
  for (std::size_t i = 0; i < arm_joints(); ++i) parent = links[i] = turned(parent, model_.origins[i], q_rad[i], x, y);
  const std::size_t finger = jaw_joint();
  links[finger] = turned(parent, model_.origins[finger], jaw_rad, x, z);  // about -y
  links[finger + 1] = turned(parent, model_.origins[finger + 1], jaw_rad, z, x);
  return links;
}

LinkCapsules Arm::link_capsules(const JointVector& q_rad, double jaw_rad) const {
  const LinkPoses links = base_from_links(q_rad, jaw_rad);
  LinkCapsules capsules(arm_joints(), rolls());
  for (const ArmModel::Capsule& n : model_.capsules) {
    const Pose& base_from_link = links[n.link() - 1];
    capsules.push_back({n.link(), base_from_link * n.a_m(), base_from_link * n.b_m(), n.radius_m()});
  }
  return capsules;
}

JointVector Arm::planar_reach_m(double jaw_rad) const {
  constexpr std::size_t forearm = 3, wrist = 4;  // as capsules count links
  const LinkPoses links = base_from_links(JointVector::Zero(), jaw_rad);
  const Vec3 elbow = links[forearm - 1].translation();
  const Vec3 roll_axis = links[wrist - 1].linear().col(2);
  double from_roll_axis = 0, from_elbow = 0;
  for (const Capsule& capsule : link_capsules(JointVector::Zero(), jaw_rad)) {
    if (capsule.link < forearm) continue;
    for (const Vec3& end : {capsule.a_m, capsule.b_m}) {
      const double aside = (end - links[wrist - 1].translation()).cross(roll_axis).norm();
      if (capsule.link >= wrist) from_roll_axis = std::max(from_roll_axis, aside + capsule.radius_m);
      // The roll carries it round an axis that passes the elbow at a2.
      from_elbow = std::max(from_elbow, std::hypot(std::abs(model_.planar.a2_m) + aside, (end - elbow).dot(roll_axis)) + capsule.radius_m);
    }
  }
  const double from_shoulder = std::abs(model_.planar.a1_m) + from_elbow;
  return planar_joints(std::abs(model_.planar.a0_m) + from_shoulder, from_shoulder, from_elbow, from_roll_axis);
}

// From tip to base: what a joint moves is no farther from a point of its axis than the next joint's point, and from there whatever that one moves.
JointVector Arm::reach_m(double jaw_rad) const {
  if (is_planar()) return planar_reach_m(jaw_rad);
  const LinkPoses links = base_from_links(JointVector::Zero(), jaw_rad);
  const LinkCapsules capsules = link_capsules(JointVector::Zero(), jaw_rad);
  JointVector reach = JointVector::Zero();
  double beyond_m = 0;  // of what is carried farther out
  for (std::size_t i = arm_joints(); i-- > 0;) {
    const Pose& own = links[i];
    const bool last = i + 1 == arm_joints();
    double from_origin_m = last ? 0 : beyond_m + model_.origins[i + 1].translation().norm(), from_axis_m = 0;
    for (const Capsule& capsule : capsules) {
      // The fingers stand still on the last link, all of which turns about one axis.
      if (last ? capsule.link < arm_joints() : capsule.link != i + 1) continue;
      for (const Vec3& end : {capsule.a_m, capsule.b_m}) {
        from_origin_m = std::max(from_origin_m, (end - own.translation()).norm() + capsule.radius_m);
        from_axis_m = std::max(from_axis_m, (end - own.translation()).cross(own.linear().col(2)).norm() + capsule.radius_m);
      }
    }
    reach[i] = last ? from_axis_m : from_origin_m;
    beyond_m = from_origin_m;
  }
  return reach;
}

JointLimits Arm::limits(double position_margin_rad, double speed_fraction, double jerk_time_s) const {
  JointLimits limits;
  limits.joints = arm_joints();
  for (std::size_t i = 0; i < limits.joints; ++i) {
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
