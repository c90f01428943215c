#include "firmware/scan/late_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lf::scan {
namespace {

// However few there are yet: a mean that begins at 0 told a fifth of a doubt after the first 500 of 2000 points.
TEST(LateMean, OfOneValueIsTheValue) {
  LateMean late(2000);
  EXPECT_EQ(late.mean(), 0);
  for (int picture = 0; picture < 5; ++picture) {
    late.add(0.3, 100);
    EXPECT_NEAR(late.mean(), 0.3, 1e-15);
  }
}

// Of 2000 points the last 500 have the value 1, each point by itself: their weights are a geometric series.
TEST(LateMean, FollowsAValueThatRisesLate) {
  LateMean late(2000);
  for (int point = 0; point < 2000; ++point) late.add(point < 1500 ? 0 : 1, 1);
  const double kept = 2000.0 / 2001;
  const double expected = (1 - std::pow(kept, 500)) / (1 - std::pow(kept, 2000));
  EXPECT_NEAR(late.mean(), expected, 1e-12);
  EXPECT_GT(late.mean(), 0.34);
}

TEST(LateMean, ForgetsWhatIsLongPast) {
  LateMean late(2000);
  late.add(5, 20'000);
  for (int picture = 0; picture < 100; ++picture) late.add(1, 200);
  EXPECT_NEAR(late.mean(), 1, 1e-3);
}

}  // namespace
}  // namespace lf::scan
