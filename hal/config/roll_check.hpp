// Whether the wrist's roll has the range for the turns that the tasks ask for, from wherever a handle may stand.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"

namespace lf::config {

// A sentence a valve, without the file's name. A turn may be done in parts, the shortest a quarter of the way: where the wrist cannot do even that, the mission would
// end before the handle. Of places out of reach it says nothing.
std::vector<std::string> roll_problems(const Machine& machine, const safety::Limits& limits);

}  // namespace lf::config
