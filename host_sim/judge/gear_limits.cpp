#include "host_sim/judge/gear_limits.hpp"

#include <algorithm>

#include "shared/arm/motor.hpp"

namespace lf::judge {

GearLimits gear_limits(const ArmJoint& joint, double stiffness_nm_rad) {
  const double play_rad = 0.5 * joint.backlash_rad, held_nm = held_torque_nm(joint);
  return {play_rad + std::min(held_nm, joint.holding_torque_nm) / stiffness_nm_rad,
          play_rad + std::max(0.0, held_nm - joint.holding_torque_nm) / stiffness_nm_rad};
}

}  // namespace lf::judge
