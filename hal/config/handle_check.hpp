// Whether the handle that a file describes can be seen, held and turned as the file asks: what no single key can tell.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"

namespace lf::config {

// A sentence a problem, without the file's name: a target beyond the stops, a mark that covers too much of the bar, a bar that the jaw cannot hold.
std::vector<std::string> handle_problems(const PanelLayout& panel, const ValveStops& stops, const std::vector<Task>& tasks);

}  // namespace lf::config
