#include "firmware/mission/bar_turn.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/arm/inverse_kinematics.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::mission {
namespace {

struct Grasp {
  arm::JointVector q;
  Mat3 base_from_panel;
};

// Holding the nominal handle at `handle_rad`, so that it can be turned by up to 130 degrees.
Grasp grasp(double handle_rad, double turn_rad) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const Vec3 centre = base_from_panel * Vec3(0, 0, layout.handle_height_m);
  const arm::IkResult ik = arm::inverse_kinematics(centre, 0);
  EXPECT_TRUE(ik.ok());
  const Vec3 bar = base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  const auto rolls = arm::rolls_for_bar(ik.q_rad, bar);
  EXPECT_TRUE(rolls.has_value());
  const auto roll = arm::roll_for_turn(*rolls, -turn_rad);
  EXPECT_TRUE(roll.has_value());
  arm::JointVector q = ik.q_rad;
  q[3] = *roll;
  return {q, base_from_panel.linear()};
}

TEST(BarTurn, KeepsTheClosingDirectionAcrossTheBarAllTheWay) {
  const Grasp start = grasp(-0.5, 2.0);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(start.q, start.base_from_panel, -0.5, 1.5, {}, -pi, pi));
  for (double t = 0; t <= turn.duration_s() + 0.1; t += 0.02) {
    const arm::JointVector q = turn.sample(t);
    const double handle = turn.handle_rad(t);
    const Vec3 bar = start.base_from_panel * Vec3(-std::sin(handle), std::cos(handle), 0);
    EXPECT_NEAR(arm::base_from_tool(q).linear().col(0).dot(bar), 0, 1e-9) << "at " << t << " s";
  }
}

TEST(BarTurn, EndsAtTheAngleAndTheOtherJointsStay) {
  const Grasp start = grasp(0.3, 1.2);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(start.q, start.base_from_panel, 0.3, 1.5, {}, -pi, pi));
  const arm::JointVector end = turn.sample(turn.duration_s());
  EXPECT_NEAR(turn.handle_rad(turn.duration_s()), 1.5, 1e-12);
  EXPECT_EQ(end.head<3>(), start.q.head<3>());
}

// The wrist's turn differs from the handle's as over a universal joint: tan(wrist) = tan(handle) cos(tilt) or its inverse, so at 8 degrees of tilt by
// at most half of sin^2(tilt / 2) x 2, which is 0.28 degrees each way.
TEST(BarTurn, FollowsTheUniversalJointNotTheProportion) {
  const Grasp start = grasp(0, 1.5);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(start.q, start.base_from_panel, 0, 1.5, {}, -pi, pi));
  double worst = 0;
  for (double t = 0; t <= turn.duration_s(); t += 0.02) {
    const double wrist = std::abs(turn.sample(t)[3] - start.q[3]);
    worst = std::max(worst, std::abs(wrist - turn.handle_rad(t)));
  }
  EXPECT_LT(deg_from_rad(worst), 1.2);
  EXPECT_GT(deg_from_rad(worst), 0.1);
}

TEST(BarTurn, RefusesATurnThatLeavesTheWristsLimits) {
  const Grasp start = grasp(0, 1.5);
  BarTurn turn;
  EXPECT_FALSE(turn.plan(start.q, start.base_from_panel, 0, 1.5, {}, start.q[3] - 0.5, start.q[3] + 0.5));
}

}  // namespace
}  // namespace lf::mission
