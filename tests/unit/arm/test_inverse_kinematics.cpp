#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/arm/inverse_kinematics.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/all_named.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20132;

TEST(InverseKinematicsNames, OfEachOutcome) {
  test::expect_all_named<IkOutcome>(8, [](IkOutcome o) { return name(o); });
}

TEST(InverseKinematics, HitsEveryOfAMillionReachableTargetsToANanometre) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  double worst_m = 0;
  double worst_roll_rad = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const JointVector q = random.next();
    const Vec3 target = test::arm5e.base_from_tool(q).translation();
    const IkResult ik = inverse_kinematics(test::arm5e, target, q[3], 0);
    ASSERT_TRUE(ik.ok()) << i << ": " << name(ik.outcome) << " by " << ik.excess << " for " << q.transpose();
    worst_m = std::max(worst_m, (test::arm5e.base_from_tool(ik.q_rad).translation() - target).norm());
    worst_roll_rad = std::max(worst_roll_rad, std::abs(ik.q_rad[3] - q[3]));
  }
  EXPECT_LT(worst_m, 1e-9);
  EXPECT_EQ(worst_roll_rad, 0);
}

TEST(InverseKinematics, GivesTheOnlyJointAnglesThereAre) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 1);
  for (int i = 0; i < 100'000; ++i) {
    const JointVector q = random.next();
    if (test::arm5e.base_from_tool(q).translation().head<2>().norm() < 1e-3) continue;  // on the slew axis any slew angle will do
    const IkResult ik = inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(q).translation(), q[3], 0);
    ASSERT_LT((ik.q_rad - q).cwiseAbs().maxCoeff(), 1e-7) << q.transpose();
  }
}

// Two fingers' width outside of each limit in turn: refused, with that joint's name and the way to go back.
TEST(InverseKinematics, SaysWhichLimitStopsIt) {
  const IkOutcome reasons[] = {IkOutcome::slew_limit, IkOutcome::shoulder_limit, IkOutcome::elbow_limit, IkOutcome::roll_limit};
  const JointLimits limits = test::arm5e.limits();
  for (int joint = 0; joint < 4; ++joint) {
    for (const bool above : {false, true}) {
      if (joint == 2 && !above) continue;  // below 0 the elbow's triangle is flat: another answer exists
      JointVector q = planar_joints(0.1, 0.8, 1.2, 0.4);
      q[joint] = above ? limits.upper_rad[joint] + 0.02 : limits.lower_rad[joint] - 0.02;
      const IkResult ik = inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(q).translation(), q[3], 0);
      EXPECT_EQ(ik.outcome, reasons[joint]) << joint << above << ": " << name(ik.outcome);
      EXPECT_NEAR(ik.excess, 0.02, 1e-9) << joint << above;
      EXPECT_LT((ik.q_rad - q).cwiseAbs().maxCoeff(), 1e-9) << "the angles that would be needed";
    }
  }
  const JointVector flat = planar_joints(0.1, 0.8, -0.02, 0.4);
  EXPECT_EQ(inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(flat).translation(), 0, 0).outcome, IkOutcome::elbow_limit);
}

TEST(InverseKinematics, DrawsTheLimitsInByTheMargin) {
  JointVector q = planar_joints(0.1, 0.8, 1.2, 0.4);
  q[1] = test::arm5e.limits().upper_rad[1] - 0.03;
  const Vec3 target = test::arm5e.base_from_tool(q).translation();
  EXPECT_TRUE(inverse_kinematics(test::arm5e, target, q[3], 0.02).ok());
  EXPECT_EQ(inverse_kinematics(test::arm5e, target, q[3]).outcome, IkOutcome::shoulder_limit);
  EXPECT_EQ(inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(planar_joints(0.1, 0.8, 1.2, 0)).translation(), pi - 0.04).outcome,
            IkOutcome::roll_limit);
}

TEST(InverseKinematics, AnswersExactlyAtTheLimits) {
  const JointLimits limits = test::arm5e.limits();
  for (int corner = 0; corner < 16; ++corner) {
    JointVector q = JointVector::Zero();
    for (int i = 0; i < 4; ++i) q[i] = (corner >> i) & 1 ? limits.upper_rad[i] : limits.lower_rad[i];
    const Vec3 target = test::arm5e.base_from_tool(q).translation();
    const IkResult ik = inverse_kinematics(test::arm5e, target, q[3], 0);
    EXPECT_TRUE(ik.ok()) << corner << ": " << name(ik.outcome) << " by " << ik.excess;
    EXPECT_LT((test::arm5e.base_from_tool(ik.q_rad).translation() - target).norm(), 1e-9);
  }
}

// From anywhere: rounding passes a limit by some 1e-16, and the answer does not.
TEST(InverseKinematics, AnswersWithinTheLimitsWhereOneJointIsAtOne) {
  const JointLimits limits = test::arm5e.limits();
  RandomJoints random(20261125, 0.05);
  for (int draw = 0; draw < 2000; ++draw) {
    const int joint = draw % 3;  // the roll is told, not solved
    JointVector q = random.next();
    q[joint] = draw % 2 == 0 ? limits.upper_rad[joint] : limits.lower_rad[joint];
    const IkResult ik = inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(q).translation(), q[3], 0);
    ASSERT_TRUE(ik.ok()) << draw << ": " << name(ik.outcome) << " by " << ik.excess;
    EXPECT_TRUE(((ik.q_rad - limits.upper_rad).array() <= 0).all() && ((ik.q_rad - limits.lower_rad).array() >= 0).all()) << draw;
  }
}

TEST(InverseKinematics, KnowsTooFarFromTooNear) {
  const IkResult far = inverse_kinematics(test::arm5e, {2, 0, 0.3}, 0);
  EXPECT_EQ(far.outcome, IkOutcome::too_far);
  // From the shoulder, folded under: 2 + 0.08052 ahead and 0.3 below; the stretched arm reaches 0.44278 + 0.49951.
  EXPECT_NEAR(far.excess, std::hypot(2.08052, 0.3) - 0.44278 - std::hypot(0.49257, 0.083), 1e-9);
  const IkResult near = inverse_kinematics(test::arm5e, {-0.08052, 0, 0.01}, 0);  // beside the shoulder itself
  EXPECT_EQ(near.outcome, IkOutcome::too_near);
  EXPECT_NEAR(near.excess, std::hypot(0.49257, 0.083) - 0.44278 - 0.01, 1e-9);
}

TEST(InverseKinematics, RefusesWhatIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e200}) {
    for (int i = 0; i < 3; ++i) {
      Vec3 target(0.3, 0, 0.5);
      target[i] = bad;
      EXPECT_FALSE(inverse_kinematics(test::arm5e, target, 0).ok());
    }
    EXPECT_FALSE(inverse_kinematics(test::arm5e, {0.3, 0, 0.5}, bad).ok());
  }
  EXPECT_EQ(inverse_kinematics(test::arm5e, {nan, 0, 0.5}, 0).outcome, IkOutcome::not_a_number);
}

TEST(InverseKinematics, FoldsUnderTowardThePanelAndFacesWhatIsBehind) {
  EXPECT_EQ(inverse_kinematics(test::arm5e, {0.34, 0, 0.592}, 0).posture.branch, IkBranch::folded);
  const JointVector front = planar_joints(0.2, 0.3, 0.5, 0);
  ASSERT_LT(test::arm5e.base_from_tool(front).translation().x(), 0);
  EXPECT_EQ(inverse_kinematics(test::arm5e, test::arm5e.base_from_tool(front).translation(), 0).posture.branch, IkBranch::front);
}

TEST(BarRolls, LayTheToolsYAlongTheBar) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 2);
  for (int i = 0; i < 10'000; ++i) {
    JointVector q = random.next();
    const Vec3 bar(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const std::optional<BarRolls> rolls = rolls_for_bar(test::arm5e, q, bar);
    const double off_axis = std::acos(std::abs(bar.normalized().dot(test::arm5e.approach_axis(q))));
    ASSERT_TRUE(!rolls || off_axis > 0.199);
    if (!rolls) {
      ASSERT_LT(off_axis, 0.2001);
      continue;
    }
    ASSERT_NEAR(std::abs(wrap(rolls->roll_rad[1] - rolls->roll_rad[0])), pi, 1e-12);
    for (const double roll : rolls->roll_rad) {
      q[3] = roll;
      const Mat3 tool = test::arm5e.base_from_tool(q).linear();
      ASSERT_NEAR(tool.col(0).dot(bar), 0, 1e-12);  // the fingers close across it
      ASSERT_NEAR(std::acos(std::min(1.0, std::abs(tool.col(1).dot(bar.normalized())))), rolls->tilt_rad, 1e-7);
    }
  }
}

TEST(BarRolls, RefuseABarAlongTheToolAndNoBarAtAll) {
  const JointVector q = planar_joints(0, 1.307, 1.151, 0);
  EXPECT_FALSE(rolls_for_bar(test::arm5e, q, test::arm5e.approach_axis(q)));
  EXPECT_FALSE(rolls_for_bar(test::arm5e, q, Vec3::Zero()));
  EXPECT_FALSE(rolls_for_bar(test::arm5e, q, Vec3(std::nan(""), 0, 1)));
}

TEST(BarRolls, AreChosenSoThatTheWholeTurnFits) {
  const BarRolls level{{0.2, 0.2 - pi}, 0};
  constexpr double lower = -pi + default_limit_margin_rad, upper = pi - default_limit_margin_rad;
  EXPECT_EQ(roll_for_turn(level, 1.5, lower, upper), 0.2);
  EXPECT_EQ(roll_for_turn(level, 3.1, lower, upper), 0.2 - pi);  // 0.2 + 3.1 passes the limit of pi, -2.94 + 3.1 does not
  EXPECT_EQ(roll_for_turn(level, -3.1, lower, upper), 0.2);      // down to -2.9
  EXPECT_FALSE(roll_for_turn(level, 6.2, lower, upper));
}

}  // namespace
}  // namespace lf::arm
