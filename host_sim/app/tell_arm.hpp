// What a user should know of a scenario's arm before anything is simulated with it.
#pragma once

#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

// On stderr, a line a note: joints without friction, joints that sink without power. Throws InputError when the description cannot be read.
void tell_arm_notes(const scenario::Scenario& scenario);

}  // namespace lf::app
