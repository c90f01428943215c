// The vehicle that a scenario's machine states, as the simulator has it: its shapes and its lamps, in the arm's base frame.
#pragma once

#include <vector>

#include "host_sim/optics/optics.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/scene/scene.hpp"

namespace lf::scenario {

// Of its boxes and capsules. The default vehicle has a look of its own, within those that the default machine states.
std::vector<scene::Shape> vehicle_shapes(const Scenario& scenario);

// All shine at the panel where it is docked nominally.
std::vector<optics::LampConfig> lamps(const Scenario& scenario);

}  // namespace lf::scenario
