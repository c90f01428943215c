#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "firmware/arm/guarded_motion.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20135;

// A motion as the guard sees it, sample by sample at 250 Hz.
class Motion {
 public:
  explicit Motion(GuardedMotion& guard) : guard_(guard) {}

  // The same sample `n` times.
  GuardState feed(int n, const JointVector& torque_nm, const JointVector& behind_rad = JointVector::Zero()) {
    for (int i = 0; i < n; ++i) {
      t_ = t_ + Duration::from_ms(4);
      state_ = guard_.update(t_, behind_rad, JointVector::Zero(), JointVector::Zero(), torque_nm);
    }
    return state_;
  }
  Time now() const { return t_; }

 private:
  GuardedMotion& guard_;
  Time t_;
  GuardState state_ = GuardState::learning;
};

const JointVector friction = planar_joints(6, -8, 5, 0.5);

TEST(GuardedMotion, IsFreeWithTheTorqueThatItLearned) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  EXPECT_EQ(motion.feed(25, friction), GuardState::learning);
  EXPECT_EQ(motion.feed(1000, friction), GuardState::free);
  EXPECT_LT(guard.excess_torque_nm().norm(), 1e-9);
}

TEST(GuardedMotion, FindsAContactWithinTwentyMilliseconds) {
  for (int joint = 0; joint < 4; ++joint) {
    GuardedMotion guard(GuardConfig(4));
    Motion motion(guard);
    motion.feed(100, friction);
    JointVector pushed = friction;
    pushed[joint] += joint == 3 ? 4 : 8;  // twice the threshold
    EXPECT_EQ(motion.feed(8, pushed), GuardState::contact);
    EXPECT_EQ(guard.cause(), GuardCause::torque);
    EXPECT_EQ(static_cast<int>(guard.joint()), joint);
    EXPECT_EQ(motion.feed(100, friction), GuardState::contact) << "latched";
    guard.reset();
    EXPECT_EQ(guard.state(), GuardState::learning);
  }
}

TEST(GuardedMotion, TakesNoSingleOutlierForAContact) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  motion.feed(100, friction);
  for (int i = 0; i < 20; ++i) {
    motion.feed(1, friction + planar_joints(12, 0, 0, 0));
    EXPECT_EQ(motion.feed(20, friction), GuardState::free);
  }
}

TEST(GuardedMotion, FollowsASlowlyChangingWeightButNotAPush) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  motion.feed(30, friction);
  // 1 N m a second, as the arm's wet weight changes with its pose: 8 N m in all.
  JointVector torque = friction;
  for (int i = 0; i < 2000; ++i) {
    torque[1] += 0.004;
    ASSERT_EQ(motion.feed(1, torque), GuardState::free) << i;
  }
  // 20 N m a second, as a button's spring gives at 25 mm/s and 0.4 m.
  int samples = 0;
  while (motion.feed(1, torque) == GuardState::free) {
    torque[1] += 0.08;
    ASSERT_LT(++samples, 120);
  }
  EXPECT_EQ(guard.state(), GuardState::contact);
  EXPECT_GT(samples, 30) << "below the threshold of 4 N m it is not believed";
}

TEST(GuardedMotion, NoiseOfAnEncodersAndACurrentSensorsSizeIsNoContact) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, 0.5);
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  for (int i = 0; i < 20'000; ++i) {
    const JointVector torque = friction + planar_joints(noise(engine), noise(engine), noise(engine), 0.3 * noise(engine));
    const double behind_rad = 0.01 * noise(engine);
    motion.feed(1, torque, planar_joints(behind_rad, behind_rad, behind_rad, behind_rad));
  }
  EXPECT_EQ(guard.state(), GuardState::free);
}

TEST(GuardedMotion, FindsAJointThatStaysBehind) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  motion.feed(50, friction, planar_joints(0, 0.02, 0, 0));
  EXPECT_EQ(guard.state(), GuardState::free);
  EXPECT_EQ(motion.feed(3, friction, planar_joints(0, 0.04, 0, 0)), GuardState::contact);
  EXPECT_EQ(guard.cause(), GuardCause::following_error);
  EXPECT_EQ(guard.joint(), arm5e_joint::shoulder);
}

TEST(GuardedMotion, ReportsAnOverloadEvenWhileLearningAndOverAContact) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  EXPECT_EQ(motion.feed(4, planar_joints(0, 0, 60, 0)), GuardState::overload);
  EXPECT_EQ(guard.joint(), arm5e_joint::elbow);
  GuardedMotion other(GuardConfig(4));
  Motion second(other);
  second.feed(50, friction);
  EXPECT_EQ(second.feed(10, friction + planar_joints(8, 0, 0, 0)), GuardState::contact);
  EXPECT_EQ(second.feed(30, planar_joints(60, 0, 0, 0)), GuardState::overload);
}

TEST(GuardedMotion, RefusesNonsenseAndStaleSamplesAndCountsThem) {
  GuardedMotion guard(GuardConfig(4));
  Motion motion(guard);
  motion.feed(50, friction);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Time last = motion.now();
  motion.feed(10, planar_joints(nan, 0, 0, 0));
  guard.update(last, JointVector::Zero(), JointVector::Zero(), JointVector::Zero(), JointVector(JointVector::Constant(100)));
  guard.update(Time(), JointVector::Zero(), JointVector::Zero(), JointVector::Zero(), JointVector(JointVector::Constant(100)));
  EXPECT_EQ(guard.state(), GuardState::free);
  EXPECT_EQ(guard.refused(), 12u);
  guard.reset();
  EXPECT_EQ(guard.refused(), 12u) << "counters are never reset";
}

// What is not known of a torque widens the threshold by as much, and by no more; a bound that reaches across it is no contact.
TEST(GuardedMotion, BelievesOnlyWhatTheTorqueSurelyIs) {
  for (const double doubt_nm : {0.0, 3.0, 10.0}) {
    const auto state_at = [&](double rise_nm, double sign) {
      GuardedMotion guard(GuardConfig(4));
      Time t;
      for (int i = 0; i < 150; ++i) {
        JointTorques torque(friction);
        if (i >= 100) torque.nm[1] += sign * rise_nm;
        torque.low_nm = torque.nm.array() - doubt_nm;
        torque.high_nm = torque.nm.array() + doubt_nm;
        guard.update(t = t + Duration::from_ms(4), JointVector::Zero(), JointVector::Zero(), JointVector::Zero(), torque);
      }
      return guard.state();
    };
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_EQ(state_at(4.0 + doubt_nm + 0.8, sign), GuardState::contact) << doubt_nm;
      EXPECT_EQ(state_at(4.0 + doubt_nm - 0.3, sign), GuardState::free) << doubt_nm;
    }
  }
  // A screw that locks itself stands still: any load is possible, none is sure.
  GuardedMotion guard(GuardConfig(4));
  JointTorques unknown(friction);
  unknown.low_nm.setConstant(-1000);
  unknown.high_nm.setConstant(1000);
  for (int i = 0; i < 100; ++i)
    guard.update(Time() + Duration::from_ms(4 * (i + 1)), JointVector::Zero(), JointVector::Zero(), JointVector::Zero(), unknown);
  EXPECT_EQ(guard.state(), GuardState::free);
}

}  // namespace
}  // namespace lf::arm
