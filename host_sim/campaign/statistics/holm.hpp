// Of many tests one in twenty is significant by chance alone.
#pragma once

#include <vector>

namespace lf::campaign {

inline constexpr double beyond_chance = 0.05;

// The p-values as they count when all are looked at (Holm, Scand. J. Stat. 6, 1979): that any of those below 0.05 is there by chance has a probability of
// at most 0.05.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace lf::campaign
