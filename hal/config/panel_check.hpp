// Whether the parts of a panel leave one another free: what no single key can tell.
#pragma once

#include <string>
#include <vector>

#include "shared/panel/panel_layout.hpp"

namespace lf::config {

// A sentence a problem, without the file's name: a button that covers the marker or another button, a part that hangs beyond the plate.
std::vector<std::string> panel_problems(const PanelLayout& panel);

// The side up to which the marker's plate leaves the buttons free and lies on the panel.
double largest_marker_plate_m(const PanelLayout& panel);

}  // namespace lf::config
