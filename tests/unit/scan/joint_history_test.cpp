#include "firmware/scan/joint_history.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lf::scan {
namespace {

using Outcome = JointHistory::Outcome;
using Angles = PerArmJoint<double>;

constexpr Duration period = can_map::sync_period;
Time sync(int i) { return Time::from_ns(1'000'000'000) + period * i; }

template <class Motion>
JointHistory recorded(int count, Motion motion) {
  JointHistory history;
  for (int i = 0; i < count; ++i) {
    const double t = (sync(i) - sync(0)).s();
    EXPECT_TRUE(history.add({sync(i), motion(t)}));
  }
  return history;
}

TEST(Joints, OfAParabolaAreExactBetweenSyncs) {
  const auto motion = [](double t) { return Angles{0.1, 0.9 + 0.05 * t, 2 - 0.065 * t, 0.3 * t * t}; };
  const JointHistory history = recorded(100, motion);
  Angles q{};
  for (double at : {0.1, 0.2003, 0.2517, 0.31}) {
    ASSERT_EQ(history.at(sync(0) + Duration::from_s(at), false, q), Outcome::done);
    for (std::size_t j = 0; j < q.size(); ++j) EXPECT_NEAR(q[j], motion(at)[j], 1e-12);
  }
}

// The elbow's encoder ticks are 0.37 mrad: a straight line between two samples errs by a third of that, the window by a quarter of the line.
TEST(Joints, AreFinerThanTheEncodersTicks) {
  constexpr double tick = 0.37e-3;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  double squares = 0, line_squares = 0;
  const int trials = 300;
  for (int trial = 0; trial < trials; ++trial) {
    const double start = unit(random);
    const auto truth = [&](double t) { return start - 0.065 * t; };
    const auto ticked = [&](double t) { return Angles{0, 0, tick * std::round(truth(t) / tick), 0}; };
    const JointHistory history = recorded(60, ticked);
    const double at = 0.1 + 0.02 * unit(random);
    Angles q{};
    ASSERT_EQ(history.at(sync(0) + Duration::from_s(at), false, q), Outcome::done);
    squares += std::pow(q[2] - truth(at), 2);
    const int before = static_cast<int>(at / period.s());
    const double f = at / period.s() - before;
    const double line = (1 - f) * ticked(before * period.s())[2] + f * ticked((before + 1) * period.s())[2];
    line_squares += std::pow(line - truth(at), 2);
  }
  EXPECT_LT(std::sqrt(squares / trials), 0.4 * std::sqrt(line_squares / trials)) << "seed 4";
  EXPECT_LT(std::sqrt(squares / trials), 0.03e-3);
}

TEST(Joints, WaitForTheSamplesAfterTheInstantUnlessNoneWillCome) {
  JointHistory history = recorded(20, [](double t) { return Angles{t, 2 * t, -t, 0}; });
  Angles q{};
  EXPECT_EQ(history.at(sync(15), false, q), Outcome::wait);
  EXPECT_EQ(history.at(sync(15), true, q), Outcome::done);
  EXPECT_NEAR(q[0], 15 * period.s(), 1e-12);
  EXPECT_EQ(history.at(sync(11), false, q), Outcome::done);
  EXPECT_EQ(history.at(sync(25), false, q), Outcome::wait);
  EXPECT_EQ(history.at(sync(25), true, q), Outcome::gap);
  EXPECT_EQ(JointHistory().at(sync(0), false, q), Outcome::wait);
  EXPECT_EQ(JointHistory().at(sync(0), true, q), Outcome::gap);
}

TEST(Joints, AreNotGuessedAcrossMoreThanThreeSyncs) {
  const auto with_gap = [](int missing) {
    JointHistory history;
    for (int i = 0; i < 60; ++i) {
      if (i > 30 && i <= 30 + missing) continue;
      EXPECT_TRUE(history.add({sync(i), {0.01 * i, 0, 0, 0}}));
    }
    return history;
  };
  Angles q{};
  EXPECT_EQ(with_gap(2).at(sync(30) + period / 2, false, q), Outcome::done);
  EXPECT_NEAR(q[0], 0.305, 1e-9);
  EXPECT_EQ(with_gap(3).at(sync(30) + period / 2, false, q), Outcome::gap);
  EXPECT_EQ(with_gap(3).at(sync(29), false, q), Outcome::done) << "on this side of the gap";
  EXPECT_NEAR(q[0], 0.29, 1e-9);
}

TEST(Joints, OlderThanTheHistoryAreRefused) {
  const JointHistory history = recorded(300, [](double t) { return Angles{t, 0, 0, 0}; });
  Angles q{};
  EXPECT_EQ(history.at(sync(100), false, q), Outcome::too_old);
  EXPECT_EQ(history.at(sync(200), false, q), Outcome::done);
  EXPECT_NEAR(q[0], 200 * period.s(), 1e-9);
}

TEST(Joints, ThatAreNoNumbersOrGoBackInTimeAreRefused) {
  JointHistory history;
  EXPECT_TRUE(history.add({sync(1), {}}));
  EXPECT_FALSE(history.add({sync(1), {}}));
  EXPECT_FALSE(history.add({sync(0), {}}));
  EXPECT_FALSE(history.add({sync(2), {0, std::numeric_limits<double>::quiet_NaN(), 0, 0}}));
  EXPECT_FALSE(history.add({sync(2), {std::numeric_limits<double>::infinity(), 0, 0, 0}}));
  EXPECT_TRUE(history.add({sync(2), {}}));
}

}  // namespace
}  // namespace lf::scan
