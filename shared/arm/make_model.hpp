// The numbers that the core works with, made of an arm's description.
#pragma once

#include "shared/arm/arm_description.hpp"
#include "shared/arm/arm_model.hpp"

namespace lf {

// Of a description that load_arm_urdf() has accepted.
ArmModel make_model(const ArmDescription& description);

// By which links and gear of a joint give way under load: what the description says, or else what is usual.
double stiffness_nm_rad(const ArmDescription& description, std::size_t joint);

}  // namespace lf
