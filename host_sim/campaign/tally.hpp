// What the runs of one cell came to together.
#pragma once

#include <string>
#include <vector>

#include "host_sim/campaign/campaign.hpp"
#include "host_sim/campaign/statistics/wilson.hpp"

namespace lf::campaign {

// Of a figure over the runs that have it. Of one where more is better the p95 is what 95 % of the runs reach, and the worst is the smallest.
struct Spread {
  std::size_t figure = 0;  // index into figures()
  std::size_t runs = 0;
  double median = record::unknown, p95 = record::unknown, worst = record::unknown;
  std::vector<std::size_t> worst_runs;  // indices, the worst first; at most three
};

struct Tally {
  std::size_t runs = 0, successes = 0, false_successes = 0, not_flown = 0, calibrations_doubted = 0;
  Interval success, false_success;  // 95 %
  std::vector<Spread> spreads;      // of the figures that any run has
};

Tally tally_of(const Cell& cell);
// Counts and intervals over all cells; the figures of different scenarios are not put together.
Tally total_of(const Campaign& campaign);

// Whether no run failed and none is missing.
bool all_succeeded(const Campaign& campaign);

}  // namespace lf::campaign
