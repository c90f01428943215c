// What keeps the arm where it is when it has no power: every stop ends without.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// Of one joint.
struct Holding {
  std::string by;        // as drives.<joint>.holding
  double held_nm = 0;    // what it takes to move the joint
  double weight_nm = 0;  // the most that the arm's weight in water asks of it, the vehicle level; without a load in the hand
  bool holds() const { return weight_nm <= held_nm; }
  std::string text() const;  // "gear holds 150 N m", "brake", "nothing but friction, 1.2 N m"
};

// What it takes to move a joint without power. A brake is taken to hold 1.5 times what the motor's peak torque gives.
double held_nm(const ArmJoint& joint, const JointDriveChoice& choice);

// The largest of the weight's torque about each joint over poses drawn within the limits, some per cent below the true maximum at most.
std::vector<double> weight_torques_nm(const ArmDescription& arm);

// Of each joint, the jaw's last.
std::vector<Holding> holding_of(const ArmDescription& arm, const Drives& drives);

// A sentence where joints sink without power, none where all hold.
std::vector<std::string> holding_notes(const ArmDescription& arm, const std::vector<Holding>& joints);

}  // namespace lf::config
