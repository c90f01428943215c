#include "hal/config/limits_check.hpp"

#include <array>
#include <cstdio>

#include "firmware/arm/kinematics.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::config {

namespace {

// Of the rated torque by the arm's description: a change that its free motion makes by itself, with whatever motors. At 9 N m of 30 a sweep after
// a turn was taken for a contact (seed 52).
constexpr double free_motion_share = 0.3;

template <class... Values>
std::string formatted(const char* form, Values... values) {
  std::array<char, 320> text;
  (void)std::snprintf(text.data(), text.size(), form, values...);
  return text.data();
}

void check_torques(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits, std::vector<std::string>& problems) {
  const arm::JointVector contact_nm = mission::free_motion_guard(arm, limits).contact_torque_nm;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double told_nm = contact_nm[static_cast<Eigen::Index>(i)], free_nm = free_motion_share * arm.joint(i).rated_torque_nm;
    if (told_nm > free_nm) continue;
    const bool by_joint = told_nm < limits.max_contact_torque_nm;
    const std::string entry = by_joint ? "joints." + names[i] + ".max_torque_nm" : "max_contact_torque_nm";
    const double stated_nm = by_joint ? limits.joints[i].max_torque_nm : limits.max_contact_torque_nm;
    problems.push_back(
        formatted("'%s' is %.4g: a rise of %.3g N m would count as a contact of the %s, and its free motion takes up to %.3g N "
                  "m by itself. It takes more than %.4g N m",
                  entry.c_str(), stated_nm, told_nm, names[i].c_str(), free_nm, free_nm * stated_nm / told_nm));
  }
}

// What is wider than the arm itself never speaks: another arm's file, or degrees written for radians.
void check_fit(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits, std::vector<std::string>& problems) {
  constexpr double beyond_rad = 0.03;     // the shipped jaw's, whose zero may be 5 mrad off, lie 0.022 beyond its stops
  constexpr double faster = 1.35;         // the shipped ones are 1.17 to 1.3 times the joints' top speeds
  constexpr double of_most = 0.9;         // the rest is what a reading may lack
  constexpr double longest_stop_s = 1.0;  // at 1.1 s a stop takes the power, moving or not
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    const ArmModel::Joint& joint = arm.joint(i);
    const safety::JointLimit& limit = limits.joints[i];
    if (limit.min_rad < joint.lower_rad - beyond_rad || limit.max_rad > joint.upper_rad + beyond_rad)
      problems.push_back(formatted("'joints.%s' has min_rad and max_rad at %.5g and %.5g: the arm's own stroke is %.5g to %.5g rad",
                                   names[i].c_str(), limit.min_rad, limit.max_rad, joint.lower_rad, joint.upper_rad));
    if (limit.max_speed_rad_s > faster * joint.velocity_rad_s)
      problems.push_back(
          formatted("'joints.%s.max_speed_rad_s' is %.4g: the joint's top speed is %.4g rad/s. Take a fifth more: at a third more a "
                    "runaway would not be told",
                    names[i].c_str(), limit.max_speed_rad_s, joint.velocity_rad_s));
    if (joint.velocity_rad_s > longest_stop_s * joint.acceleration_rad_s2)
      problems.push_back(formatted(
          "no limits fit this arm: its %s takes %.3g s to stop from its top speed by its URDF, and a stop takes the power after 1.1 s",
          names[i].c_str(), joint.velocity_rad_s / joint.acceleration_rad_s2));
  }
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double contact_nm = mission::free_motion_guard(arm, limits).contact_torque_nm[static_cast<Eigen::Index>(i)];
    // The drives are set to give no more than their rated torque.
    const double most_nm = std::min<double>(arm.joint(i).effort_nm, arm.joint(i).rated_torque_nm);
    if (contact_nm >= of_most * most_nm)
      problems.push_back(
          formatted("'max_contact_torque_nm' and 'joints.%s.max_torque_nm' make a rise of %.3g N m a contact of the %s: its drive "
                    "gives %.3g N m at most, and would never show one",
                    names[i].c_str(), contact_nm, names[i].c_str(), most_nm));
  }
}

// The jaw grips with all that its drive gives it.
void check_grip(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits, std::vector<std::string>& problems) {
  const double grip_nm = arm.joint(arm.jaw_joint()).effort_nm, most_nm = limits.joints[arm.jaw_joint()].max_torque_nm;
  if (grip_nm <= most_nm) return;
  problems.push_back(
      formatted("'joints.%s.max_torque_nm' is %.4g: the jaw grips with its drive's peak torque, %.4g N m by the arm's description, "
                "and would count as overloaded. It takes no less than that",
                names[arm.jaw_joint()].c_str(), most_nm, grip_nm));
}

}  // namespace

std::vector<std::string> pose_problems(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits,
                                       const arm::JointVector& q_rad, const std::string& what) {
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double q = q_rad[static_cast<Eigen::Index>(i)];
    const bool low = q < limits.joints[i].min_rad;
    if (!low && q <= limits.joints[i].max_rad) continue;
    problems.push_back(formatted("'joints.%s.%s' is %.5g: %s takes the %s to %.5g rad", names[i].c_str(), low ? "min_rad" : "max_rad",
                                 low ? limits.joints[i].min_rad : limits.joints[i].max_rad, what.c_str(), names[i].c_str(), q));
  }
  const Vec3 tool_m = arm.base_from_tool(q_rad).translation();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at_m = tool_m[static_cast<Eigen::Index>(axis)];
    const bool low = at_m < limits.workspace_min_m[axis];
    if (!low && at_m <= limits.workspace_max_m[axis]) continue;
    problems.push_back(formatted("'workspace.%s' has %.4g for %c: %s takes the tool to %.4g m", low ? "min_m" : "max_m",
                                 low ? limits.workspace_min_m[axis] : limits.workspace_max_m[axis], "xyz"[axis], what.c_str(), at_m));
  }
  return problems;
}

std::vector<std::string> limits_problems(const safety::Limits& limits, const ControllerConfig& controller, const JointNames& names) {
  std::vector<std::string> problems = pose_problems(controller.arm, names, limits, controller.mission.park_rad, "the arm's folded pose");
  check_torques(controller.arm, names, limits, problems);
  check_grip(controller.arm, names, limits, problems);
  check_fit(controller.arm, names, limits, problems);
  const double exposure_s = controller.camera.exposure.s();
  if (limits.stale_image_s <= exposure_s)
    problems.push_back(formatted("'stale_image_s' is %.4g: an image cannot be there before its exposure has ended, after %.4g s",
                                 limits.stale_image_s, exposure_s));
  return problems;
}

}  // namespace lf::config
