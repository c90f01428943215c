// Whether the parts of a panel leave one another free: what no single key can tell.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

// A sentence a problem, without the file's name: a button that covers a marker or another button, bars that meet, a part that hangs beyond the plate.
std::vector<std::string> panel_problems(const PanelLayout& panel, const PanelSurvey& survey = {});

// The height that a cap needs over the panel, m. A press ends `press_overtravel_m` below a cap's bottom at the latest. Where the cap broke off, the fingers
// must not meet the panel at a depth that would pass for the button's. They come the more aslant the farther off a button is: of those alike the steepest counts.
double lowest_button_m(const Machine& machine, const PanelLayout::Button& button);

// Buttons that are lower though a task presses one: a sentence, without the file's name.
std::vector<std::string> low_button_problems(const Machine& machine);

bool presses(const std::vector<Task>& tasks);

// The side up to which a marker's plate leaves buttons and valves free and lies on the panel.
double largest_marker_plate_m(const PanelLayout& panel, const PanelLayout::Marker& marker);

}  // namespace lf::config
