#include "hal/config/holding.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::config {
namespace {

std::string text_of_nm(double nm) {
  char text[32];
  std::snprintf(text, sizeof text, nm >= 100 ? "%.0f N m" : "%.3g N m", nm);
  return text;
}

// Torques about each joint at these angles. Joint i carries the bodies after body i; both fingers hang on the arm's last link.
std::vector<double> torques_nm(const ArmDescription& arm, const std::vector<double>& angles_rad) {
  struct Pivot {
    Vec3 place, axis;
  };
  std::vector<Pivot> pivots;
  std::vector<double> torques(arm.joints.size(), 0);
  const auto load = [&](const Pose& base_from_body, const ArmLink& link, std::size_t joints_before) {
    const Vec3 centre = base_from_body * link.link_from_com.translation();
    const Vec3 force(0, 0, link.wet_weight_n);
    for (std::size_t i = 0; i < joints_before; ++i) torques[i] += pivots[i].axis.dot((centre - pivots[i].place).cross(force));
  };
  const auto turned = [](const ArmJoint& joint, double angle_rad) {
    return Pose(joint.parent_from_joint * Eigen::AngleAxisd(angle_rad, joint.axis));
  };
  Pose base_from_body = Pose::Identity(), base_from_hand = Pose::Identity();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    if (i == arm.arm_joints()) base_from_hand = base_from_body;
    base_from_body = base_from_body * turned(arm.joints[i], angles_rad[i]);
    pivots.push_back({base_from_body.translation(), base_from_body.linear() * arm.joints[i].axis});
    load(base_from_body, arm.links[i + 1], i + 1);
  }
  load(base_from_hand * turned(arm.finger_b, angles_rad.back()), arm.links[arm.joints.size() + 1], arm.arm_joints());
  return torques;
}

}  // namespace

std::vector<double> weight_torques_nm(const ArmDescription& arm) {
  constexpr int draws = 20'000;
  std::mt19937_64 random(1);
  std::vector<double> most(arm.joints.size(), 0), angles_rad(arm.joints.size());
  for (int draw = 0; draw < draws; ++draw) {
    for (std::size_t i = 0; i < angles_rad.size(); ++i) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      angles_rad[i] = arm.joints[i].lower_rad + share * (arm.joints[i].upper_rad - arm.joints[i].lower_rad);
    }
    const std::vector<double> torques = torques_nm(arm, angles_rad);
    for (std::size_t i = 0; i < most.size(); ++i) most[i] = std::max(most[i], std::abs(torques[i]));
  }
  constexpr double rounding_nm = 1e-6;  // an upright axis carries nothing
  for (double& nm : most) nm = nm < rounding_nm ? 0 : nm;
  return most;
}

void check_holding(const JointDriveChoice& choice, const DriveKind& kind, const std::string& where) {
  if (choice.holding != "brake" || kind.brake_closes_ms > 0) return;
  throw InputError(where + ".holding is brake, and the profile '" + choice.profile +
                   "' has none: where this drive has one, write a profile with 'like: " + choice.profile +
                   "' and its times, 'brake: {opens_ms: ..., closes_ms: ...}'");
}

// Motor, brake and friction act through the gear, and hold the least where it has the least lever.
double held_nm(const ArmJoint& joint, const JointDriveChoice& choice) {
  constexpr double brake_over_peak = 1.5;
  if (choice.holding == "gear") return joint.holding_torque_nm;
  const double lever_share = least_motor_ratio(joint, choice.counts_per_rev) / best_motor_ratio(joint, choice.counts_per_rev);
  return lever_share *
         (choice.holding == "brake" ? brake_over_peak * joint.effort_nm : joint.friction.coulomb_share * joint.rated_torque_nm);
}

std::string Holding::text() const {
  if (held_nm == 0) return "nothing holds it";
  const std::string kind = by == "brake" ? "brake, taken to hold " : by == "gear" ? "gear holds " : "nothing but friction, ";
  return kind + text_of_nm(held_nm);
}

std::vector<Holding> holding_of(const ArmDescription& arm, const Drives& drives) {
  const std::vector<double> weights_nm = weight_torques_nm(arm);
  std::vector<Holding> all;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const JointDriveChoice choice = drive_of(drives, i);
    all.push_back({choice.holding, held_nm(arm.joints[i], choice), weights_nm[i]});
  }
  return all;
}

std::vector<std::string> holding_notes(const ArmDescription& arm, const std::vector<Holding>& joints) {
  std::string sinking;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].holds()) continue;
    sinking += (sinking.empty() ? "" : ", ") + arm.joints[i].name + " (" + joints[i].text() + "; the arm's weight takes up to " +
               text_of_nm(joints[i].weight_nm) + ")";
  }
  if (sinking.empty()) return {};
  return {"each stop ends without power, and then these joints may sink: " + sinking +
          ". That is with the vehicle level and the hand empty. See 'drives.<joint>.holding' and 'holding_torque_nm' of the arm's URDF"};
}

}  // namespace lf::config
