// What an arm gives way by where it presses, and how fast it may come to what is hard.
#pragma once

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

// N at the tool point, along the unit vector `way` (base frame), for a metre by which links and gears give way there.
double tool_stiffness_n_m(const Arm& arm, const JointVector& q_rad, const Vec3& way);

// The speed along `way` (m/s) at which the arm presses with no more than `push_n` when it meets something hard and is then stopped: it goes on at its speed until
// that is noticed, and then brakes each joint as hard as `limits` allow. `rates` are the joints' (rad/s) at 1 m/s. Without end where it never presses so hard.
double gentle_speed_m_s(const Arm& arm, const JointVector& q_rad, const JointVector& rates, const Vec3& way, const JointLimits& limits,
                        double push_n);

}  // namespace lf::arm
