// How far a joint may be off its motor.
#pragma once

#include "shared/arm/arm_description.hpp"

namespace lf::judge {

struct GearLimits {
  // Half of the play, and the wind-up by what the drive holds, or the gear without power where that is less.
  double gives_rad = 0;
  // Half of the play, and what a gear that holds less than its drive gives way by as the power goes.
  double slips_rad = 0;
};

// `stiffness_nm_rad`: of gear and links, as the world has it. Where the actuator has less lever the joint is wound up less.
GearLimits gear_limits(const ArmJoint& joint, double stiffness_nm_rad);

}  // namespace lf::judge
