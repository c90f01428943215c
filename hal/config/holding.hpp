// What keeps the arm where it is when it has no power: every stop ends without.
#pragma once

#include <string>
#include <vector>

#include "hal/config/drive_kind.hpp"
#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// A load in the hand, and what nobody has measured.
inline constexpr double holding_reserve = 1.5;

// Of one joint.
struct Holding {
  std::string by;        // as drives.<joint>.holding
  double held_nm = 0;    // what it takes to move the joint
  double weight_nm = 0;  // the most that the arm's weight in water asks of it, the vehicle level; without a load in the hand
  bool holds() const { return holding_reserve * weight_nm <= held_nm; }
  std::string text() const;  // "gear holds 150 N m", "brake, taken to hold 150 N m", "nothing but friction, 1.2 N m"
};

// Throws InputError, beginning with `where`, for a brake at a drive whose profile has none.
void check_holding(const JointDriveChoice& choice, const DriveKind& kind, const std::string& where);

// What it takes to move a joint without power, in the pose in which that is least. A brake is taken to hold 1.5 times the motor's peak torque.
double held_nm(const ArmJoint& joint, const JointDriveChoice& choice);

// The largest of the weight's torque about each joint over poses drawn within the limits, some per cent below the true maximum at most.
std::vector<double> weight_torques_nm(const ArmDescription& arm);

// Of each joint, the jaw's last.
std::vector<Holding> holding_of(const ArmDescription& arm, const Drives& drives);

// A sentence where joints sink without power, none where all hold.
std::vector<std::string> holding_notes(const ArmDescription& arm, const std::vector<Holding>& joints);

}  // namespace lf::config
