// Whether a URDF is the arm that the control core was built of. The core's kinematics are constants; a URDF that is read later does not change them.
#pragma once

#include <string>

#include "shared/arm/arm_description.hpp"

namespace lf::config {

// What differs, in words: "its tool is up to 31.20 mm and 0.000 degrees off, and the limits of elbow differ". Empty for the same arm. Compares tool poses over the joints'
// ranges, the joints' limits, their screws and gears, what their motors give, where the fingers' joints and pads are, and whether the links' shapes lie within the capsules by
// which the core keeps its ways clear.
std::string difference_from_core(const ArmDescription& arm);

}  // namespace lf::config
