// The default machine's arm, as the build made it of its URDF.
#pragma once

#include "firmware/arm/kinematics.hpp"

namespace lf::test {

inline const arm::Arm arm5e = arm::arm5e();
inline const ArmModel::Jaw& jaw5e = arm5e.jaw();

}  // namespace lf::test
