// Whether the machine can do a list of tasks, whoever gives it: what is refused before anything moves.
#pragma once

#include <string>

#include "hal/config/machine.hpp"

namespace lf::config {

// Why a turn among them is refused: an angle beyond the handle's stops. Empty: none is.
std::string turn_problem(const mission::Tasks& tasks, const PanelLayout& panel);

// The same of everything that a file of tasks is held against: stops, low caps, places out of reach, poses outside of the limits. `machine.tasks` do not count.
std::string tasks_problem(const Machine& machine, const safety::Limits& limits, const mission::Tasks& tasks);

}  // namespace lf::config
