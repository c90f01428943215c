// Failures by their cause: what differs from run to run within one cause is taken out of its words.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

// A measured number, which has a decimal point or a unit behind it, becomes "…": "turned by 3.2 deg" and "turned by 5.1 deg" are one cause. Codes and
// counts stay: 0x2310, "(7)", "bus 0".
std::string cause_of(const std::string& reason);

struct Cause {
  std::string phase, cause;
  std::string example;                                    // the first run's own words
  bool false_success = false;                             // all of them, or none: the two are never one cause
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // indices of cell and run
};

// Of all failed runs: false successes first, then by number of runs, the largest first.
std::vector<Cause> causes_of(const Campaign& campaign);

}  // namespace lf::campaign
