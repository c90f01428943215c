// A range campaign's results, and as JUnit XML.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host_sim/campaign/junit.hpp"

namespace lf::app {

// What a drawn value came to. "unnamed": it ended safely or was refused, but names none of the drawn keys (judge/range_rules.hpp).
inline constexpr std::array verdicts{"success", "safe", "refused", "unnamed", "unsafe"};

// Of the draws of single keys, how many must succeed.
inline constexpr double single_share = 0.8;

struct RangeResult {
  std::string name, key, set, verdict, reason;
};

// A case a row, grouped by key. "unsafe" and "unnamed" fail; what the scenario's check refused was not flown. A case at the end holds the share of the single
// draws that succeeded. `not_flown`: rows that an interrupt came before.
campaign::TestSuite range_suite(const std::string& scenario, const std::vector<RangeResult>& results,
                                const std::vector<std::string>& not_flown);

}  // namespace lf::app
