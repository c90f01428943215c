// Figures of a motor or drive that its joint cannot have: a gear that is wrong shows in the ratio, a torque that is the joint's and not the motor's in the
// rating, a position unit that is too coarse in the joint's angle.
#pragma once

#include <string>

#include "firmware/canopen/drive_profile.hpp"
#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// Throws InputError with `where`, the key's place, and what to state instead.
void check_motor(const JointDriveChoice& choice, std::size_t joint, const ArmJoint& description, const std::string& where);

// The core tells a joint that lags from one that follows by 1 mrad, or by two of its counts where these are coarser: a drive's unit may be no more than that.
void check_position_unit(const JointDriveChoice& choice, std::size_t joint, const ArmJoint& description,
                         const canopen::Ratio& units_per_count, const std::string& where);

}  // namespace lf::config
