// What the default machine's joints are called.
#pragma once

#include <cstddef>
#include <string>

#include "shared/arm/joint_names.hpp"

namespace lf::arm5e_joint {

inline std::string name(std::size_t joint) { return JointNames()[joint]; }

}  // namespace lf::arm5e_joint
