#include "hal/config/park_pose.hpp"

#include <cstdio>

#include "hal/config/homing_file.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

arm::JointVector park_pose(const Machine& machine) {
  if (machine.park_rad.size() != arm_joint_count)
    throw InputError(machine.told_in() + ": 'arm.park_rad' takes 4 numbers: slew, shoulder, elbow and roll");
  arm::JointVector q;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const ArmModel::Joint& joint = machine.arm.model().joints[i];
    q[static_cast<Eigen::Index>(i)] = machine.park_rad[i];
    if (machine.park_rad[i] >= joint.lower_rad && machine.park_rad[i] <= joint.upper_rad) continue;
    char text[160];
    std::snprintf(text, sizeof text, ": 'arm.park_rad' has %.5g for the %s, whose stroke is %.5g to %.5g rad", machine.park_rad[i],
                  joint_name(i), joint.lower_rad, joint.upper_rad);
    throw InputError(machine.told_in() + text);
  }
  return q;
}

}  // namespace lf::config
