#include "firmware/mission/bar_turn.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/arm/inverse_kinematics.hpp"
#include "shared/panel/panel_layout.hpp"
#include "tests/arm5e.hpp"

namespace lf::mission {
namespace {

struct Grasp {
  arm::JointVector q = arm::JointVector::Zero();
  Mat3 base_from_panel;
};

// Holding the nominal handle at `handle_rad`, so that it can be turned by up to 130 degrees.
Grasp grasp(double handle_rad, double turn_rad) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const Vec3 centre = base_from_panel * Vec3(0, 0, layout.valves[0].handle_height_m);
  const arm::IkResult ik = arm::inverse_kinematics(test::arm5e, centre, 0);
  EXPECT_TRUE(ik.ok());
  const Vec3 bar = base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  const auto rolls = arm::rolls_for_bar(test::arm5e, ik.q_rad, bar);
  EXPECT_TRUE(rolls.has_value());
  const auto roll = arm::roll_for_turn(*rolls, -turn_rad, -pi + arm::default_limit_margin_rad, pi - arm::default_limit_margin_rad);
  EXPECT_TRUE(roll.has_value());
  arm::JointVector q = ik.q_rad;
  q[3] = *roll;
  return {q, base_from_panel.linear()};
}

TEST(BarTurn, KeepsTheClosingDirectionAcrossTheBarAllTheWay) {
  const Grasp start = grasp(-0.5, 2.0);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(test::arm5e, start.q, start.base_from_panel, -0.5, 1.5, {}, -pi, pi));
  for (double t = 0; t <= turn.duration_s() + 0.1; t += 0.02) {
    const arm::JointVector q = turn.sample(t);
    const double handle = turn.handle_rad(t);
    const Vec3 bar = start.base_from_panel * Vec3(-std::sin(handle), std::cos(handle), 0);
    EXPECT_NEAR(test::arm5e.base_from_tool(q).linear().col(0).dot(bar), 0, 1e-9) << "at " << t << " s";
  }
}

TEST(BarTurn, EndsAtTheAngleAndTheOtherJointsStay) {
  const Grasp start = grasp(0.3, 1.2);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(test::arm5e, start.q, start.base_from_panel, 0.3, 1.5, {}, -pi, pi));
  const arm::JointVector end = turn.sample(turn.duration_s());
  EXPECT_NEAR(turn.handle_rad(turn.duration_s()), 1.5, 1e-12);
  EXPECT_EQ(end.head<3>(), start.q.head<3>());
}

// Seen along the tool's axis, the bar turns by another angle than about the panel's normal, as over a universal joint. The wrist follows what is seen there:
// the angle between the bar's projections on the plane across the tool.
TEST(BarTurn, FollowsTheUniversalJointNotTheProportion) {
  const Grasp start = grasp(0, 1.5);
  BarTurn turn;
  ASSERT_TRUE(turn.plan(test::arm5e, start.q, start.base_from_panel, 0, 1.5, {}, -pi, pi));
  const Vec3 tool = test::arm5e.base_from_tool(start.q).linear().col(2);
  const auto seen = [&](double handle) {
    const Vec3 bar = start.base_from_panel * Vec3(-std::sin(handle), std::cos(handle), 0);
    return Vec3(bar - tool * tool.dot(bar));
  };
  double most = 0;
  int samples = 0;
  for (double t = 0; t <= turn.duration_s(); t += 0.02, ++samples) {
    const double wrist = turn.sample(t)[3] - start.q[3], handle = turn.handle_rad(t);
    const Vec3 from = seen(0), to = seen(handle);
    EXPECT_NEAR(wrist, std::atan2(tool.dot(from.cross(to)), from.dot(to)), 1e-9) << "at " << t << " s";
    most = std::max(most, std::abs(std::abs(wrist) - handle));
  }
  EXPECT_GT(samples, 20);
  // tan(wrist) = tan(handle) / cos(tilt) parts from the proportion by asin((1 - cos tilt) / (1 + cos tilt)) at most, and reaches it between 0 and 90 degrees.
  const double cos_tilt = std::abs(tool.dot(start.base_from_panel.col(2)));
  EXPECT_LE(most, std::asin((1 - cos_tilt) / (1 + cos_tilt)) + 1e-9);
  EXPECT_GT(most, 0.5 * std::asin((1 - cos_tilt) / (1 + cos_tilt)));
}

TEST(BarTurn, RefusesATurnThatLeavesTheWristsLimits) {
  const Grasp start = grasp(0, 1.5);
  BarTurn turn;
  EXPECT_FALSE(turn.plan(test::arm5e, start.q, start.base_from_panel, 0, 1.5, {}, start.q[3] - 0.5, start.q[3] + 0.5));
}

}  // namespace
}  // namespace lf::mission
