// The picture of `lanternfish reach`.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/app/reach_survey.hpp"

namespace lf::app {

// A PNG: both heights side by side, a pixel a millimetre, coloured by tilt, with the panel's outlines and the targets' figures.
std::vector<std::uint8_t> draw_reach(const scenario::Scenario& scenario, const std::vector<ReachGrid>& grids,
                                     const std::vector<ReachTarget>& targets);

}  // namespace lf::app
