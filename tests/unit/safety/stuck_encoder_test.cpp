// A position that stands still while its set-point goes on.
#include "firmware/safety/stuck_encoder.hpp"

#include <gtest/gtest.h>

namespace lf::safety {
namespace {

struct Joint {
  StuckEncoder encoder;
  StuckEncoder::Sample now{Time(), 0, 0, 1.3e-4, 0, true};

  // Seconds until it is found stuck while the set-point goes at `counts_s` and the position follows at `share` of it; 5 when it is not.
  double run(double counts_s, double share, double torque_nm_s = 0) {
    const Time began = now.t;
    const std::int32_t from = now.actual_counts;
    while (now.t - began < Duration::from_s(5)) {
      now.t = now.t + Duration::from_ms(4);
      const double s = (now.t - began).s();
      now.target_counts = from + static_cast<std::int32_t>(counts_s * s);
      now.actual_counts = from + static_cast<std::int32_t>(share * counts_s * s);
      now.torque_nm = torque_nm_s * s;
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
  EXPECT_EQ(Joint().run(1000, 0, 20), 5) << "its load rises";
  Joint off;
  off.now.follows = false;
  EXPECT_EQ(off.run(1000, 0), 5);
  Joint coarse;
  coarse.now.rad_per_count = 3.1e-3;
  EXPECT_NEAR(coarse.run(10, 0), 0.8, 0.02) << "one count of a coarse encoder is more than the way";
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
