// What an arm gives way by where it presses, and how fast it may come to what is hard.
#pragma once

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

// N at the tool point, along the unit vector `way` (base frame), for a metre by which links and gears give way there.
double tool_stiffness_n_m(const Arm& arm, const JointVector& q_rad, const Vec3& way);

// The least force against the tool point along `way`, N, that raises some joint's torque by what `torques_nm` has for it; infinite where none would rise.
double least_felt_n(const Arm& arm, const JointVector& q_rad, const Vec3& way, const JointVector& torques_nm);

// The speed along `way` (m/s) at which the arm, once it has met something hard and felt it, presses no more than `push_n` harder until it stands: it goes on at its
// speed for 40 ms, and then brakes each joint as hard as `limits` allow. What it takes to be felt comes on top. `rates` are the joints' (rad/s) at 1 m/s. 2 mm/s at least.
double gentle_speed_m_s(const Arm& arm, const JointVector& q_rad, const JointVector& rates, const Vec3& way, const JointLimits& limits,
                        double push_n);

}  // namespace lf::arm
