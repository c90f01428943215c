#include "firmware/mission/axis_limits.hpp"

#include <algorithm>

#include "firmware/arm/actuator.hpp"

namespace lf::mission {

void limit_axes(const arm::Arm& arm, canopen::Network& network) {
  for (std::size_t i = 0; i < std::min(arm.joint_count(), network.drive_count()); ++i) {
    const ArmModel::Joint& joint = arm.joint(i);
    canopen::Axis& axis = network.axis(i);
    const double here_rad = arm::rad_from_counts(joint, axis.actual_counts());
    const double target_rad = arm::rad_from_counts(joint, axis.target_counts());
    const double coarsest_rad = std::max(arm::rad_per_count(joint, here_rad), arm::rad_per_count(joint, target_rad));
    axis.set_limits_here(
        {static_cast<std::uint32_t>(joint.velocity_rad_s / coarsest_rad), static_cast<std::uint32_t>(following_window_rad / coarsest_rad)});
  }
}

}  // namespace lf::mission
