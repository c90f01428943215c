#include "firmware/mission/motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "firmware/arm/inverse_kinematics.hpp"

namespace lf::mission {
namespace {

constexpr double period_s = 0.004;

safety::Limits limits() {
  safety::Limits limits;
  const arm::JointLimits urdf = arm::joint_limits();
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    limits.joints[i] = {urdf.lower_rad[k] + 0.02, urdf.upper_rad[k] - 0.02, 0.8 * urdf.velocity_rad_s[k], 50};
  }
  limits.joints[4] = {-0.05, 1.3, 0.5, 20};
  return limits;
}

// Steps to the end and returns the largest joint speed seen, relative to its limit.
double run(Motion& motion, int max_steps = 100'000) {
  double fastest = 0;
  const arm::JointVector speed = motion.limits(1).velocity_rad_s;
  for (int i = 0; i < max_steps && !motion.done(); ++i) {
    const arm::JointVector before = motion.target();
    motion.step(period_s);
    fastest = std::max(fastest, ((motion.target() - before) / period_s).cwiseAbs().cwiseQuotient(speed).maxCoeff());
  }
  EXPECT_TRUE(motion.done());
  return fastest;
}

TEST(Motion, RandomWaysArriveExactlyAndKeepTheSpeedLimits) {
  constexpr unsigned seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  Motion motion(limits());
  const arm::JointLimits bounds = motion.limits(1);
  const auto draw = [&] {
    arm::JointVector q;
    for (Eigen::Index i = 0; i < 4; ++i) q[i] = std::uniform_real_distribution<double>(bounds.lower_rad[i], bounds.upper_rad[i])(random);
    return q;
  };
  motion.start_at(draw());
  for (int i = 0; i < 100; ++i) {
    const std::array way{draw(), draw()};
    ASSERT_TRUE(motion.go(way, 0.6));
    EXPECT_LE(run(motion), 0.6 * 1.001);
    EXPECT_LT((motion.target() - way[1]).norm(), 1e-9);
  }
}

TEST(Motion, RefusesGoalsOutsideTheSafetyLimitsAndStaysWhereItIs) {
  Motion motion(limits());
  motion.start_at({0, 0.6, 1.9, 0});
  EXPECT_FALSE(motion.go(std::array{arm::JointVector(0, 0.005, 1.9, 0)}, 0.6));  // inside the URDF's, outside the mission's
  EXPECT_TRUE(motion.done());
  EXPECT_EQ(motion.target(), arm::JointVector(0, 0.6, 1.9, 0));
}

TEST(Motion, ALineStaysOnTheLine) {
  Motion motion(limits());
  const arm::IkResult start = arm::inverse_kinematics({0.25, 0, 0.59}, 0.3);
  ASSERT_TRUE(start.ok());
  motion.start_at(start.q_rad);
  const Vec3 from = arm::base_from_tool(start.q_rad).translation();
  const Vec3 to(0.34, 0.01, 0.592);
  ASSERT_TRUE(motion.line(to, 0.3, 0.04));
  while (!motion.done()) {
    motion.step(period_s);
    const Vec3 tool = arm::base_from_tool(motion.target()).translation();
    EXPECT_LT((tool - from).cross((to - from).normalized()).norm(), 1e-9);
  }
  EXPECT_LT((arm::base_from_tool(motion.target()).translation() - to).norm(), 1e-9);
}

TEST(Motion, AStopEndsAtRestWithoutAJump) {
  Motion motion(limits());
  motion.start_at({0, 0.6, 1.9, 0});
  ASSERT_TRUE(motion.go(std::array{arm::JointVector(0.3, 1.2, 1.0, 1.0)}, 1.0));
  for (int i = 0; i < 300; ++i) motion.step(period_s);
  ASSERT_FALSE(motion.done());
  motion.stop();
  EXPECT_LE(run(motion), 1.001);
  EXPECT_GT((motion.target() - arm::JointVector(0.3, 1.2, 1.0, 1.0)).norm(), 0.1);  // it did stop on the way
}

TEST(Motion, TheSweepIsStrictlyAtConstantSpeedBetweenRunUpAndRunOut) {
  const PanelLayout layout;
  scan::SweepRequest request;
  request.base_from_panel = layout.nominal_base_from_panel();
  LaserCalibration laser;
  laser.tool_from_laser.translation() = Vec3(-0.090, 0, -0.365);
  Motion motion(limits());
  motion.start_at({0, 0.6, 1.9, 0});
  const scan::SweepPlan plan = scan::plan_sweep(request, laser);
  ASSERT_EQ(plan.outcome, scan::SweepOutcome::ok);
  ASSERT_TRUE(motion.plan_sweep(plan));
  ASSERT_TRUE(motion.go(std::array{motion.sweep_start_rad()}, 0.6));
  run(motion);
  ASSERT_TRUE(motion.sweep());
  int cruising = 0;
  while (!motion.done()) {
    const bool before = motion.cruising();
    const arm::JointVector q = motion.target();
    motion.step(period_s);
    if (!before || !motion.cruising()) continue;
    ++cruising;
    for (std::size_t i = 0; i < arm_joint_count; ++i) {
      EXPECT_NEAR((motion.target() - q)[static_cast<Eigen::Index>(i)] / period_s, plan.speed_rad_s[i], 1e-6);
    }
  }
  EXPECT_NEAR(cruising * period_s, plan.duration.s(), 0.02);
}

}  // namespace
}  // namespace lf::mission
