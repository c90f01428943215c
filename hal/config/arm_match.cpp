#include "hal/config/arm_match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_geometry.hpp"
#include "shared/messages/joint_names.hpp"

namespace lf::config {

namespace {

// Constants are written with all their digits: what is more than rounding is another arm.
constexpr double same_m = 1e-5;
constexpr double same_rad = 1e-5;

Pose tool_of(const ArmDescription& arm, const arm::JointVector& q) {
  Pose base_from_body = Pose::Identity();
  for (std::size_t i = 0; i < arm_joint_count; ++i)
    base_from_body =
        base_from_body * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], arm.joints[i].axis);
  return base_from_body * arm.wrist_from_tool;
}

// Angles over every joint's range: both ends, the middle, and two that share no fraction with another joint's.
arm::JointVector angles(int pick) {
  arm::JointVector q;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto& numbers = arm_geometry::joints[i];
    const double share = std::fmod(0.25 * pick * static_cast<double>(i + 1) + 0.1 * pick, 1.0);
    q[static_cast<Eigen::Index>(i)] = numbers.lower_rad + share * (numbers.upper_rad - numbers.lower_rad);
  }
  return q;
}

bool same(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(1.0, std::abs(b)); }

bool same_actuator(const ArmActuator& a, const arm_geometry::JointNumbers& core) {
  return same(a.pivot_a_m, core.pivot_a_m) && same(a.pivot_b_m, core.pivot_b_m) && same(a.offset_rad, core.offset_rad) &&
         same(a.counts_per_m, core.counts_per_m) && same(a.counts_per_rad, core.counts_per_rad);
}

// Where a finger's joint is on the wrist.
bool same_origin(const Pose& pose, const arm_geometry::Transform& core) {
  double off = 0;
  for (Eigen::Index row = 0; row < 3; ++row) {
    const auto r = static_cast<std::size_t>(row);
    off = std::max(off, std::abs(pose.translation()[row] - core.translation_m[r]));
    for (Eigen::Index column = 0; column < 3; ++column)
      off = std::max(off, std::abs(pose.linear()(row, column) - core.rotation[3 * r + static_cast<std::size_t>(column)]));
  }
  return off <= same_m;
}

std::string joined(const std::string& text, const std::string& more) { return text.empty() ? more : text + ", and " + more; }

}  // namespace

std::string difference_from_core(const ArmDescription& arm) {
  double off_m = 0, turned_rad = 0;
  constexpr int picks = 8;
  for (int pick = 0; pick < picks; ++pick) {
    const arm::JointVector q = angles(pick);
    const Pose core_from_arm = arm::base_from_tool(q).inverse() * tool_of(arm, q);
    off_m = std::max(off_m, core_from_arm.translation().norm());
    turned_rad = std::max(turned_rad, Eigen::AngleAxisd(core_from_arm.linear()).angle());
  }
  std::string text;
  if (off_m > same_m || turned_rad > same_rad) {
    std::array<char, 96> words;
    (void)std::snprintf(words.data(), words.size(), "its tool is up to %.2f mm and %.3f degrees off", 1e3 * off_m,
                        deg_from_rad(turned_rad));
    text = words.data();
  }
  std::string limits;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto& numbers = arm_geometry::joints[i];
    const bool same = std::abs(arm.joints[i].lower_rad - numbers.lower_rad) <= same_rad &&
                      std::abs(arm.joints[i].upper_rad - numbers.upper_rad) <= same_rad;
    if (!same) limits += (limits.empty() ? "" : ", ") + std::string(joint_names[i]);
  }
  if (!limits.empty()) text = joined(text, "the limits of " + limits + " differ");
  std::string actuators;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!same_actuator(arm.joints[i].actuator, arm_geometry::joints[i]))
      actuators += (actuators.empty() ? "" : ", ") + std::string(joint_names[i]);
  }
  if (!actuators.empty()) text = joined(text, "the screw or gear of " + actuators + " differs");
  constexpr auto jaw = static_cast<std::size_t>(Joint::jaw);
  if (!same_origin(arm.joints[jaw].parent_from_joint, arm_geometry::joint_origins[jaw]) ||
      !same_origin(arm.finger_b.parent_from_joint, arm_geometry::joint_origins[jaw + 1]))
    text = joined(text, "its fingers are elsewhere on the wrist");
  return text;
}

}  // namespace lf::config
