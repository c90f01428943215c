// Figures of a motor or drive that its joint cannot have: a gear that is wrong shows in the ratio, a torque that is the joint's and not the motor's in the
// rating, a position unit that is too coarse in the joint's angle.
#pragma once

#include <string>

#include "hal/config/drive_kind.hpp"
#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// Throws InputError with `where`, the key's place, and what to state instead.
void check_motor(const JointDriveChoice& choice, const ArmJoint& description, const std::string& where);

// The core tells a joint that lags from one that follows by 1 mrad and some of the arm's counts: a unit of the drive's positions may be 1 mrad anywhere on the
// joint's stroke, or one count where that is coarser.
void check_position_unit(const JointDriveChoice& choice, const ArmJoint& description, const DriveKind& kind, const std::string& where);

}  // namespace lf::config
