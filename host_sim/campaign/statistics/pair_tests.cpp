#include "host_sim/campaign/statistics/pair_tests.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host_sim/campaign/statistics/percentile.hpp"
#include "shared/random.hpp"

namespace lf::campaign {
namespace {

constexpr std::size_t exact_ranks = 300;  // 90,600 sums of doubled ranks, 27 million additions
constexpr std::size_t exact_swaps = 14;   // 16,384 of them
constexpr std::size_t drawn_swaps = 19'999;

struct SignedRanks {
  std::vector<std::size_t> doubled;  // ranks from 1, doubled: the mean of tied ranks is a whole number then
  std::size_t positive = 0;          // the doubled ranks' sum of the positive differences
  double ties = 0;                   // sum of t^3 - t over groups of t equal differences
};

SignedRanks ranks_of(std::vector<double> differences) {
  std::sort(differences.begin(), differences.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  SignedRanks ranks;
  for (std::size_t from = 0, to = 0; from < differences.size(); from = to) {
    while (to < differences.size() && !differ(std::abs(differences[from]), std::abs(differences[to]))) ++to;
    const double t = static_cast<double>(to - from);
    ranks.ties += t * t * t - t;
    for (std::size_t i = from; i < to; ++i) {
      ranks.doubled.push_back(from + to + 1);  // 2 * mean of from + 1 .. to
      if (differences[i] > 0) ranks.positive += from + to + 1;
    }
  }
  return ranks;
}

double exact_p(const SignedRanks& ranks) {
  std::size_t most = 0;
  for (const std::size_t rank : ranks.doubled) most += rank;
  std::vector<double> probability(most + 1, 0.0);  // of each sum, over the signs of the ranks so far
  probability[0] = 1;
  std::size_t reached = 0;
  for (const std::size_t rank : ranks.doubled) {
    reached += rank;
    for (std::size_t sum = reached + 1; sum-- > 0;) probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
  }
  double below = 0, above = 0;
  for (std::size_t sum = 0; sum <= most; ++sum) {
    below += sum <= ranks.positive ? probability[sum] : 0;
    above += sum >= ranks.positive ? probability[sum] : 0;
  }
  return std::min(1.0, 2 * std::min(below, above));
}

double normal_p(const SignedRanks& ranks) {
  const double n = static_cast<double>(ranks.doubled.size());
  const double variance = n * (n + 1) * (2 * n + 1) / 24 - ranks.ties / 48;
  const double off = std::abs(static_cast<double>(ranks.positive) / 2 - n * (n + 1) / 4);
  return std::min(1.0, std::erfc(std::max(0.0, off - 0.5) / std::sqrt(2 * variance)));
}

// The percentile of both sides after some pairs were swapped, and how far they are apart.
class Swapped {
 public:
  Swapped(std::span<const double> before, std::span<const double> after, double share) : before_(before), after_(after), share_(share) {}

  template <class IsSwapped>
  double distance(IsSwapped is_swapped) {
    a_.assign(before_.begin(), before_.end());
    b_.assign(after_.begin(), after_.end());
    for (std::size_t i = 0; i < a_.size(); ++i) {
      if (is_swapped(i)) std::swap(a_[i], b_[i]);
    }
    return std::abs(nearest_rank(a_, share_) - nearest_rank(b_, share_));
  }

 private:
  std::span<const double> before_, after_;
  double share_;
  std::vector<double> a_, b_;
};

}  // namespace

bool differ(double before, double after) { return std::abs(before - after) > same_share * std::max(std::abs(before), std::abs(after)); }

double wilcoxon(std::span<const double> before, std::span<const double> after) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (differ(before[i], after[i])) differences.push_back(after[i] - before[i]);
  }
  if (differences.empty()) return 1;
  const SignedRanks ranks = ranks_of(std::move(differences));
  return ranks.doubled.size() <= exact_ranks ? exact_p(ranks) : normal_p(ranks);
}

double swap_test(std::span<const double> before, std::span<const double> after, double share) {
  std::vector<std::size_t> swaps(before.size(), 0);  // which bit decides on a pair, from 1; 0: a swap changes nothing
  std::size_t differing = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (differ(before[i], after[i])) swaps[i] = ++differing;
  }
  if (differing == 0) return 1;
  Swapped swapped(before, after, share);
  const double moved = swapped.distance([](std::size_t) { return false; }) * (1 - same_share);
  std::size_t as_far = 0;
  if (differing <= exact_swaps) {
    const std::size_t all = std::size_t{1} << differing;
    for (std::size_t bits = 0; bits < all; ++bits)
      as_far += swapped.distance([&](std::size_t i) { return swaps[i] > 0 && (bits >> (swaps[i] - 1) & 1u) != 0; }) >= moved ? 1 : 0;
    return static_cast<double>(as_far) / static_cast<double>(all);
  }
  std::uint64_t state = 1;
  for (std::size_t draw = 0; draw < drawn_swaps; ++draw) {
    const auto is_swapped = [&](std::size_t i) {
      if (swaps[i] == 0) return false;
      state += splitmix64_step;
      return (splitmix64(state) >> 63) != 0;
    };
    as_far += swapped.distance(is_swapped) >= moved ? 1 : 0;
  }
  // What was measured is one of the swaps, too (Phipson and Smyth, Stat. Appl. Genet. Mol. Biol. 9, 2010).
  return static_cast<double>(as_far + 1) / static_cast<double>(drawn_swaps + 1);
}

}  // namespace lf::campaign
