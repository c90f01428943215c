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
  if (!limits.empty()) text += (text.empty() ? "" : ", and ") + ("the limits of " + limits + " differ");
  return text;
}

}  // namespace lf::config
