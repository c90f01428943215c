// Whether the handles that a file describes can be seen, held and turned as the file asks: what no single key can tell.
#pragma once

#include <string>
#include <vector>

#include "hal/config/machine.hpp"

namespace lf::config {

// Two angles a turn apart look the same, and a look errs by a few degrees.
inline constexpr double widest_range_deg = 350;
// The thickest bar that the jaw opens for and whose angle a scan still tells.
double thickest_bar_m(const ArmModel::Jaw& jaw, const PanelLayout::Valve& valve);
// The longest mark on the bar's end that still tells its ends apart.
double longest_mark_m(const PanelLayout::Valve& valve);

// A sentence a problem, without the file's name: a task for what the panel has not, a target beyond the stops, a mark that covers too much of the bar, a bar that the jaw cannot hold.
std::vector<std::string> handle_problems(const Machine& machine);

}  // namespace lf::config
