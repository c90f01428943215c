// What passes between a drive's power stage and the joint it moves, once per physics step.
//
// A drive imposes a speed, up to a torque. Screws and gears rub: they push less than the motor's torque would, hold more, and hold without power.
#pragma once

#include <array>
#include <cstddef>

namespace lf {

// The joints in the order of the arm's chain, and of the CAN nodes 1 to 5.
enum class Joint : std::size_t { slew = 0, shoulder = 1, elbow = 2, roll = 3, jaw = 4 };
inline constexpr std::size_t joint_count = 5;      // with the jaw
inline constexpr std::size_t arm_joint_count = 4;  // those that place the tool

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

using JointReadings = std::array<JointReading, joint_count>;
using JointDrives = std::array<JointDrive, joint_count>;

}  // namespace lf
