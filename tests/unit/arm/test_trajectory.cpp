#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "firmware/arm/trajectory.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20134;
constexpr double tick_s = 0.004;

// Samples a motion at every control period and checks it against the joints' limits; a sampled derivative may exceed a bound by rounding only.
template <class Motion>
void expect_within(Motion& motion, const JointLimits& limits, double jerk_factor = 1) {
  JointState last = motion.sample(0);
  for (double t = tick_s; t < motion.duration_s() + 2 * tick_s; t += tick_s) {
    const JointState s = motion.sample(t);
    ASSERT_TRUE(s.q_rad.allFinite() && s.qd_rad_s.allFinite() && s.qdd_rad_s2.allFinite());
    for (int i = 0; i < 4; ++i) {
      ASSERT_LE(std::abs(s.qd_rad_s[i]), limits.velocity_rad_s[i] * (1 + 1e-6)) << "joint " << i << " at " << t << " s";
      ASSERT_LE(std::abs(s.qdd_rad_s2[i]), limits.acceleration_rad_s2[i] * (1 + 1e-6)) << "joint " << i << " at " << t << " s";
      ASSERT_LE(std::abs(s.qdd_rad_s2[i] - last.qdd_rad_s2[i]), jerk_factor * limits.jerk_rad_s3[i] * tick_s * (1 + 1e-6) + 1e-9)
          << "joint " << i << " at " << t << " s";
      ASSERT_LE(std::abs(s.q_rad[i] - last.q_rad[i]), limits.velocity_rad_s[i] * tick_s * (1 + 1e-6) + 1e-9);
      ASSERT_LE(std::abs(s.qd_rad_s[i] - last.qd_rad_s[i]), limits.acceleration_rad_s2[i] * tick_s * (1 + 1e-6) + 1e-9);
    }
    last = s;
  }
}

TEST(JointTrajectory, KeepsLimitsMovesInStepAndArrivesExactly) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  const JointLimits limits = test::arm5e.limits(0, 0.6);
  for (int k = 0; k < 300; ++k) {
    const JointVector start = random.next(), goal = random.next();
    JointTrajectory motion;
    ASSERT_EQ(motion.plan(start, goal, limits), PlanOutcome::ok);
    ASSERT_EQ(motion.sample(0).q_rad, start);
    ASSERT_EQ(motion.sample(motion.duration_s()).q_rad, goal);
    ASSERT_EQ(motion.sample(motion.duration_s()).qd_rad_s, JointVector::Zero());
    expect_within(motion, limits);
    // In step: every joint has gone the same fraction of its way.
    const JointVector fraction = (motion.sample(0.4 * motion.duration_s()).q_rad - start).cwiseQuotient(goal - start);
    ASSERT_LT(fraction.maxCoeff() - fraction.minCoeff(), 1e-9);
  }
}

TEST(JointTrajectory, ReachesTheLimitOfTheJointThatHoldsItBack) {
  JointTrajectory motion;
  const JointLimits limits = test::arm5e.limits();
  ASSERT_EQ(motion.plan(planar_joints(0, 0.1, 0.1, 0), planar_joints(0, 1.5, 0.2, 0), limits), PlanOutcome::ok);
  EXPECT_NEAR(motion.sample(motion.duration_s() / 2).qd_rad_s[1], limits.velocity_rad_s[1], 1e-9);
}

TEST(JointTrajectory, RefusesGoalsOutsideAndWhatIsNotANumber) {
  const JointLimits limits = test::arm5e.limits(0.05);
  const JointVector park = planar_joints(0, 0.6, 1.9, 0);
  JointTrajectory motion;
  EXPECT_EQ(motion.plan(park, planar_joints(0, 0.04, 1.9, 0), limits), PlanOutcome::outside);
  EXPECT_EQ(motion.plan(park, planar_joints(0, std::nan(""), 1.9, 0), limits), PlanOutcome::not_a_number);
  EXPECT_EQ(motion.sample(1).q_rad, park) << "a refused motion stays where it is";
  JointLimits none = limits;
  none.velocity_rad_s[2] = 0;
  EXPECT_EQ(motion.plan(park, park, none), PlanOutcome::not_a_number);
  EXPECT_EQ(motion.plan(planar_joints(0, 0.04, 1.9, 0), park, limits), PlanOutcome::ok) << "back inside from a margin";
}

TEST(JointTrajectory, StaysForNoWayAndManagesTheTiniest) {
  const JointVector park = planar_joints(0, 0.6, 1.9, 0);
  JointTrajectory motion;
  ASSERT_EQ(motion.plan(park, park, test::arm5e.limits()), PlanOutcome::ok);
  EXPECT_EQ(motion.duration_s(), 0);
  const JointVector near = park + planar_joints(1e-12, 0, 1e-13, 0);
  ASSERT_EQ(motion.plan(park, near, test::arm5e.limits()), PlanOutcome::ok);
  EXPECT_EQ(motion.sample(1).q_rad, near);
}

TEST(JointPath, StopsInEachViaPoint) {
  const JointLimits limits = test::arm5e.limits();
  const JointVector start = planar_joints(0, 0.6, 1.9, 0);
  const std::vector<JointVector> points{planar_joints(0, 0.9, 1.6, 0), planar_joints(0.1, 1.083, 1.355, 1.0),
                                        planar_joints(0, 1.307, 1.151, 1.5)};
  JointPath path;
  ASSERT_EQ(path.plan(start, points, limits), PlanOutcome::ok);
  expect_within(path, limits);
  double t = 0;
  JointVector from = start;
  for (const JointVector& to : points) {
    JointTrajectory leg;
    ASSERT_EQ(leg.plan(from, to, limits), PlanOutcome::ok);
    t += leg.duration_s();
    EXPECT_LT((path.sample(t).q_rad - to).norm(), 1e-12);
    EXPECT_LT(path.sample(t).qd_rad_s.norm(), 1e-9);
    from = to;
  }
  EXPECT_NEAR(path.duration_s(), t, 1e-12);
  EXPECT_EQ(path.sample(1e9).q_rad, points.back());
}

TEST(JointPath, RefusesTooManyPointsAndKeepsWhatItHad) {
  const JointVector park = planar_joints(0, 0.6, 1.9, 0);
  JointPath path;
  ASSERT_EQ(path.plan(park, {}, test::arm5e.limits()), PlanOutcome::ok);
  EXPECT_EQ(path.sample(3).q_rad, park);
  EXPECT_EQ(path.plan(park, std::vector<JointVector>(9, park), test::arm5e.limits()), PlanOutcome::too_many);
  const std::vector<JointVector> bad{park, planar_joints(0, 3, 1, 0)};
  EXPECT_EQ(path.plan(park, bad, test::arm5e.limits()), PlanOutcome::outside);
  EXPECT_EQ(path.duration_s(), 0);
}

TEST(CartesianLine, KeepsTheToolOnTheLineAndTheJointsWithinTheirLimits) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 1, 0.06);
  const JointLimits limits = test::arm5e.limits(0.05);
  const LineLimits line{0.08, 0.3, 3.0};
  int planned = 0;
  for (int k = 0; k < 400; ++k) {
    const JointVector start = random.next();
    const Vec3 from = test::arm5e.base_from_tool(start).translation();
    const Vec3 to = from + Vec3(random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15));
    const double roll = random.uniform(-3, 3);
    CartesianLine motion;
    const LinePlan plan = motion.plan(test::arm5e, start, to, roll, line, limits);
    if (plan.outcome != PlanOutcome::ok) {
      ASSERT_EQ(plan.outcome, PlanOutcome::unreachable);
      ASSERT_NE(plan.ik, IkOutcome::ok);
      ASSERT_GT(plan.fraction, 0);
      continue;
    }
    ++planned;
    ASSERT_LE(plan.speed_m_s, line.speed_m_s * (1 + 1e-9));
    expect_within(motion, limits, 20);
    const Vec3 direction = (to - from).normalized();
    for (int i = 0; i <= 50; ++i) {
      const double t = motion.duration_s() * i / 50;
      const JointState s = motion.sample(t);
      const Vec3 tool = test::arm5e.base_from_tool(s.q_rad).translation();
      ASSERT_LT((tool - from).cross(direction).norm(), 1e-9);
      ASSERT_LT((tool - motion.tool_m(t)).norm(), 1e-9);
      ASSERT_LE((test::arm5e.jacobian(s.q_rad).topRows<3>() * s.qd_rad_s).norm(), plan.speed_m_s * (1 + 1e-6) + 1e-9);
    }
    ASSERT_LT((test::arm5e.base_from_tool(motion.sample(1e9).q_rad).translation() - to).norm(), 1e-9);
    ASSERT_EQ(motion.sample(1e9).q_rad[3], roll);
    ASSERT_LT((motion.sample(0).q_rad - start).norm(), 1e-9);
  }
  EXPECT_GT(planned, 150);
}

TEST(CartesianLine, RatesAreTheDerivativesOfTheJoints) {
  CartesianLine motion;
  ASSERT_EQ(motion.plan(test::arm5e, planar_joints(0, 1.083, 1.355, 0), {0.34, 0.05, 0.592}, 1.2, {}, test::arm5e.limits()).outcome,
            PlanOutcome::ok);
  constexpr double h = 1e-4;
  for (double t = 0.1; t < motion.duration_s() - 0.1; t += 0.05) {
    const JointState below = motion.sample(t - h), here = motion.sample(t), above = motion.sample(t + h);
    EXPECT_LT(((above.q_rad - below.q_rad) / (2 * h) - here.qd_rad_s).norm(), 1e-6);
    EXPECT_LT(((above.qd_rad_s - below.qd_rad_s) / (2 * h) - here.qdd_rad_s2).norm(), 1e-4);
  }
}

TEST(CartesianLine, PlannedInSharesIsTheSame) {
  const JointVector start = planar_joints(0, 1.083, 1.355, 0);
  CartesianLine at_once, in_shares;
  const LinePlan plan = at_once.plan(test::arm5e, start, {0.34, 0.05, 0.592}, 1.2, {}, test::arm5e.limits());
  ASSERT_EQ(plan.outcome, PlanOutcome::ok);
  in_shares.begin(test::arm5e, start, {0.34, 0.05, 0.592}, 1.2, {}, test::arm5e.limits());
  int shares = 1;
  for (; !in_shares.advance(16); ++shares) {
    EXPECT_EQ(in_shares.duration_s(), 0);
    EXPECT_EQ(in_shares.sample(1).q_rad, start);
  }
  EXPECT_EQ(shares, 5);
  EXPECT_EQ(in_shares.result().outcome, PlanOutcome::ok);
  EXPECT_EQ(in_shares.result().speed_m_s, plan.speed_m_s);
  EXPECT_EQ(in_shares.duration_s(), at_once.duration_s());
  EXPECT_EQ(in_shares.sample(1).q_rad, at_once.sample(1).q_rad);
}

TEST(CartesianLine, SaysWhereAndWhyItCannotGo) {
  CartesianLine motion;
  const JointVector start = planar_joints(0, 1.083, 1.355, 0);
  const LinePlan far = motion.plan(test::arm5e, start, {1.5, 0, 0.6}, 0, {}, test::arm5e.limits());
  EXPECT_EQ(far.outcome, PlanOutcome::unreachable);
  EXPECT_NE(far.ik, IkOutcome::ok);
  EXPECT_GT(far.fraction, 0.05);
  EXPECT_LT(far.fraction, 0.8);
  EXPECT_EQ(motion.duration_s(), 0);
  EXPECT_EQ(motion.sample(1).q_rad, start);
  EXPECT_EQ(motion.plan(test::arm5e, start, {std::nan(""), 0, 0.6}, 0, {}, test::arm5e.limits()).outcome, PlanOutcome::not_a_number);
  EXPECT_EQ(motion.plan(test::arm5e, start, {0.3, 0, 0.6}, 0, {0, 1, 1}, test::arm5e.limits()).outcome, PlanOutcome::not_a_number);
}

TEST(CartesianLine, TurnsTheWristInPlace) {
  CartesianLine motion;
  const JointVector start = planar_joints(0, 1.307, 1.151, 0.2);
  const JointLimits limits = test::arm5e.limits();
  const LinePlan plan = motion.plan(test::arm5e, start, test::arm5e.base_from_tool(start).translation(), 1.8, {}, limits);
  ASSERT_EQ(plan.outcome, PlanOutcome::ok);
  expect_within(motion, limits);
  EXPECT_EQ(motion.sample(1e9).q_rad[3], 1.8);
  EXPECT_LT((motion.sample(motion.duration_s() / 2).q_rad - planar_joints(0, 1.307, 1.151, 1.0)).norm(), 1e-9);
}

// The layout's sweep: the elbow at 0.065 rad/s, above the stiction of 0.06 rad/s all along the panel, run-up and run-out outside of it.
TEST(ConstantSpeedSweep, MovesAtConstantSpeedBetweenRunUpAndRunOut) {
  const JointLimits limits = test::arm5e.limits(0.008);
  const JointVector from = planar_joints(0, 0.945, 2.095, 0), to = planar_joints(0, 0.945, 0.920, 0);
  ConstantSpeedSweep sweep;
  const double cruise_s = (2.095 - 0.920) / 0.065;
  ASSERT_EQ(sweep.plan(from, to, cruise_s, limits), PlanOutcome::ok);
  expect_within(sweep, limits);
  for (double t = sweep.cruise_start_s(); t <= sweep.cruise_end_s(); t += 0.1) EXPECT_NEAR(sweep.sample(t).qd_rad_s[2], -0.065, 1e-12);
  EXPECT_LT((sweep.sample(sweep.cruise_start_s()).q_rad - from).norm(), 1e-12);
  EXPECT_LT((sweep.sample(sweep.cruise_end_s()).q_rad - to).norm(), 1e-12);
  EXPECT_EQ(sweep.sample(0).qd_rad_s.norm(), 0);
  EXPECT_LT(sweep.sample(sweep.duration_s()).qd_rad_s.norm(), 1e-12);
  EXPECT_NEAR((sweep.start_rad() - from).norm(), 0.065 * sweep.cruise_start_s() / 2, 1e-12);
}

TEST(ConstantSpeedSweep, RefusesToStartOrEndOutsideAndToBeTooFast) {
  ConstantSpeedSweep sweep;
  const JointVector from = planar_joints(0, 0.945, 2.15, 0), to = planar_joints(0, 0.945, 0.920, 0);
  EXPECT_EQ(sweep.plan(from, to, 18, test::arm5e.limits()), PlanOutcome::outside) << "the run-up passes the elbow's limit";
  EXPECT_EQ(sweep.plan(planar_joints(0, 0.945, 1.9, 0), to, 1, test::arm5e.limits()), PlanOutcome::outside) << "1 rad/s";
  EXPECT_EQ(sweep.plan(from, to, 0, test::arm5e.limits()), PlanOutcome::not_a_number);
  EXPECT_EQ(sweep.sample(1).q_rad, from);
}

TEST(ConstantSpeedSweep, KeepsLimitsForRandomSweeps) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 2, 0.2);
  const JointLimits limits = test::arm5e.limits();
  int planned = 0;
  for (int k = 0; k < 200; ++k) {
    ConstantSpeedSweep sweep;
    const JointVector from = random.next(), to = random.next();
    if (sweep.plan(from, to, random.uniform(1, 20), limits) != PlanOutcome::ok) continue;
    ++planned;
    expect_within(sweep, limits);
  }
  EXPECT_GT(planned, 50);
}

TEST(JointStop, BringsEveryJointToRestFromTheMiddleOfAMotion) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 3);
  const JointLimits limits = test::arm5e.limits();
  for (int k = 0; k < 200; ++k) {
    JointTrajectory motion;
    ASSERT_EQ(motion.plan(random.next(), random.next(), limits), PlanOutcome::ok);
    const JointState at = motion.sample(motion.duration_s() * random.uniform(0, 1));
    const JointStop stop(at, limits);
    ASSERT_EQ(stop.sample(0).q_rad, at.q_rad);
    expect_within(stop, limits);
    ASSERT_EQ(stop.sample(stop.duration_s()).qd_rad_s, JointVector::Zero());
    ASSERT_LT(stop.duration_s(), 1.0);
  }
}

TEST(JointStop, TakesWhatIsNotANumberAsRest) {
  JointState at;
  at.q_rad = planar_joints(0.1, 0.2, 0.3, 0.4);
  at.qd_rad_s[1] = std::numeric_limits<double>::quiet_NaN();
  const JointStop stop(at, test::arm5e.limits());
  EXPECT_EQ(stop.sample(5).q_rad, at.q_rad);
  EXPECT_EQ(JointStop().duration_s(), 0);
}

}  // namespace
}  // namespace lf::arm
