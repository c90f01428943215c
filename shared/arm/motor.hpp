// The motor of a joint, as the arm's description implies it: figures at the motor's shaft, where drives measure. Hosted side only.
//
// The description gives torques at the joint: rated, driving a load, where the screw has the most lever. Virtual work takes them to the shaft through ratio and
// friction. A motor's rating is whole milli newton metres, as object 6076 of most drives can say it.
#pragma once

#include "shared/arm/arm_description.hpp"

namespace lf {

// Object 6077 tells thousandths of the rating in 16 bits.
inline constexpr double most_peak_of_rating = 30;

struct Motor {
  double rated_torque_nm = 0;
  double peak_torque_nm = 0;
  double top_speed_rad_s = 0;
  double coulomb_nm = 0;
  double viscous_nm_s = 0;  // per rad/s of the motor
};

// Turns of the motor per turn of the joint at an angle; `counts_per_rev`: of the description's counts in a revolution of the motor.
double motor_ratio(const ArmActuator& actuator, double q_rad, double counts_per_rev);
// The largest and the least over the joint's stroke, of 65 angles.
double best_motor_ratio(const ArmJoint& joint, double counts_per_rev);
double least_motor_ratio(const ArmJoint& joint, double counts_per_rev);
Motor motor_of(const ArmJoint& joint, double counts_per_rev);
// What the joint holds against a load, its motor at the rated torque, where the screw has the most lever: the gear's friction helps it. Of a
// gear whose load cannot drive its motor: what the motor pushes.
double held_torque_nm(const ArmJoint& joint);

}  // namespace lf
