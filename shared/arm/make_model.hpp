// The numbers that the core works with, made of an arm's description.
#pragma once

#include "shared/arm/arm_description.hpp"
#include "shared/arm/arm_model.hpp"

namespace lf {

// Of a description that load_arm_urdf() has accepted.
ArmModel make_model(const ArmDescription& description);

}  // namespace lf
