// How far a joint goes unseen, and from when on its torque proves no contact.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "firmware/safety/stuck_encoder.hpp"
#include "tests/unit/safety/following_joint.hpp"

namespace lf::safety {
namespace {

using namespace test;

// A drive with a position loop of 20 a second and another encoder for its speed, by hand: what docs/safety.md says of the way that nobody sees.
struct Unseen {
  double told_s = never, blind_s = never, gone_rad = 0;
};

// Its reading stops while it follows a target at `rad_s`; of a target that stands, `off_rad` before it.
Unseen reading_stops(double rad_s, double off_rad, double torque_nm) {
  constexpr double gain_per_s = 20, top_rad_s = 0.36, dt_s = 4e-3;
  FollowingJoint joint;
  double at_rad = rad_s > 0 ? -rad_s / gain_per_s : 0, target_rad = 0;
  (void)joint.run(
      [&](StuckEncoder::Sample& sample, double) {
        target_rad += rad_s * dt_s;
        at_rad += rad_s * dt_s;
        sample.target_counts = static_cast<std::int32_t>(std::lround(target_rad / rad_per_count));
        sample.actual_counts = static_cast<std::int32_t>(std::lround(at_rad / rad_per_count));
      },
      2);
  const double stopped_rad = at_rad;
  if (rad_s == 0) target_rad = off_rad;
  Unseen unseen;
  unseen.told_s = joint.run([&](StuckEncoder::Sample& sample, double s) {
    if (unseen.blind_s == never && joint.encoder.shows_nothing()) unseen.blind_s = s - dt_s;
    target_rad += rad_s * dt_s;
    at_rad += std::min(top_rad_s, gain_per_s * (target_rad - stopped_rad)) * dt_s;
    sample.target_counts = static_cast<std::int32_t>(std::lround(target_rad / rad_per_count));
    sample.torque_nm = torque_nm;
  });
  unseen.gone_rad = at_rad - stopped_rad;
  return unseen;
}

TEST(StuckEncoder, IsToldBeforeItHasGoneSoFar) {
  for (const double off_rad : {1.2e-3, 3e-3, 5e-3}) {
    EXPECT_LT(reading_stops(0, off_rad, 0).gone_rad, 0.035) << off_rad;
    EXPECT_LT(reading_stops(0, off_rad, 8).gone_rad, 0.07) << off_rad;
  }
  const std::pair<double, double> gone[] = {{0.02, 0.05}, {0.05, 0.12}, {0.36, 0.24}};
  for (const auto& [rad_s, gone_rad] : gone) EXPECT_NEAR(reading_stops(rad_s, 0, 0).gone_rad, gone_rad, 0.01) << rad_s;
  for (const double rad_s : {0.02, 0.1, 0.36}) {
    const Unseen pushes = reading_stops(rad_s, 0, 14);
    EXPECT_LT(pushes.told_s, 1.2) << rad_s;
    EXPECT_LT(pushes.gone_rad, 0.43) << rad_s;
  }
}

TEST(StuckEncoder, ShowsNothingThoughItWavers) {
  for (const std::int32_t by : {0, 2, 4, 6}) {
    FollowingJoint joint;
    int blind = 0;
    EXPECT_LT(joint.run(
                  [&](StuckEncoder::Sample& sample, double s) {
                    sample.target_counts = 40;
                    sample.actual_counts = waver(s, by);
                    sample.torque_nm = 14;
                    if (s > 0.3 && joint.encoder.shows_nothing()) ++blind;
                  },
                  1.3),
              1.3);
    EXPECT_GT(blind, 0.75 * 0.7 / 4e-3) << "of the samples from 0.3 s on, by " << by;
  }
}

// What carries it off, from where it stood or after it has come nearer, is seen.
TEST(StuckEncoder, ShowsThatItIsPushedAway) {
  for (const double comes_s : {0.0, 0.3}) {
    FollowingJoint joint;
    EXPECT_EQ(joint.run(
                  [&](StuckEncoder::Sample& sample, double s) {
                    sample.target_counts = 200;
                    sample.actual_counts =
                        static_cast<std::int32_t>(std::lround(s < comes_s ? 300 * s : 300 * comes_s - 150 * (s - comes_s)));
                    if (s > comes_s + 0.15) {
                      EXPECT_FALSE(joint.encoder.shows_nothing()) << s;
                    }
                  },
                  comes_s + 0.25),
              never);
  }
}

// The mean of its readings goes on for a while when they have stopped in motion. That is no sign of life.
TEST(StuckEncoder, ShowsNothingATenthOfASecondAfterItStoppedInMotion) {
  for (const double rad_s : {0.05, 0.1, 0.2, 0.36}) EXPECT_NEAR(reading_stops(rad_s, 0, 0).blind_s, 0.1, 0.013) << rad_s;
}

// A load that rises faster than any contact's threshold is no proof of one while the position shows nothing.
TEST(StuckEncoder, ShowsNothingATenthOfASecondAfterItsLastSign) {
  const auto shows_nothing = [](double share, double s) {
    FollowingJoint joint;
    EXPECT_EQ(joint.go(1000, share, 100, s), never) << "its load rises";
    return joint.encoder.shows_nothing();
  };
  EXPECT_FALSE(shows_nothing(0, 0.1));
  EXPECT_TRUE(shows_nothing(0, 0.12));
  EXPECT_FALSE(shows_nothing(0.1, 0.12)) << "pressed against something it creeps";
}

// A roll that froze a count beside its target turns on by it, unseen, until its stop loads it.
TEST(StuckEncoder, ShowsNothingOneCountOffWhereThatIsFar) {
  const auto shows_nothing = [](double count_rad, std::int32_t counts, double s) {
    FollowingJoint joint;
    joint.now.rad_per_count = count_rad;
    joint.stand(1);
    EXPECT_EQ(joint.left_at(counts, 0, s), never);
    return joint.encoder.shows_nothing();
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(shows_nothing(sign * 3.07e-3, 1, 0.12));
    EXPECT_FALSE(shows_nothing(sign * 3.07e-3, 1, 0.08));
    EXPECT_FALSE(shows_nothing(sign * 3.07e-3, 0, 0.3));
    EXPECT_FALSE(shows_nothing(sign * rad_per_count, 2, 0.3)) << "a screw's loop holds within two";
    EXPECT_FALSE(shows_nothing(sign * rad_per_count, 15, 0.3)) << "2 mrad";
  }
  FollowingJoint turns;
  turns.now.rad_per_count = 3.07e-3;
  EXPECT_EQ(turns.run(
                [](StuckEncoder::Sample& sample, double s) {
                  sample.target_counts = 2 + static_cast<std::int32_t>(12 * s);
                  sample.actual_counts = static_cast<std::int32_t>(12 * s);
                },
                0.58),
            never);
  EXPECT_FALSE(turns.encoder.shows_nothing()) << "a count every 83 ms";
  FollowingJoint joint;
  joint.now.actual_counts = joint.now.target_counts = 1000;
  EXPECT_EQ(joint.left_at(15, 0, 0.3), never);
  EXPECT_EQ(joint.left_at(24, 0, 0.012), never);
  EXPECT_TRUE(joint.encoder.shows_nothing()) << "behind for long, and now far";
  EXPECT_EQ(joint.left_at(-24, 0, 0.05), never);
  EXPECT_FALSE(joint.encoder.shows_nothing()) << "on its other side";
}

}  // namespace
}  // namespace lf::safety
