// The bodies of a scene with the default machine, by their names.
#pragma once

#include "shared/scene/scene.hpp"

namespace lf::arm5e_body {

inline constexpr scene::BodyId vehicle = 0, slew = 1, upper_arm = 2, forearm = 3, wrist = 4, finger_a = 5, finger_b = 6, panel = 7,
                               obstacle = 8, first_feature = 9;

}  // namespace lf::arm5e_body
