// A position that stands still while its target does not.
#include "firmware/safety/stuck_encoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "shared/geometry/pose.hpp"
#include "tests/unit/safety/following_joint.hpp"

namespace lf::safety {
namespace {

using namespace test;

// When the lag's sum is reached by a target that goes on at `rad_s`, from behind_rad on.
double sum_reached_s(double rad_s, double rad_s_sum) {
  const double from_s = StuckEncoder::behind_rad / rad_s;
  return std::sqrt(from_s * from_s + 2 * rad_s_sum / rad_s);
}

TEST(StuckEncoder, IsToldOnceTheTargetHasGoneOnWithoutIt) {
  for (const double way : {-1.0, 1.0}) {
    EXPECT_NEAR(FollowingJoint().go(way * 1000, 0), 0.3 + 8.0 / 1000, 0.009) << "fast: after the time";
    EXPECT_NEAR(FollowingJoint().go(way * 40, 0), sum_reached_s(40 * rad_per_count, 1.5e-3), 0.02) << "slow: after the sum";
    EXPECT_NEAR(FollowingJoint().go(way * 5, 0), sum_reached_s(5 * rad_per_count, 1.5e-3), 0.1) << "very slow";
  }
}

TEST(StuckEncoder, IsNoJointThatFollowsOrStands) {
  EXPECT_EQ(FollowingJoint().go(1000, 0.99), never);
  EXPECT_EQ(FollowingJoint().go(40, 0.5), never) << "it lags, and moves";
  EXPECT_EQ(FollowingJoint().go(0, 0), never);
  EXPECT_EQ(FollowingJoint().left_at(7, 0), never) << "a loop without an integrator";
  FollowingJoint off;
  off.now.follows = false;
  EXPECT_EQ(off.go(1000, 0), never);
  FollowingJoint coarse;
  coarse.now.rad_per_count = 3.1e-3;
  EXPECT_EQ(coarse.left_at(2, 0), never) << "one count of a coarse encoder is more than the way";
  FollowingJoint fine;
  fine.now.rad_per_count = 1e-6;
  EXPECT_EQ(fine.left_at(900, 0), never) << "many counts of a fine one are less";
}

// It lags at its speed over its gain, as a drive without feed-forward does, and shows its way.
TEST(StuckEncoder, IsNoJointThatLagsAndMoves) {
  for (const double counts_s : {8.0, 40.0, 400.0, 3000.0})
    for (const double gain_per_s : {10.0, 50.0}) {
      FollowingJoint joint;
      EXPECT_EQ(joint.run([&](StuckEncoder::Sample& sample, double s) {
        sample.target_counts = static_cast<std::int32_t>(counts_s * s);
        sample.actual_counts = static_cast<std::int32_t>(counts_s * (s - (1 - std::exp(-gain_per_s * s)) / gain_per_s));
      }),
                never)
          << counts_s << " counts a second at " << gain_per_s;
    }
}

// A joint that meets something hard is 3.1 mrad behind with 4.8 N m, and 8.5 with 13. Either way, with a drive that counts either way. Below 0.012 rad/s it is told
// as stuck before it has wound up. From the end of its torque on something holds it, for a second: by then a contact is told, or cannot be.
TEST(StuckEncoder, IsNoJointThatIsHeld) {
  for (const double way : {-1.0, 1.0})
    for (const double sign : {-1.0, 1.0})
      for (const double counts_s : {100.0, 300.0, 1000.0}) {
        FollowingJoint joint;
        joint.now.rad_per_count = sign * rad_per_count;
        const double end_s = end_nm / (0.2 * counts_s);
        EXPECT_NEAR(joint.go(way * counts_s, 0, way * sign * 0.2 * counts_s), end_s + 1, 0.01) << "its load rises to the end of its torque";
      }
}

TEST(StuckEncoder, IsHeldByALoadThatHoldsItBackOnly) {
  EXPECT_NEAR(FollowingJoint().left_at(40, 3), 0.3, 0.01) << "too little to be a hold";
  FollowingJoint heavy;
  heavy.now.torque_nm = -14;
  heavy.stand(8);
  EXPECT_NEAR(heavy.left_at(40, -14), 0.3, 0.01) << "what it bears anyway";
  for (const double way : {-1.0, 1.0})
    for (const double sign : {-1.0, 1.0}) {
      FollowingJoint joint;
      joint.now.rad_per_count = sign * rad_per_count;
      EXPECT_NEAR(joint.left_at(static_cast<std::int32_t>(way) * 40, -way * sign * 8), 0.3, 0.01) << "pushed on towards its target";
      FollowingJoint held;
      held.now.rad_per_count = sign * rad_per_count;
      EXPECT_NEAR(held.left_at(static_cast<std::int32_t>(way) * 40, way * sign * 8), 3e-3 / (40 * rad_per_count), 0.01);
    }
}

// Gear and links wind up while the motor goes on: the counts end when the torque does.
TEST(StuckEncoder, IsNoJointThatMetSomethingElastic) {
  for (const double rad_s : {0.002, 0.005, 0.05}) {
    const double wound_s = 2.4e-3 / rad_s;
    for (const double nm : {8.0, 14.0}) {
      FollowingJoint joint;
      const double told_s = joint.run(
          [&](StuckEncoder::Sample& sample, double s) {
            sample.target_counts = static_cast<std::int32_t>(rad_s * std::min(s, 3.0 + wound_s + 5e-3 / rad_s) / rad_per_count);
            sample.actual_counts = static_cast<std::int32_t>(rad_s * std::min(s, 3.0 + wound_s) / rad_per_count);
            sample.torque_nm = nm * std::clamp((s - 3.0) / wound_s, 0.0, 1.0);
          },
          8);
      EXPECT_LT(told_s, never) << nm << " N m at " << rad_s;
      EXPECT_GT(told_s - 3 - wound_s, nm > end_nm ? 0.98 : 0.57) << nm << " N m at " << rad_s;
    }
  }
}

TEST(StuckEncoder, IsHeldByWhatIsMuchForItsMotor) {
  FollowingJoint small;
  small.now.load_nm = 1;
  EXPECT_NEAR(small.left_at(40, 1.1), 3e-3 / (40 * rad_per_count), 0.01);
  for (const double toward : {-1.0, 1.0}) {
    FollowingJoint weak;
    weak.now.motor_at_limit = true;
    EXPECT_NEAR(weak.left_at(40, toward * 2), toward > 0 ? 1 : 0.3, 0.01);
  }
}

// Behind on its way, while its weight changes: what it bore long ago is no measure.
TEST(StuckEncoder, IsHeldByMoreThanItBoreWhenItLastMoved) {
  for (const std::int32_t behind : {6, 40}) {
    FollowingJoint joint;
    EXPECT_EQ(joint.run(
                  [=](StuckEncoder::Sample& sample, double s) {
                    sample.target_counts = behind + static_cast<std::int32_t>(100 * s);
                    sample.actual_counts = static_cast<std::int32_t>(100 * s);
                    sample.torque_nm = 2 * s;
                  },
                  4),
              never);
    EXPECT_NEAR(joint.left_at(40, 8), 0.34, 0.06) << behind;
  }
}

// A drive winds its motor up while something holds the joint back. One that stays behind, short of the end of its torque, goes on unseen: at the gain of its position loop
// times the lag. The simulator's gain is 20 a second; 50 stands for stiffer drives.
TEST(StuckEncoder, IsNotHeldForGoodByALoadShortOfTheEndOfItsTorque) {
  for (const double counts_s : {3.0, 20.0, 40.0, 100.0, 300.0, 1000.0})
    for (const auto& [before_nm, since_nm] : {std::pair{-12.7, -0.5}, {0.8, 5.8}, {-8.0, 8.0}}) {
      FollowingJoint joint;
      joint.now.torque_nm = before_nm;  // when it last followed
      joint.stand(8);
      joint.now.torque_nm = since_nm;
      double gone_rad = 0;
      const double told_s = joint.run([&](StuckEncoder::Sample& sample, double s) {
        sample.target_counts = static_cast<std::int32_t>(counts_s * s);
        gone_rad += 50 * sample.target_counts * rad_per_count * 4e-3;
      });
      EXPECT_LT(told_s, never) << counts_s << " counts a second";
      EXPECT_LT(gone_rad, 0.5) << "at " << counts_s << " counts a second";
    }
}

TEST(StuckEncoder, IsHeldForLessTheFartherItIsBehind) {
  for (const std::int32_t way : {-1, 1})
    for (const std::int32_t counts : {8, 24, 60})
      EXPECT_NEAR(FollowingJoint().left_at(way * counts, way * 8), 3e-3 / (counts * rad_per_count), 0.01);
  EXPECT_NEAR(FollowingJoint().left_at(200, 8), 0.3, 0.005) << "never sooner than without a load";
}

// What wavers about its place shows no way, however long; what creeps two counts towards its target does.
TEST(StuckEncoder, IsOneThatWavers) {
  for (const std::int32_t by : {1, 2, 4, 10, 20}) {
    FollowingJoint joint;
    const double told_s = joint.run([&](StuckEncoder::Sample& sample, double s) {
      sample.target_counts = static_cast<std::int32_t>(300 * s);
      sample.actual_counts = (std::lround(s / 4e-3) * 7 % 3 - 1) * by;
    });
    EXPECT_LT(told_s, 0.7) << by << " counts either way";
  }
  for (const std::int32_t by : {5, 100}) {
    FollowingJoint fine;
    fine.now.rad_per_count = 1e-6;
    EXPECT_LT(fine.run([&](StuckEncoder::Sample& sample, double s) {
      sample.target_counts = static_cast<std::int32_t>(40000 * s);
      sample.actual_counts = (std::lround(s / 4e-3) * 7 % 3 - 1) * by;
    }),
              0.7)
        << by << " counts of a fine encoder";
  }
  FollowingJoint coarse;
  coarse.now.rad_per_count = 3.1e-3;
  EXPECT_NEAR(coarse.left_at(3, 0), 0.3, 0.01) << "3 counts of a coarse one";
  // Its target stays behind, as that of an arm that was held: it is carried on, and comes back.
  FollowingJoint carried;
  EXPECT_EQ(carried.run(
                [](StuckEncoder::Sample& sample, double s) {
                  sample.target_counts = -40;
                  sample.actual_counts = static_cast<std::int32_t>(std::lround(s < 0.2 ? 150 * s : s < 0.3 ? 30 : 30 - 120 * (s - 0.3)));
                },
                0.6),
            never);
  EXPECT_FALSE(carried.encoder.shows_nothing());
  FollowingJoint slow;
  const double told_s = slow.run([](StuckEncoder::Sample& sample, double s) {
    sample.target_counts = 50 + static_cast<std::int32_t>(4 * s);
    sample.actual_counts = static_cast<std::int32_t>(4 * s);
  });
  EXPECT_LT(told_s, 1) << "a count, and no second one";
  FollowingJoint creeps;
  EXPECT_EQ(creeps.run([](StuckEncoder::Sample& sample, double s) {
    sample.target_counts = 50 + static_cast<std::int32_t>(16 * s);
    sample.actual_counts = static_cast<std::int32_t>(16 * s);
  }),
            never);
}

// Its target stands, closer by than the reading wavers; or a sample now and then is wrong, and as if it were with its target.
TEST(StuckEncoder, IsOneThatWaversAboutItsTargetOrGlitches) {
  for (const auto& [counts, by] : {std::pair{9, 8}, {16, 12}, {24, 20}})
    for (const std::int32_t way : {-1, 1}) {
      FollowingJoint joint;
      EXPECT_LT(joint.run([counts, by, way](StuckEncoder::Sample& sample, double s) {
        sample.target_counts = way * counts;
        sample.actual_counts = waver(s, by);
      }),
                4)
          << counts << " counts off, by " << by;
    }
  for (const int every : {20, 70}) {
    FollowingJoint joint;
    EXPECT_LT(joint.run([every](StuckEncoder::Sample& sample, double s) {
      sample.target_counts = 77;
      sample.actual_counts = std::lround(s / 4e-3) % every == 0 ? 77 : 0;
    }),
              1)
        << "one sample of " << every;
  }
}

// At the end of its torque: whoever comes nearer to the target by 3 mrad is held anew, and nobody else. It may creep, or sway to and fro by less.
TEST(StuckEncoder, IsHeldForASecondInAllUnlessItComesNearer) {
  for (const double way : {-1.0, 1.0}) {
    for (const double rad_s : {0.0, 0.4e-3, 2e-3}) {
      FollowingJoint creeps;
      EXPECT_NEAR(creeps.run([&](StuckEncoder::Sample& sample, double s) {
        sample.target_counts = static_cast<std::int32_t>(way * 400);
        sample.actual_counts = static_cast<std::int32_t>(std::lround(way * rad_s * s / rad_per_count));
        sample.torque_nm = way * 14;
      }),
                  1, 0.03)
          << rad_s;
    }
    FollowingJoint comes;
    EXPECT_EQ(comes.run([&](StuckEncoder::Sample& sample, double s) {
      sample.target_counts = static_cast<std::int32_t>(way * 800);
      sample.actual_counts = static_cast<std::int32_t>(std::lround(way * 5e-3 * s / rad_per_count));
      sample.torque_nm = way * 14;
    }),
              never)
        << "5 mrad a second";
    for (const double hertz : {0.5, 1.0, 2.0}) {
      FollowingJoint sways;
      EXPECT_NEAR(sways.run([&](StuckEncoder::Sample& sample, double s) {
        sample.target_counts = static_cast<std::int32_t>(way * 40);
        sample.actual_counts = static_cast<std::int32_t>(std::lround(0.8e-3 * std::sin(2 * pi * hertz * s) / rad_per_count));
        sample.torque_nm = way * 14;
      }),
                  1, 0.03)
          << hertz;
    }
  }
}

// A drive that settles within a milliradian after a motion is not behind, however long it stands there.
TEST(StuckEncoder, IsNoJointThatSettlesWithinAMilliradian) {
  for (const double off_rad : {0.55e-3, 0.7e-3, 0.9e-3}) {
    FollowingJoint joint;
    EXPECT_EQ(joint.run([&](StuckEncoder::Sample& sample, double s) {
      sample.target_counts = static_cast<std::int32_t>(std::min(s, 1.0) * 1000);
      const double rad = sample.target_counts * rad_per_count;
      const double lag_rad = s < 1 ? 6e-3 * std::min(1.0, 10 * s) : std::max(off_rad, 6e-3 * std::exp(-20 * (s - 1)));
      sample.actual_counts = static_cast<std::int32_t>(std::lround((rad - lag_rad) / rad_per_count));
    }),
              never)
        << off_rad;
  }
}

TEST(StuckEncoder, IsNotHeldAnewByALoadThatFlickers) {
  FollowingJoint joint;
  EXPECT_NEAR(joint.run([](StuckEncoder::Sample& sample, double s) {
    sample.target_counts = 10;
    sample.torque_nm = std::lround(s / 4e-3) % 25 < 20 ? 14 : 8;
  }),
              1.25, 0.1);
}

// What was carried off without power is where it is when it gets power.
TEST(StuckEncoder, LooksAnewFromWhereItGetsPower) {
  FollowingJoint joint;
  joint.now.follows = false;
  joint.now.actual_counts = joint.now.target_counts = 2000;
  (void)joint.encoder.update(joint.now);
  joint.now.follows = true;
  EXPECT_EQ(joint.left_at(30, 0, 0.12), never);
  EXPECT_TRUE(joint.encoder.shows_nothing());
}

// It bore more before, and still pushes away from its target: nothing holds it back.
TEST(StuckEncoder, IsNotHeldByAWeightThatWentAway) {
  FollowingJoint joint;
  joint.now.torque_nm = -20;
  joint.stand(8);
  EXPECT_NEAR(joint.left_at(40, -14), 0.3, 0.01);
}

// At the end of its torque it is held: nothing is summed. But that ends no account: of a running motor's blows the first would end it otherwise.
TEST(StuckEncoder, GoesOnAfterTheEndOfItsTorque) {
  FollowingJoint joint;
  EXPECT_EQ(joint.left_at(40, 8, 0.4), never);
  EXPECT_EQ(joint.left_at(40, 14, 0.9), never);
  EXPECT_TRUE(joint.encoder.shows_nothing()) << "it still shows nothing";
  EXPECT_NEAR(joint.left_at(40, 8), 3e-3 / (40 * rad_per_count) - 0.4, 0.012);
  FollowingJoint spikes;
  const double told_s = spikes.run([](StuckEncoder::Sample& sample, double s) {
    sample.target_counts = static_cast<std::int32_t>(300 * s);
    sample.torque_nm = std::lround(s / 4e-3) % 10 == 0 ? 14 : 0.5;
  });
  EXPECT_LT(told_s, 0.4);
}

// What lives, and what ends it, is as much in radians as in counts.
TEST(StuckEncoder, KnowsCoarseAndFineCounts) {
  const auto of = [](double count_rad) {
    FollowingJoint joint;
    joint.now.rad_per_count = count_rad;
    return joint;
  };
  FollowingJoint coarse = of(3.1e-3);
  EXPECT_EQ(coarse.left_at(7, 0, 0.2), never);
  EXPECT_EQ(coarse.left_at(2, 0, 1), never) << "its account stands still";
  EXPECT_NEAR(coarse.left_at(7, 0), 0.1, 0.02) << "not back before one count";
  FollowingJoint back = of(3.1e-3);
  EXPECT_EQ(back.left_at(7, 0, 0.2), never);
  EXPECT_EQ(back.left_at(1, 0, 1), never);
  EXPECT_NEAR(back.left_at(7, 0), 0.3, 0.01);
  FollowingJoint one = of(3.1e-3);
  EXPECT_EQ(one.left_at(7, 0, 0.2), never);
  one.now.actual_counts += 2;
  EXPECT_NEAR(one.left_at(7, 0), 0.1, 0.01) << "two counts may be a waver";
  FollowingJoint fine = of(1e-6);
  EXPECT_EQ(fine.left_at(1100, 0, 0.8), never);
  EXPECT_EQ(fine.left_at(400, 0), never) << "back within half a milliradian";
  FollowingJoint crawls = of(1e-6);
  EXPECT_LT(crawls.run([](StuckEncoder::Sample& sample, double s) {
    sample.target_counts = 6000;
    sample.actual_counts = static_cast<std::int32_t>(100 * s);
  }),
            0.31)
      << "by 100 counts, 0.1 mrad, a second";
  FollowingJoint away = of(rad_per_count);
  EXPECT_EQ(away.left_at(40, 0, 0.2), never);
  away.now.actual_counts -= 4;
  EXPECT_NEAR(away.left_at(44, 0), 0.1, 0.01) << "half a milliradian away may be a waver, too";
}

// It stands where it is told to, so it does not go off: however long it was behind before.
TEST(StuckEncoder, BeginsAnewOnceItsTargetIsBack) {
  FollowingJoint joint;
  EXPECT_EQ(joint.left_at(40, 0, 0.25), never);
  EXPECT_EQ(joint.left_at(0, 0, 2), never);
  EXPECT_FALSE(joint.encoder.shows_nothing());
  EXPECT_NEAR(joint.left_at(40, 0), 0.3, 0.008);
  FollowingJoint other_way;
  EXPECT_EQ(other_way.left_at(40, 0, 0.25), never);
  EXPECT_NEAR(other_way.left_at(-40, 0), 0.3, 0.008);
  FollowingJoint off;
  EXPECT_EQ(off.left_at(40, 0, 0.25), never);
  off.now.follows = false;
  EXPECT_EQ(off.left_at(40, 0, 1), never);
  off.now.follows = true;
  off.now.t = off.now.t + Duration::from_ms(4);
  EXPECT_FALSE(off.encoder.update(off.now));
  EXPECT_FALSE(off.encoder.shows_nothing());
  EXPECT_NEAR(off.left_at(40, 0), 0.3, 0.008) << "without power it went nowhere";
  FollowingJoint hovers;
  hovers.now.rad_per_count = 1e-6;
  EXPECT_EQ(hovers.left_at(1100, 0, 0.8), never);
  EXPECT_EQ(hovers.left_at(700, 0, 2), never) << "its account stands still";
  EXPECT_NEAR(hovers.left_at(1100, 0), (1.5e-3 - 0.8 * 1.1e-3) / 1.1e-3, 0.02) << "not back before it is within half";
  FollowingJoint held;
  EXPECT_EQ(held.left_at(40, 5, 0.5), never);
  held.now.actual_counts += 40;
  held.stand(0.2);
  EXPECT_NEAR(held.left_at(40, 8), 3e-3 / (40 * rad_per_count), 0.012);
  FollowingJoint at_its_limit;
  EXPECT_EQ(at_its_limit.left_at(40, 14, 0.8), never);
  EXPECT_EQ(at_its_limit.left_at(0, 0, 0.2), never);
  EXPECT_NEAR(at_its_limit.left_at(40, 14), 1, 0.01);
  FollowingJoint shown;
  EXPECT_EQ(shown.left_at(40, 0, 0.2), never);
  shown.now.actual_counts += 3;
  const double sign_s = shown.left_at(40, 0);
  EXPECT_GT(sign_s, 0.3) << "a sign of life";
  EXPECT_LT(sign_s, 0.3 + 3 * StuckEncoder::mean_s);
}

TEST(StuckEncoder, GivesAJointThatStoodTheSameTime) {
  FollowingJoint joint;
  joint.stand(10);
  EXPECT_NEAR(joint.go(1000, 0), 0.308, 0.009);
  EXPECT_EQ(StuckEncoder::blind_time, Duration::from_ms(100));
  FollowingJoint blind;
  blind.stand(10);
  EXPECT_EQ(blind.go(1000, 0, 0, 0.09), never);
  EXPECT_FALSE(blind.encoder.shows_nothing()) << "90 ms after it was with its target";
}

// A target that stops near the reading: the joint creeps on, at the gain times so little.
TEST(StuckEncoder, IsToldThoughItsTargetStandsCloseBy) {
  EXPECT_NEAR(FollowingJoint().left_at(8, 0), 1.5e-3 / (8 * rad_per_count), 0.01);
  EXPECT_NEAR(FollowingJoint().left_at(-16, 0), 1.5e-3 / (16 * rad_per_count), 0.01);
}

// Between two samples nothing was read: a gap is no time in which the joint showed nothing.
TEST(StuckEncoder, CountsNoGap) {
  FollowingJoint joint;
  EXPECT_EQ(joint.left_at(40, 0, 0.1), never);
  joint.now.t = joint.now.t + Duration::from_s(5);
  EXPECT_FALSE(joint.encoder.update(joint.now));
  EXPECT_NEAR(joint.left_at(40, 0), 0.3 - 0.1 - 0.02, 0.009);
}

}  // namespace
}  // namespace lf::safety
