// Whether the answer of `plane` is to be trusted: how many of the points agree with it, how they are spread on it, and whether they can be metres.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shared/messages/panel_vision.hpp"

namespace lf::app {

// Reasons to doubt a valid fit, a sentence each; empty: none. `threshold_m` is the fit's.
std::vector<std::string> plane_doubts(std::span<const CloudPoint> points, const PlaneFit& fit, double threshold_m);

}  // namespace lf::app
