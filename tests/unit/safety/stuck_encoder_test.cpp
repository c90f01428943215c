// A position that stands still while its set-point goes on.
#include "firmware/safety/stuck_encoder.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace lf::safety {
namespace {

constexpr double end_nm = 13;  // of a joint's torque, as the watch has it by default

struct Joint {
  StuckEncoder encoder;
  StuckEncoder::Sample now{Time(), 0, 0, 1.3e-4, 0, true};

  // From now on with `torque_nm_s`. Seconds until it is found stuck while the set-point goes at `counts_s` and the position follows at `share` of it; 5 when it is not.
  double run(double counts_s, double share, double torque_nm_s = 0) {
    const double from_nm = now.torque_nm;
    const Time began = now.t;
    const std::int32_t from = now.actual_counts;
    while (now.t - began < Duration::from_s(5)) {
      now.t = now.t + Duration::from_ms(4);
      const double s = (now.t - began).s();
      now.target_counts = from + static_cast<std::int32_t>(counts_s * s);
      now.actual_counts = from + static_cast<std::int32_t>(share * counts_s * s);
      now.torque_nm = from_nm + torque_nm_s * s;
      now.follows = now.follows && now.torque_nm < end_nm;
      if (encoder.update(now)) return s;
    }
    return 5;
  }
};

TEST(StuckEncoder, IsToldOnceTheSetPointHasGoneOnWithoutIt) {
  for (const double way : {-1.0, 1.0}) {
    EXPECT_NEAR(Joint().run(way * 1000, 0), 0.304, 0.01) << "fast: after the time";
    EXPECT_NEAR(Joint().run(way * 40, 0), 3e-3 / 1.3e-4 / 40, 0.03) << "slow: after the way";
  }
}

TEST(StuckEncoder, IsNoJointThatFollowsOrStandsOrIsHeld) {
  EXPECT_EQ(Joint().run(1000, 0.99), 5);
  EXPECT_EQ(Joint().run(40, 0.5), 5) << "it lags, and moves";
  EXPECT_EQ(Joint().run(0, 0), 5);
  EXPECT_EQ(Joint().run(100, 0, 20), 5) << "its load rises to the end of its torque: it is 3.1 mrad behind with 4.8 N m, 8.5 with 13";
  Joint off;
  off.now.follows = false;
  EXPECT_EQ(off.run(1000, 0), 5);
  Joint coarse;
  coarse.now.rad_per_count = 3.1e-3;
  EXPECT_NEAR(coarse.run(10, 0), 0.8, 0.02) << "one count of a coarse encoder is more than the way";
}

// A drive winds its motor up while something holds the joint back. One that stays behind, short of the end of its torque, goes on unseen: at the gain of its position loop
// times the lag. The simulator's gain is 20 a second; 50 stands for stiffer drives.
TEST(StuckEncoder, IsNotHeldForGoodByALoadShortOfTheEndOfItsTorque) {
  for (const double counts_s : {20.0, 40.0, 100.0, 300.0, 1000.0})
    for (const auto& [before_nm, since_nm] : {std::pair{-12.7, -0.5}, {0.8, 5.8}, {-8.0, 8.0}}) {
      Joint joint;
      joint.now.torque_nm = before_nm;  // when it showed its last count
      (void)joint.encoder.update(joint.now);
      joint.now.torque_nm = since_nm;
      const double told_s = joint.run(counts_s, 0);
      EXPECT_LT(told_s, 5) << counts_s << " counts a second";
      EXPECT_LT(50 * counts_s * 1.3e-4 * told_s * told_s / 2, 0.5) << "rad, at " << counts_s << " counts a second";
    }
}

// Seconds until a joint that bore a load when it showed its last count, and no longer does, is found stuck with its target `counts` off.
double told_with_a_target_off_by(Joint& joint, std::int32_t counts) {
  const Time began = joint.now.t;
  joint.now.torque_nm = -12.7;
  ++joint.now.actual_counts;
  (void)joint.encoder.update(joint.now);
  joint.now.torque_nm = -0.5;
  joint.now.target_counts += counts;
  while (joint.now.t - began < Duration::from_s(5)) {
    joint.now.t = joint.now.t + Duration::from_ms(4);
    if (joint.encoder.update(joint.now)) break;
  }
  return (joint.now.t - began).s();
}

TEST(StuckEncoder, IsHeldForLessTheFartherItIsBehind) {
  for (const std::int32_t way : {-1, 1}) {
    Joint joint;
    EXPECT_NEAR(told_with_a_target_off_by(joint, way * 24), 0.003 / (24 * 1.3e-4), 0.005);
    EXPECT_NEAR(told_with_a_target_off_by(joint, way * 24), 0.003 / (24 * 1.3e-4), 0.005) << "after another count it begins anew";
    EXPECT_NEAR(told_with_a_target_off_by(joint, way * 60), 0.003 / (60 * 1.3e-4), 0.005);
    EXPECT_NEAR(told_with_a_target_off_by(joint, way * 200), 0.3, 0.005) << "never sooner than without a load";
  }
}

// A load that rises faster than any contact's threshold is no proof of one while the position shows nothing.
TEST(StuckEncoder, ShowsNothingATenthOfASecondAfterItsLastCount) {
  const auto shows_nothing = [](double share, double s) {
    Joint joint;
    while (joint.now.t < Time() + Duration::from_s(s)) {
      joint.now.t = joint.now.t + Duration::from_ms(4);
      joint.now.target_counts = static_cast<std::int32_t>(1000 * joint.now.t.s());
      joint.now.actual_counts = static_cast<std::int32_t>(share * 1000 * joint.now.t.s());
      joint.now.torque_nm = 100 * joint.now.t.s();
      EXPECT_FALSE(joint.encoder.update(joint.now)) << "its load rises";
    }
    return joint.encoder.shows_nothing();
  };
  EXPECT_FALSE(shows_nothing(0, 0.096));
  EXPECT_TRUE(shows_nothing(0, 0.112));
  EXPECT_FALSE(shows_nothing(0.1, 0.112)) << "pressed against something it creeps";
}

}  // namespace
}  // namespace lf::safety
