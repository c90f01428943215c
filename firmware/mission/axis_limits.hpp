// What each axis may do at the pose where the arm is: its joint's limits are angles, and the axis knows counts only.
#pragma once

#include "firmware/arm/kinematics.hpp"
#include "firmware/canopen/network.hpp"

namespace lf::mission {

// A joint that lags this far behind its target is stuck: at full speed the position loop of 20 rad/s lags 0.035 rad, and the gripper leads by 0.05.
inline constexpr double following_window_rad = 0.15;

// Gives each axis its joint's top speed and `following_window_rad` in counts, rounded down. Call once a tick, after the frames came in.
// Between a joint and its target a screw has at least as many counts a radian as at the one of the two where it has fewer: d count / d angle rises to a
// single maximum within the stroke. With that many neither the speed nor the lag exceeds its limit at either of the two.
void limit_axes(const arm::Arm& arm, canopen::Network& network);

}  // namespace lf::mission
