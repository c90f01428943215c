#include "host_sim/campaign/statistics/wilson.hpp"

#include <algorithm>
#include <cmath>

namespace lf::campaign {

Interval wilson_95(std::size_t hits, std::size_t trials) {
  if (trials == 0) return {};
  constexpr double z = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const double n = static_cast<double>(trials), share = static_cast<double>(hits) / n;
  const double denominator = 1 + z * z / n;
  const double centre = (share + z * z / (2 * n)) / denominator;
  const double half = z / denominator * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
  // At the ends the bound is the end itself, which rounding misses.
  return {hits == 0 ? 0 : std::max(0.0, centre - half), hits == trials ? 1 : std::min(1.0, centre + half)};
}

}  // namespace lf::campaign
