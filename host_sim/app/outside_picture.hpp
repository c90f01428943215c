// The robot before its panel as a run begins, as an onlooker sees it.
#pragma once

#include <string>

#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

// Where the vehicle is docked exactly. Written as PNG. `machine`: a scenario that can be run, of whose robot it is.
void draw_outside(const scenario::Scenario& scenario, const scenario::Scenario& machine, const std::string& picture);

}  // namespace lf::app
