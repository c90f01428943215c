// Figures of a motor that its joint cannot have: a gear that is wrong shows in the ratio, a torque that is the joint's and not the motor's in the rating.
#pragma once

#include <string>

#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// Throws InputError with `where`, the key's place, and what to state instead.
void check_motor(const JointDriveChoice& choice, std::size_t joint, const ArmJoint& description, const std::string& where);

}  // namespace lf::config
