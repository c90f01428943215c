// Campaigns made up from formulas.
#pragma once

#include <string>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign::test {

inline constexpr const char* friction_scenario = "time_limit_s: 400\nvalve:\n  friction_nm: 2  # N m\n  start_deg: {min: -40, max: 40}\n";

// A run that succeeded, its figures one formula of the seed.
RunSummary run(std::uint64_t seed);
// One that failed after the scan: the valve's figures are missing.
RunSummary failed(std::uint64_t seed, const std::string& phase, const std::string& reason);

// One cell, seeds 1 to `count`, all well.
Campaign campaign(std::size_t count);
// Two cells of a grid over the friction, four seeds each.
Campaign grid();

// Index into figures(), by name.
std::size_t figure(const std::string& name);

}  // namespace lf::campaign::test
