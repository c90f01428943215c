// The arm that the core is told of.
#pragma once

#include <string>

#include "firmware/arm/kinematics.hpp"

namespace lf::config {

// Throws InputError for a file that cannot be read, and for an arm that is not of the core's form.
arm::Arm read_arm(const std::string& urdf_file);

}  // namespace lf::config
