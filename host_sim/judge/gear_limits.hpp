// How far a joint may be off its motor.
#pragma once

#include "shared/arm/arm_description.hpp"

namespace lf::judge {

struct GearLimits {
  double gives_rad =
      0;  // half of the play, and the wind-up by what the drive holds, or by what the gear holds without power where that is less
  double slips_rad = 0;  // half of the play, and what the gear gives way by as the power goes, where its drive held more than it does
};

// `stiffness_nm_rad`: of gear and links, as the world has it. Where the actuator has less lever the joint is wound up less.
GearLimits gear_limits(const ArmJoint& joint, double stiffness_nm_rad);

}  // namespace lf::judge
