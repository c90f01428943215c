// How long a mission may take at the speeds that its scenario states.
#pragma once

#include "host_sim/scenario/scenario.hpp"

namespace lf::scenario {

// Every straight way, press, turn, sweep and way through free space at its stated speed, taken twice where a step may be tried again, and what is left of a
// mission at the default speeds. An upper estimate, bounded by the longest time limit that a scenario may state.
double longest_mission_s(const Scenario& scenario);

}  // namespace lf::scenario
