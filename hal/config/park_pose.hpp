// The folded arm, as a machine's keys have it and as the core takes it.
#pragma once

#include "hal/config/machine.hpp"

namespace lf::config {

// Throws InputError for another count of numbers than the arm has joints, and for an angle beyond a joint's stroke. The file of limits is held against the pose
// elsewhere.
arm::JointVector park_pose(const Machine& machine);
// The same of numbers that nobody has checked: those that are missing are 0.
arm::JointVector as_folded(const arm::Arm& arm, const std::vector<double>& park_rad);
// What is wrong with its count, or nothing.
std::string park_problem(const Machine& machine);

}  // namespace lf::config
