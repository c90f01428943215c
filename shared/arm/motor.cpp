#include "shared/arm/motor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lf {

double motor_ratio(const ArmActuator& actuator, double q_rad, double counts_per_rev) {
  double counts_per_rad = actuator.counts_per_rad;
  if (actuator.pivot_a_m != 0) {
    const double a = actuator.pivot_a_m, b = actuator.pivot_b_m, angle = q_rad + actuator.offset_rad;
    counts_per_rad = actuator.counts_per_m * a * b * std::sin(angle) / std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle));
  }
  return std::abs(counts_per_rad) / counts_per_rev * 2 * std::numbers::pi;
}

double best_motor_ratio(const ArmJoint& joint, double counts_per_rev) {
  double best = 0;
  for (int i = 0; i <= 64; ++i)
    best = std::max(best, motor_ratio(joint.actuator, joint.lower_rad + (joint.upper_rad - joint.lower_rad) * i / 64, counts_per_rev));
  return best;
}

Motor motor_of(const ArmJoint& joint, double counts_per_rev) {
  const ArmFriction& friction = joint.friction;
  const double ratio = best_motor_ratio(joint, counts_per_rev);
  const double rated_nm = joint.rated_torque_nm / (ratio * friction.efficiency * (1 - friction.coulomb_share));
  Motor motor;
  motor.rated_torque_nm = 1e-3 * std::max(1.0, std::round(1e3 * rated_nm));
  motor.peak_torque_nm = motor.rated_torque_nm * joint.effort_nm / joint.rated_torque_nm;
  motor.top_speed_rad_s = ratio * joint.velocity_rad_s;
  motor.coulomb_nm = friction.coulomb_share * motor.rated_torque_nm;
  motor.viscous_nm_s = friction.viscous_share * motor.rated_torque_nm / motor.top_speed_rad_s;
  return motor;
}

}  // namespace lf
