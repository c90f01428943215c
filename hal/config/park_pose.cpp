#include "hal/config/park_pose.hpp"

#include <algorithm>
#include <cstdio>

#include "shared/input_error.hpp"

namespace lf::config {

std::string park_problem(const Machine& machine) {
  if (machine.park_rad.size() == machine.joints.arm_joints()) return "";
  const std::size_t count = machine.joints.arm_joints();
  return "'arm.park_rad' takes " + std::to_string(count) + " numbers: " + machine.joints.listed(count);
}

arm::JointVector as_folded(const arm::Arm& arm, const std::vector<double>& park_rad) {
  arm::JointVector q_rad = arm::JointVector::Zero();
  for (std::size_t i = 0; i < std::min(park_rad.size(), arm.arm_joints()); ++i) q_rad[static_cast<Eigen::Index>(i)] = park_rad[i];
  return q_rad;
}

arm::JointVector park_pose(const Machine& machine) {
  if (const std::string problem = park_problem(machine); !problem.empty()) throw InputError(machine.told_in() + ": " + problem);
  arm::JointVector q = arm::JointVector::Zero();
  for (std::size_t i = 0; i < machine.arm.arm_joints(); ++i) {
    const ArmModel::Joint& joint = machine.arm.joint(i);
    q[static_cast<Eigen::Index>(i)] = machine.park_rad[i];
    if (machine.park_rad[i] >= joint.lower_rad && machine.park_rad[i] <= joint.upper_rad) continue;
    char text[160];
    std::snprintf(text, sizeof text, ": 'arm.park_rad' has %.5g for the %s, whose stroke is %.5g to %.5g rad", machine.park_rad[i],
                  machine.joints[i].c_str(), joint.lower_rad, joint.upper_rad);
    throw InputError(machine.told_in() + text);
  }
  return q;
}

}  // namespace lf::config
