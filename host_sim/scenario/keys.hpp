// The one table of what a scenario may say: each key's path, unit, range, words and meaning, bound to its member. The reader, the JSON Schema, the
// commented listing and the documentation all come from it.
#pragma once

#include <vector>

#include "hal/config/key.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::scenario {

using config::Key;

// In the order of the documentation. The pointers are into the argument.
std::vector<Key> keys(Scenario& scenario);
}  // namespace lf::scenario
