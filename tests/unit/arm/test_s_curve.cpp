#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "firmware/arm/s_curve.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20133;

double log_uniform(std::mt19937_64& engine, double low, double high) {
  return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(engine));
}

TEST(SCurve, KeepsItsBoundsAndArrivesExactlyForAnyDistance) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 engine(seed);
  for (int k = 0; k < 3'000; ++k) {
    const double distance = log_uniform(engine, 1e-6, 10), v = log_uniform(engine, 1e-2, 10), a = log_uniform(engine, 1e-2, 10),
                 j = log_uniform(engine, 1e-2, 100);
    SCurve curve;
    ASSERT_TRUE(curve.plan(distance, v, a, j));
    constexpr int n = 200;
    PathState last = curve.sample(0);
    ASSERT_EQ(last.position, 0);
    ASSERT_EQ(last.velocity, 0);
    for (int i = 1; i <= n; ++i) {
      const double dt = curve.duration_s() / n;
      const PathState s = curve.sample(i == n ? curve.duration_s() : i * dt);
      ASSERT_LE(s.velocity, v * (1 + 1e-9));
      ASSERT_GE(s.velocity, -1e-9 * v);
      ASSERT_LE(std::abs(s.acceleration), a * (1 + 1e-9));
      ASSERT_LE(std::abs(s.acceleration - last.acceleration), j * dt * (1 + 1e-6) + 1e-12 * a);
      // Continuous: what the bounds let it change in between.
      ASSERT_LE(std::abs(s.velocity - last.velocity), a * dt * (1 + 1e-6) + 1e-12 * v);
      ASSERT_LE(std::abs(s.position - last.position), v * dt * (1 + 1e-6) + 1e-12 * distance);
      last = s;
    }
    ASSERT_EQ(last.position, distance);
    ASSERT_EQ(last.velocity, 0);
    const PathState before = curve.sample(curve.duration_s() * (1 - 1e-9));
    ASSERT_NEAR(before.position, distance, 1e-9 * distance);
  }
}

// One bound always holds the motion back: with cruise the speed, else the acceleration, else the jerk all the way.
TEST(SCurve, IsNoSlowerThanItsBoundsRequire) {
  SCurve cruise;
  ASSERT_TRUE(cruise.plan(10, 1, 2, 4));
  EXPECT_NEAR(cruise.duration_s(), 10 / 1.0 + 1 / 2.0 + 2 / 4.0, 1e-12);  // d/v + v/a + a/j
  EXPECT_NEAR(cruise.peak_velocity(), 1, 1e-12);
  SCurve accelerating;
  ASSERT_TRUE(accelerating.plan(3, 10, 2, 4));  // ramps of T: a (T - a/j) T = d
  EXPECT_NEAR(accelerating.duration_s(), 2 * (0.5 + std::sqrt(0.25 + 4 * 3 / 2.0)) / 2, 1e-12);
  SCurve jerking;
  ASSERT_TRUE(jerking.plan(0.001, 10, 2, 4));
  EXPECT_NEAR(jerking.duration_s(), 4 * std::cbrt(0.001 / (2 * 4)), 1e-12);
}

TEST(SCurve, VelocityIsTheDerivativeOfThePosition) {
  SCurve curve;
  ASSERT_TRUE(curve.plan(0.7, 0.3, 0.8, 8));
  constexpr double h = 1e-5;
  for (double t = 0.01; t < curve.duration_s(); t += 0.013) {
    const PathState below = curve.sample(t - h), here = curve.sample(t), above = curve.sample(t + h);
    ASSERT_NEAR((above.position - below.position) / (2 * h), here.velocity, 1e-8);
    ASSERT_NEAR((above.velocity - below.velocity) / (2 * h), here.acceleration, 1e-4);
  }
}

TEST(SCurve, RefusesImpossibleBoundsAndTakesNoTimeForNoDistance) {
  SCurve curve;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(curve.plan(-1, 1, 1, 1));
  EXPECT_FALSE(curve.plan(1, 0, 1, 1));
  EXPECT_FALSE(curve.plan(1, 1, -1, 1));
  EXPECT_FALSE(curve.plan(1, 1, 1, nan));
  EXPECT_FALSE(curve.plan(nan, 1, 1, 1));
  EXPECT_EQ(curve.duration_s(), 0);
  EXPECT_TRUE(curve.plan(0, 1, 1, 1));
  EXPECT_EQ(curve.duration_s(), 0);
  EXPECT_EQ(curve.sample(nan).position, 0);
}

TEST(StopCurve, ComesToRestWithinItsBoundsFromAnySpeedAndAcceleration) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> signed_unit(-1, 1);
  for (int k = 0; k < 3'000; ++k) {
    const double a = log_uniform(engine, 0.1, 10), j = log_uniform(engine, 0.1, 100);
    const PathState from{signed_unit(engine), signed_unit(engine), a * signed_unit(engine)};
    const StopCurve stop(from, a, j);
    constexpr int n = 300;
    const double dt = stop.duration_s() / n;
    PathState last = stop.sample(0);
    ASSERT_EQ(last.position, from.position);
    ASSERT_EQ(last.velocity, from.velocity);
    for (int i = 1; i <= n; ++i) {
      const PathState s = stop.sample(i * dt);
      ASSERT_LE(std::abs(s.acceleration), a * (1 + 1e-9));
      ASSERT_LE(std::abs(s.acceleration - last.acceleration), j * dt * (1 + 1e-6) + 1e-12);
      ASSERT_LE(std::abs(s.velocity - last.velocity), a * dt * (1 + 1e-6) + 1e-12);
      last = s;
    }
    const PathState before = stop.sample(stop.duration_s() * (1 - 1e-9));
    ASSERT_NEAR(before.velocity, 0, 2e-9 * a * stop.duration_s() + 1e-12);
    ASSERT_NEAR(before.acceleration, 0, 2e-9 * j * stop.duration_s() + 1e-12);
    ASSERT_NEAR(stop.sample(1e9).position, last.position, 1e-12 * std::max(1.0, std::abs(last.position)));
    ASSERT_EQ(stop.sample(1e9).velocity, 0);
    // No stop is shorter than full braking without a jerk limit; this one is longer by the ramps of its acceleration at most.
    ASSERT_GE(stop.duration_s() * (1 + 1e-9), std::abs(from.velocity) / a - std::abs(from.acceleration) / j);
    ASSERT_LE(stop.duration_s(), std::abs(from.velocity) / a + 4 * a / j + 1e-9);
  }
}

TEST(StopCurve, TakesVOverAPlusAOverJFromCruise) {
  const StopCurve stop({0, 1, 0}, 2, 4);
  EXPECT_NEAR(stop.duration_s(), 1 / 2.0 + 2 / 4.0, 1e-12);
  EXPECT_NEAR(stop.sample(1).position, 1 * stop.duration_s() / 2, 1e-12);  // mean speed is half, by symmetry
}

}  // namespace
}  // namespace lf::arm
