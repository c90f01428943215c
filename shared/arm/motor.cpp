#include "shared/arm/motor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace lf {

namespace {

std::pair<double, double> ratios_of(const ArmJoint& joint, double counts_per_rev) {
  std::array<double, 65> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double q_rad = joint.lower_rad + (joint.upper_rad - joint.lower_rad) * static_cast<double>(i) / (all.size() - 1);
    all[i] = motor_ratio(joint.actuator, q_rad, counts_per_rev);
  }
  const auto [least, best] = std::minmax_element(all.begin(), all.end());
  return {*least, *best};
}

}  // namespace

double motor_ratio(const ArmActuator& actuator, double q_rad, double counts_per_rev) {
  double counts_per_rad = actuator.counts_per_rad;
  if (actuator.pivot_a_m != 0) {
    const double a = actuator.pivot_a_m, b = actuator.pivot_b_m, angle = q_rad + actuator.offset_rad;
    counts_per_rad = actuator.counts_per_m * a * b * std::sin(angle) / std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle));
  }
  return std::abs(counts_per_rad) / counts_per_rev * 2 * std::numbers::pi;
}

double best_motor_ratio(const ArmJoint& joint, double counts_per_rev) { return ratios_of(joint, counts_per_rev).second; }

double least_motor_ratio(const ArmJoint& joint, double counts_per_rev) { return ratios_of(joint, counts_per_rev).first; }

Motor motor_of(const ArmJoint& joint, double counts_per_rev) {
  const ArmFriction& friction = joint.friction;
  const double ratio = best_motor_ratio(joint, counts_per_rev);
  const double rated_nm = joint.rated_torque_nm / (ratio * friction.efficiency * (1 - friction.coulomb_share));
  Motor motor;
  motor.rated_torque_nm = 1e-3 * std::max(1.0, std::round(1e3 * rated_nm));
  const double peak_nm = motor.rated_torque_nm * joint.effort_nm / joint.rated_torque_nm;
  motor.peak_torque_nm = std::max(peak_nm, motor.rated_torque_nm);  // rounded, equal torques of the joint need not give equal ones here
  motor.top_speed_rad_s = ratio * joint.velocity_rad_s;
  motor.coulomb_nm = friction.coulomb_share * motor.rated_torque_nm;
  motor.viscous_nm_s = friction.viscous_share * motor.rated_torque_nm / motor.top_speed_rad_s;
  return motor;
}

double held_torque_nm(const ArmJoint& joint) {
  const ArmFriction& friction = joint.friction;
  if (friction.back_efficiency <= 0) return joint.rated_torque_nm;
  // The ratio cancels: a motor's rating, and its Coulomb friction, as at its shaft.
  const double motor_nm = joint.rated_torque_nm / (friction.efficiency * (1 - friction.coulomb_share));
  return motor_nm * (1 + friction.coulomb_share) / friction.back_efficiency;
}

}  // namespace lf
