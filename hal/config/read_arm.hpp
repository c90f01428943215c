// The arm that the core is told of.
#pragma once

#include <string>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

struct NamedArm {
  arm::Arm arm = arm::arm5e();
  JointNames joints;
};

// Throws InputError for a file that cannot be read, and for an arm that is not of the core's form.
NamedArm read_arm(const std::string& urdf_file);
// Of a description that was read from there. Throws InputError where the core's closed forms put the tool elsewhere than the description's joints do: nothing that
// load_arm_urdf() accepts should come to that.
arm::Arm arm_of(const ArmDescription& description, const std::string& urdf_file);

// For the checks that come before the core's, of the arm that a key of `told_in` names. Where it cannot be read it is the default machine's: the core's own checks
// tell that.
NamedArm arm_for_checks(const std::string& told_in, const std::string& urdf);

}  // namespace lf::config
