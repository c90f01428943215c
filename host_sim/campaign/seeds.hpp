// Which seeds a campaign flies.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lf::campaign {

inline constexpr std::uint64_t most_runs = 1'000'000;

// "1-50", "7" or a list of both, "1,2,7-9", both ends included; ascending. Throws InputError that names the part which is no seed or range, which runs
// backwards, or which has a seed again, and for more than a million.
std::vector<std::uint64_t> parse_seeds(const std::string& text);

}  // namespace lf::campaign
