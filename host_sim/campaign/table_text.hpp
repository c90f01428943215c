// What a campaign came to, for a terminal.
#pragma once

#include <string>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

// Shares with their 95 % intervals, the figures of each cell, and the failures by cause with their seeds.
std::string table_text(const Campaign& campaign);

}  // namespace lf::campaign
