#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/arm/compliance.hpp"

namespace lf::arm {
namespace {

constexpr double period_s = 0.004;
const JointVector at_rest_nm = planar_joints(6, -8, 5, 0.5);

class Feed {
 public:
  explicit Feed(Compliance& compliance) : compliance_(compliance) {}
  void operator()(int samples, const JointVector& torque_nm) {
    for (int i = 0; i < samples; ++i) compliance_.update(t_ = t_ + Duration::from_s(period_s), torque_nm);
  }
  Time now() const { return t_; }

 private:
  Compliance& compliance_;
  Time t_;
};

TEST(Compliance, DoesNotMoveUnderTheTorqueThatItLearnedNorWithinItsDeadBand) {
  Compliance compliance(ComplianceConfig(4));
  Feed feed(compliance);
  feed(1000, at_rest_nm);
  feed(1000, at_rest_nm + planar_joints(1.9, -1.9, 1.9, 5));
  EXPECT_TRUE(compliance.offset_rad().isZero());
}

// A steady torque T over the dead band D moves a joint at g (T - D).
TEST(Compliance, GivesWayAgainstTheDrivesTorqueAtTheStatedSpeed) {
  const ComplianceConfig config(4);
  Compliance compliance(config);
  Feed feed(compliance);
  feed(100, at_rest_nm);
  const JointVector pushed = at_rest_nm + planar_joints(8, -6, 4, 5);
  feed(100, pushed);  // the filter has settled
  const JointVector before = compliance.offset_rad();
  feed(50, pushed);
  const JointVector speed = (compliance.offset_rad() - before) / (50 * period_s);
  EXPECT_NEAR(speed[0], -0.0015 * 6, 1e-5);
  EXPECT_NEAR(speed[1], 0.0015 * 4, 1e-5);
  EXPECT_NEAR(speed[2], -0.0015 * 2, 1e-5);
  EXPECT_EQ(speed[3], 0) << "the roll turns";
}

TEST(Compliance, GoesNoFurtherAndNoFasterThanItMay) {
  const ComplianceConfig config(4);
  Compliance compliance(config);
  Feed feed(compliance);
  feed(100, at_rest_nm);
  const JointVector pushed = at_rest_nm + planar_joints(500, 0, 0, 0);
  for (int i = 0; i < 2000; ++i) {
    const double before = compliance.offset_rad()[0];
    feed(1, pushed);
    EXPECT_LE(before - compliance.offset_rad()[0], config.largest_rad_s * period_s * 1.001);
  }
  EXPECT_EQ(compliance.offset_rad()[0], -config.largest_rad);
}

// The closed loop: drive, arm and contact together are a spring that the offset stretches, seen a position loop's 50 ms late.
TEST(Compliance, LetsTheLoadOfAStiffContactDecayWithoutHunting) {
  constexpr double stiffness_nm_rad = 4000;
  constexpr double loop_s = 0.05;
  constexpr double misplaced_rad = 0.01;
  Compliance compliance(ComplianceConfig(4));
  Feed feed(compliance);
  feed(30, JointVector::Zero());
  double moved_rad = 0;
  double least_nm = HUGE_VAL;
  double load_nm = 0;
  for (int i = 0; i < 500; ++i) {
    moved_rad += (compliance.offset_rad()[1] - moved_rad) * period_s / loop_s;
    load_nm = stiffness_nm_rad * (misplaced_rad + moved_rad);
    least_nm = std::min(least_nm, load_nm);
    feed(1, planar_joints(0, load_nm, 0, 0));
  }
  EXPECT_LT(load_nm, 2.1) << "of 40, after 2 s";
  EXPECT_GT(least_nm, -2) << "it went past the rest and would come back";
}

TEST(Compliance, TakesAGapBetweenSamplesForAShortOne) {
  const ComplianceConfig config(4);
  Compliance compliance(config);
  Feed feed(compliance);
  const JointVector pushed = at_rest_nm + planar_joints(500, 0, 0, 0);
  feed(100, at_rest_nm);
  feed(20, pushed);
  const double before = compliance.offset_rad()[0];
  compliance.update(feed.now() + Duration::from_s(60), pushed);
  EXPECT_NEAR(before - compliance.offset_rad()[0], config.largest_rad_s * config.largest_step_s, 1e-12);
}

TEST(Compliance, RefusesWhatIsNoNumberAndWhatIsNotLater) {
  Compliance compliance(ComplianceConfig(4));
  Feed feed(compliance);
  feed(100, at_rest_nm);
  compliance.update(feed.now(), JointVector(at_rest_nm * 100));
  compliance.update(feed.now() + Duration::from_s(1), JointVector(JointVector::Constant(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_EQ(compliance.refused(), 2u);
  EXPECT_TRUE(compliance.offset_rad().isZero());
}

TEST(Compliance, ForgetsWhenItIsReset) {
  Compliance compliance(ComplianceConfig(4));
  Feed feed(compliance);
  feed(100, at_rest_nm);
  feed(100, at_rest_nm + planar_joints(50, 0, 0, 0));
  EXPECT_FALSE(compliance.offset_rad().isZero());
  compliance.reset();
  EXPECT_TRUE(compliance.offset_rad().isZero());
  feed(1000, at_rest_nm + planar_joints(50, 0, 0, 0));
  EXPECT_TRUE(compliance.offset_rad().isZero()) << "that is its rest now";
}

TEST(Compliance, GivesWayToWhatATorqueHasSurelyRisenBy) {
  const ComplianceConfig config(4);
  const auto offset_after = [&](double rise_nm, double doubt_nm) {
    Compliance compliance(config);
    Time t;
    for (int i = 0; i < 200; ++i) {
      JointTorques torque(at_rest_nm);
      if (i >= 100) torque.nm[1] += rise_nm;
      torque.low_nm = torque.nm.array() - doubt_nm;
      torque.high_nm = torque.nm.array() + doubt_nm;
      compliance.update(t = t + Duration::from_s(period_s), torque);
    }
    return compliance.offset_rad()[1];
  };
  EXPECT_NEAR(offset_after(9, 3), offset_after(6, 0), 0.15 * std::abs(offset_after(6, 0)));  // but for the filter
  EXPECT_NEAR(offset_after(-9, 3), -offset_after(9, 3), 1e-9);
  EXPECT_LT(offset_after(9, 3), 0);
  EXPECT_EQ(offset_after(9, 8), 0);
}

}  // namespace
}  // namespace lf::arm
