// Whether the arm can work within a file of safety limits: what the file's own checksum and order do not tell.
#pragma once

#include <string>
#include <vector>

#include "firmware/config.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// A sentence a problem, without the file's name; each begins with the entry at fault. `controller` gives the folded pose and the exposure.
std::vector<std::string> limits_problems(const safety::Limits& limits, const ControllerConfig& controller, const JointNames& names);

// The same of one pose of the arm, for `what`, as "the valve": joints beyond their range, a tool outside of the workspace.
std::vector<std::string> pose_problems(const arm::Arm& arm, const JointNames& names, const safety::Limits& limits,
                                       const arm::JointVector& q_rad, const std::string& what);

}  // namespace lf::config
