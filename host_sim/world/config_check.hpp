// Refuses a world that makes no sense. Internal to this folder.
#pragma once

#include "host_sim/world/world.hpp"

namespace lf::world {

// Throws InputError naming the value.
void check(const WorldConfig& config);

}  // namespace lf::world
