// What passes between a drive's power stage and the joint it moves, once per physics step.
//
// A drive imposes a speed, up to a torque. Screws and gears rub: they push less than the motor's torque would, hold more, and hold without power.
#pragma once

#include <array>
#include <cstddef>

#include "shared/messages/capacity.hpp"

namespace lf {

// One of each joint: the arm's, base to tip, and after the last of them the jaw. What lies past an arm's own number of joints is not used.
template <class T>
using PerJoint = std::array<T, capacity::joints>;
// One of each joint that places the tool.
template <class T>
using PerArmJoint = std::array<T, capacity::arm_joints>;

// From the world to the drive.
struct JointReading {
  double position_rad = 0;        // the joint itself (ground truth)
  double motor_position_rad = 0;  // the motor, seen through the gear: differs from the joint by the backlash. Encoders read this one
  double velocity_rad_s = 0;
  double torque_nm = 0;  // that the drive applies to the joint, averaged over the step
};

// From the drive to the world.
struct JointDrive {
  double velocity_rad_s = 0;   // 0 holds
  double torque_limit_nm = 0;  // what the drive can apply now, pushing the joint the way it moves
  bool released = false;       // no power: only the self-locking gear's friction holds (`holding_torque_nm` in the arm's description)
  double holding_limit_nm =
      0;  // with which it holds against being pushed back: friction helps it there. Less than `torque_limit_nm` counts as that
};

using JointReadings = PerJoint<JointReading>;
using JointDrives = PerJoint<JointDrive>;

}  // namespace lf
