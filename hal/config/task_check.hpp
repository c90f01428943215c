// Whether the machine can do a list of tasks, whoever gives it: what is refused before anything moves.
#pragma once

#include <string>

#include "hal/config/machine.hpp"

namespace lf::config {

// Of an arm that jobs are not planned for.
inline constexpr const char* no_jobs =
    "'tasks' has some, and jobs are planned for arms of slew, shoulder, elbow and roll, and for arms with five joints or more beside "
    "a roll. With `tasks: []` this one can be commissioned, homed and jogged: by `lanternfish serve` on a desk";

// Why a turn among them is refused: an angle beyond the handle's stops. Empty: none is.
std::string turn_problem(const mission::Tasks& tasks, const PanelLayout& panel, const PanelNames& names);

// The same of everything that a file of tasks is held against: stops, low caps, bars, torques, places out of reach or view, poses outside of
// the limits. `machine.tasks` do not count.
std::string tasks_problem(const Machine& machine, const Core& core, const mission::Tasks& tasks);

// Of the valves that a task turns, and in the docked mission's own panel of each: the wrist turns about the tool axis, the bar about the panel's normal, so that the wrist is faster than the
// bar by 1 / cos of the angle between the two.
std::vector<std::string> turn_speed_problems(const Machine& machine, const safety::Limits& limits);

// Of the valves that a task turns, those of which a file says that they take more than the hand can give.
std::vector<std::string> torque_problems(const Machine& machine, double hand_torque_nm);

}  // namespace lf::config
