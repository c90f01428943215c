#include "firmware/arm/tool_place.hpp"

#include <algorithm>

#include "firmware/arm/pointing.hpp"

namespace lf::arm {
namespace {

// Of the joint that passes its limits most.
void check_limits(const Arm& arm, double limit_margin_rad, IkResult& result) {
  constexpr double rounding_rad = 1e-9;
  result.outcome = IkOutcome::ok;
  result.excess = 0;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double q_rad = result.q_rad[static_cast<Eigen::Index>(i)];
    const double past_rad = std::max(arm.joint(i).lower_rad + limit_margin_rad - q_rad, q_rad - arm.joint(i).upper_rad + limit_margin_rad);
    if (past_rad <= std::max(rounding_rad, result.excess)) continue;
    result.outcome = IkOutcome::joint_limit;
    result.joint = i;
    result.excess = past_rad;
  }
}

// Straight there, so that it is the posture from which a straight way leads back.
IkResult point_tool_beside(const Arm& arm, const JointVector& beside_rad, const Vec3& tool_m, const Vec3& approach, double roll_rad,
                           double limit_margin_rad) {
  constexpr int stretches = 8;
  IkResult result;
  if (!(tool_m.allFinite() && approach.allFinite() && approach.norm() > 0)) return result;
  result.outcome = IkOutcome::too_far;
  result.q_rad = beside_rad;
  const Pose from = arm.base_from_tool(beside_rad);
  const Vec3 from_axis = from.linear().col(2), to_axis = approach.normalized();
  for (int i = 1; i <= stretches; ++i) {
    const double share = static_cast<double>(i) / stretches;
    const Vec3 here_m = from.translation() + share * (tool_m - from.translation());
    if (!move_tool(arm, here_m, from_axis + share * (to_axis - from_axis), result.q_rad)) return result;
  }
  arm.set_roll(result.q_rad, roll_rad);
  check_limits(arm, limit_margin_rad, result);
  return result;
}

}  // namespace

bool can_work(const Arm& arm) { return arm.is_planar() || can_point(arm); }

IkResult place_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                    const JointVector& near_rad) {
  return arm.is_planar() ? inverse_kinematics(arm, tool_m, roll_rad, limit_margin_rad, near_rad)
                         : point_tool(arm, tool_m, approach, roll_rad, limit_margin_rad, near_rad);
}

IkResult place_tool_beside(const Arm& arm, const JointVector& beside_rad, const Vec3& tool_m, const Vec3& approach, double roll_rad,
                           double limit_margin_rad) {
  if (arm.is_planar()) return inverse_kinematics(arm, posture_of(arm, beside_rad), tool_m, roll_rad, limit_margin_rad);
  return point_tool_beside(arm, beside_rad, tool_m, approach, roll_rad, limit_margin_rad);
}

}  // namespace lf::arm
