// Eight lanes against the standard library, one by one.
#include "shared/lanes/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf {
namespace {

// The largest error of `ours` against `exact`, over `exact`'s size, from `low` to `high` in steps of the lanes' width.
template <class Ours, class Exact>
double largest_relative_error(double low, double high, double step, Ours ours, Exact exact) {
  double largest = 0;
  for (double x = low; x < high; x += lane_count * step) {
    Lanes at{};
    for (int i = 0; i < lane_count; ++i) at[i] = static_cast<float>(x + i * step);
    const Lanes got = ours(at);
    for (int i = 0; i < lane_count; ++i) {
      const double wanted = exact(static_cast<double>(at[i]));
      largest = std::max(largest, std::abs(got[i] - wanted) / std::max(std::abs(wanted), 1e-30));
    }
  }
  return largest;
}

TEST(Lanes, ExpIsTheLibrarys) {
  EXPECT_LT(largest_relative_error(
                -86.5, 86.5, 0.0137, [](Lanes x) { return exp(x); }, [](double x) { return std::exp(x); }),
            3e-7);
}

TEST(Lanes, LogIsTheLibrarys) {
  const auto ours = [](Lanes x) { return log(x); };
  const auto exact = [](double x) { return std::log(x); };
  EXPECT_LT(largest_relative_error(1e-3, 0.99, 1.7e-5, ours, exact), 3e-7);
  EXPECT_LT(largest_relative_error(1.01, 70000, 0.37, ours, exact), 3e-7);
  // Where the logarithm goes through 0 its error stays that of a float near 1.
  for (double x = 0.99; x < 1.01; x += 1e-5) EXPECT_NEAR(log(all_lanes(static_cast<float>(x)))[0], std::log(static_cast<float>(x)), 1e-7);
  EXPECT_NEAR(log(all_lanes(std::numeric_limits<float>::min()))[7], std::log(std::numeric_limits<float>::min()), 1e-4);
}

TEST(Lanes, NormalCdfIsTheErrorFunctions) {
  for (double x = -6; x < 6; x += 0.013)
    EXPECT_NEAR(normal_cdf(all_lanes(static_cast<float>(x)))[3], 0.5 * std::erfc(-x / std::sqrt(2.0)), 2e-7);
}

TEST(Lanes, EachLaneIsItsOwn) {
  Lanes x{}, y{};
  for (int i = 0; i < lane_count; ++i) x[i] = static_cast<float>(i) - 3.5f, y[i] = 0.5f;
  const Lanes larger = max(x, y), smaller = min(x, y), held = clamp(x, -1, 1), size = abs(x), chosen = select(x < y, x, y);
  for (int i = 0; i < lane_count; ++i) {
    EXPECT_EQ(larger[i], std::max(x[i], y[i]));
    EXPECT_EQ(smaller[i], std::min(x[i], y[i]));
    EXPECT_EQ(held[i], std::clamp(x[i], -1.0f, 1.0f));
    EXPECT_EQ(size[i], std::abs(x[i]));
    EXPECT_EQ(chosen[i], std::min(x[i], y[i]));
  }
}

}  // namespace
}  // namespace lf
