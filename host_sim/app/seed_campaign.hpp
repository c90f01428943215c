// A scenario, or a grid of them, flown with many seeds: the runs, and what is left of them in a campaign's folder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/app/campaign_options.hpp"
#include "host_sim/campaign/campaign.hpp"
#include "host_sim/campaign/grid.hpp"

namespace lf::app {

// What is to be flown: the campaign with its cells, and no run yet. Throws InputError for seeds, a grid or a scenario that cannot be flown, and for two cells
// that are the same scenario.
campaign::Campaign planned(const CampaignOptions& options, const campaign::Grid& grid);

// Flies what is not in `folder` yet, and puts all runs of `seeds` into the campaign. Runs of this experiment that are there are kept. An interrupt ends it early.
// Returns why nothing more could be flown (a full disk), or nothing.
std::string fly(const CampaignOptions& options, const campaign::Grid& grid, const std::vector<std::uint64_t>& seeds,
                const std::filesystem::path& folder, campaign::Campaign& campaign);

}  // namespace lf::app
