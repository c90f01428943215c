// The picture of `lanternfish reach`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/app/reach_survey.hpp"

namespace lf::app {

// The encoder for a picture's name, by its ending and whatever its case: ".png" (also for a name without an ending) or ".jpg". Throws InputError for another.
std::string picture_format(const std::filesystem::path& name);

// In that format: both heights side by side, a pixel a millimetre, coloured by tilt, with the panel's outlines and the targets' figures.
std::vector<std::uint8_t> draw_reach(const scenario::Scenario& scenario, const std::vector<ReachGrid>& grids,
                                     const std::vector<ReachTarget>& targets, const std::string& format);

}  // namespace lf::app
