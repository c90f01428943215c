// Whether a quantity that was measured twice, in pairs, has changed by more than chance. Two-sided.
#pragma once

#include <span>

namespace lf::campaign {

// Pairs differ when their values do by more than this share: less is rounding on the way through a file.
inline constexpr double same_share = 1e-9;
bool differ(double before, double after);

// The signed-rank test (Wilcoxon, Biometrics Bulletin 1, 1945): whether the pairs' typical value has moved. Pairs that do not differ are left out, equal
// differences share their rank. Exact for up to 300 pairs that differ, by the distribution of all their signs; for more the normal approximation,
// corrected for ties and continuity. 1 when no pair differs. The spans are of one length, all values finite.
double wilcoxon(std::span<const double> before, std::span<const double> after);

// A permutation test of a percentile: if before and after were the same, swapping them within a pair would change nothing. The share of the swaps that
// move the percentile (nearest rank) at least as far as it has moved. All swaps for up to 14 pairs that differ, else 19,999 drawn ones, always the
// same. 1 when no pair differs. The spans are of one length, all values finite.
double swap_test(std::span<const double> before, std::span<const double> after, double share);

}  // namespace lf::campaign
