// A campaign for a spreadsheet (RFC 4180): campaign.csv has a row a cell of the grid, runs.csv a row a run.
#pragma once

#include <string>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

std::string cells_csv(const Campaign& campaign);
std::string runs_csv(const Campaign& campaign);

}  // namespace lf::campaign
