#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "host_sim/campaign/statistics/count_tests.hpp"
#include "host_sim/campaign/statistics/holm.hpp"
#include "host_sim/campaign/statistics/pair_tests.hpp"
#include "host_sim/campaign/statistics/percentile.hpp"
#include "host_sim/campaign/statistics/wilson.hpp"

namespace lf::campaign {
namespace {

// Newcombe, Statistics in Medicine 17, 1998, table I, method 3: the score interval without continuity correction.
TEST(Statistics, WilsonsIntervalIsThePublishedOne) {
  struct Row {
    std::size_t hits, of;
    double low, high;
  };
  for (const Row& row : {Row{81, 263, 0.2553, 0.3662}, Row{15, 148, 0.0624, 0.1605}, Row{0, 20, 0, 0.1611}, Row{1, 29, 0.0061, 0.1718}}) {
    const Interval interval = wilson_95(row.hits, row.of);
    EXPECT_NEAR(interval.low, row.low, 5e-5) << row.hits << " of " << row.of;
    EXPECT_NEAR(interval.high, row.high, 5e-5) << row.hits << " of " << row.of;
  }
}

// Of all trials a hit: n / (n + z^2).
TEST(Statistics, WilsonsIntervalHasAWidthAtItsEnds) {
  EXPECT_NEAR(wilson_95(200, 200).low, 200 / (200 + 1.959963984540054 * 1.959963984540054), 1e-12);
  EXPECT_EQ(wilson_95(200, 200).high, 1);
  EXPECT_EQ(wilson_95(0, 200).low, 0);
  EXPECT_EQ(wilson_95(0, 0).low, 0);
  EXPECT_EQ(wilson_95(0, 0).high, 1);
}

// The lady tasting tea (Fisher 1935): 3 of 4 cups right is 34 of 70 two-sided, 4 of 4 is 2 of 70. And Fisher's twins and their convictions (1935): 10 of 13
// against 2 of 17, two-sided 0.0005367.
TEST(Statistics, FishersTestIsThePublishedOne) {
  EXPECT_NEAR(fisher(3, 4, 1, 4), 34.0 / 70, 1e-12);
  EXPECT_NEAR(fisher(4, 4, 0, 4), 2.0 / 70, 1e-12);
  EXPECT_NEAR(fisher(10, 13, 2, 17), 0.0005367, 5e-8);
  EXPECT_NEAR(fisher(2, 17, 10, 13), 0.0005367, 5e-8);
  EXPECT_NEAR(fisher(50, 50, 50, 50), 1, 1e-12);
  EXPECT_EQ(fisher(0, 0, 3, 4), 1);
}

// Twice the binomial tail: of 20, at most 5: 1 + 20 + 190 + 1140 + 4845 + 15504 = 21700.
TEST(Statistics, McNemarsTestIsTheBinomialTail) {
  EXPECT_NEAR(mcnemar(5, 15), 2 * 21700.0 / 1048576, 1e-12);
  EXPECT_NEAR(mcnemar(0, 6), 2.0 / 64, 1e-12);
  EXPECT_NEAR(mcnemar(6, 0), 2.0 / 64, 1e-12);
  EXPECT_EQ(mcnemar(0, 0), 1);
  EXPECT_EQ(mcnemar(4, 4), 1);
}

// Hollander and Wolfe, Nonparametric Statistical Methods, 1973, p. 29: the depression scale factor of nine patients before and after therapy: V = 40, one-sided
// 0.01953 (10 of 512).
// Fisher's tea: of 4 cups all 4 right by chance in 1 of 70, 3 or more in 17 of 70. A sign test: 5 of 5 in 1 of 32, 4 or more in 6.
TEST(Statistics, ARiseIsTheUpperTail) {
  EXPECT_NEAR(fisher_rise(0, 4, 4, 4), 1.0 / 70, 1e-12);
  EXPECT_NEAR(fisher_rise(1, 4, 3, 4), 17.0 / 70, 1e-12);
  EXPECT_NEAR(fisher_rise(4, 4, 0, 4), 1, 1e-12);
  EXPECT_NEAR(fisher_rise(0, 10, 0, 20), 1, 1e-12);
  EXPECT_NEAR(mcnemar_rise(0, 5), 1.0 / 32, 1e-12);
  EXPECT_NEAR(mcnemar_rise(1, 4), 6.0 / 32, 1e-12);
  EXPECT_NEAR(mcnemar_rise(5, 0), 1, 1e-12);
  EXPECT_NEAR(mcnemar_rise(0, 0), 1, 1e-12);
}

TEST(Statistics, TheSignedRankTestIsThePublishedOne) {
  const std::vector<double> before{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30},
      after{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  EXPECT_NEAR(wilcoxon(before, after), 2 * 10.0 / 512, 1e-12);
  EXPECT_NEAR(wilcoxon(after, before), 2 * 10.0 / 512, 1e-12);
}

// The tables' critical values: W = 8 of 10 pairs is 0.0488 two-sided (25 of 1024 on a side), W = 9 is 0.0645 (33 of 1024).
TEST(Statistics, TheSignedRankTestHasTheTablesCriticalValues) {
  std::vector<double> before(10, 0.0), after(10);
  std::iota(after.begin(), after.end(), 1.0);
  after[7] = -8;
  EXPECT_NEAR(wilcoxon(before, after), 2 * 25.0 / 1024, 1e-12);
  after[0] = -1;
  EXPECT_NEAR(wilcoxon(before, after), 2 * 33.0 / 1024, 1e-12);
}

// Of ties all ranks are equal: the sign test.
TEST(Statistics, TheSignedRankTestOfEqualDifferencesIsTheSignTest) {
  std::vector<double> before(20, 1.0), after(20, 2.0);
  for (std::size_t i = 0; i < 5; ++i) after[i] = 0;
  EXPECT_NEAR(wilcoxon(before, after), mcnemar(5, 15), 1e-12);
  EXPECT_EQ(wilcoxon(before, before), 1);
  after.assign(20, 1.0 + 1e-12);  // rounding is no difference
  EXPECT_EQ(wilcoxon(before, after), 1);
}

// Counted in whole numbers over all 2^320 signs: W = 29349 of 51360 has a p of 0.026636186670033077.
TEST(Statistics, BeyondItsExactPartTheSignedRankTestIsNearTheCountedOne) {
  constexpr std::size_t n = 320;
  std::vector<double> before(n, 0.0), after(n);
  for (std::size_t i = 0; i < n; ++i) after[i] = (i % 7 < 3 ? -1.0 : 1.0) * static_cast<double>(i + 1);
  EXPECT_NEAR(wilcoxon(before, after) / 0.026636186670033077, 1, 0.02);
}

// Of two values the p95 is the larger. {1, 2} against {3, 4}, and its mirror, are 2 apart; {3, 2} against {1, 4}, and its mirror, 1.
TEST(Statistics, TheSwapTestCountsTheSwaps) {
  const std::vector<double> before{1, 2}, after{3, 4};
  EXPECT_EQ(swap_test(before, after, 0.95), 0.5);
  const std::vector<double> same{1, 2};
  EXPECT_EQ(swap_test(before, same, 0.95), 1);
  // A shift of all of n values beyond the largest: only the two swaps of none and of all move the smallest and the median as far.
  std::vector<double> low(8), high(8);
  std::iota(low.begin(), low.end(), 1.0);
  std::iota(high.begin(), high.end(), 101.0);
  EXPECT_EQ(swap_test(low, high, 0.01), 2.0 / 256);
}

// One pair among 30 that do not differ: it is swapped or not, which is the same. Many pairs are drawn, with the same result every time.
TEST(Statistics, TheSwapTestOfManyPairsIsDrawnAndRepeats) {
  std::vector<double> before(30), after(30);
  std::iota(before.begin(), before.end(), 1.0);
  after = before;
  after[29] = 99;
  EXPECT_EQ(swap_test(before, after, 1.0), 1);
  for (double& value : after) value += 500;
  const double p = swap_test(before, after, 0.05);  // 19,999 of 2^30 swaps: none is as far
  EXPECT_EQ(p, 1.0 / 20'000);
  EXPECT_EQ(swap_test(before, after, 0.5), swap_test(before, after, 0.5));
}

// 0.005 x 4, 0.01 x 3, then 0.03 x 2, below which the last one must not fall.
TEST(Statistics, HolmsCorrectionIsTheClosedForm) {
  const std::vector<double> adjusted = holm({0.01, 0.04, 0.03, 0.005});
  EXPECT_NEAR(adjusted[0], 0.03, 1e-12);
  EXPECT_NEAR(adjusted[1], 0.06, 1e-12);
  EXPECT_NEAR(adjusted[2], 0.06, 1e-12);
  EXPECT_NEAR(adjusted[3], 0.02, 1e-12);
  EXPECT_EQ(holm({0.7, 0.9}), (std::vector<double>{1, 1}));
  EXPECT_TRUE(holm({}).empty());
}

TEST(Statistics, APercentileIsAValueThatWasMeasured) {
  std::vector<double> values{5, 1, 4, 2, 3}, none;
  EXPECT_EQ(nearest_rank(values, 0.5), 3);
  EXPECT_EQ(nearest_rank(values, 0.95), 5);
  EXPECT_EQ(nearest_rank(values, 0.0), 1);
  EXPECT_TRUE(std::isnan(nearest_rank(none, 0.5)));
}

}  // namespace
}  // namespace lf::campaign
