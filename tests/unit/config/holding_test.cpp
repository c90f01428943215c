#include "hal/config/holding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hal/config/share.hpp"

namespace lf::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ArmDescription arm5e() { return load_arm_urdf((share_folder() / "arm/arm5e.urdf").string()); }

// The elbow's load is largest where the sum of weight times lever lies level: by hand, of the URDF's figures. The fingers' own swing is within the tolerance.
TEST(Holding, TheElbowsLoadIsThatOfALevelForearm) {
  const double yaw = 1.972222, tool_x = std::sin(yaw), tool_y = -std::cos(yaw);
  const double forearm_n = 3.0, wrist_n = 1.0, fingers_n = 1.0, wrist_m = 0.02, fingers_m = 0.045 + 0.06;
  const double x = forearm_n * 0.165048 + (wrist_n + fingers_n) * 0.349149 + (wrist_n * wrist_m + fingers_n * fingers_m) * tool_x;
  const double y = forearm_n * -0.020109 + (wrist_n + fingers_n) * 0.058037 + (wrist_n * wrist_m + fingers_n * fingers_m) * tool_y;
  const std::vector<double> most_nm = weight_torques_nm(arm5e());
  ASSERT_EQ(most_nm.size(), 5u);
  EXPECT_NEAR(most_nm[2] / std::hypot(x, y), 1, 0.03);
}

TEST(Holding, AnUprightAxisCarriesNoWeight) { EXPECT_NEAR(weight_torques_nm(arm5e())[0], 0, 1e-12); }

TEST(Holding, TheLoadGrowsTowardTheBase) {
  const std::vector<double> most_nm = weight_torques_nm(arm5e());
  EXPECT_GT(most_nm[1], most_nm[2]);
  EXPECT_GT(most_nm[2], most_nm[3]);
}

TEST(Holding, AGearABrakeOrFriction) {
  ArmJoint joint;
  joint.lower_rad = -1, joint.upper_rad = 1, joint.actuator.counts_per_rad = 5000;
  joint.holding_torque_nm = 15, joint.effort_nm = 12, joint.rated_torque_nm = 6, joint.friction.coulomb_share = 0.05;
  JointDriveChoice choice;
  choice.counts_per_rev = 64;
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 15);
  choice.holding = "brake";
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 18);
  choice.holding = "nothing";
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 0.3);
}

// The elbow's screw between pivots a and b: its lever is a b sin(angle) / length, by the law of cosines.
TEST(Holding, AScrewsFrictionHoldsLeastWhereItsLeverIsShort) {
  const ArmDescription arm = arm5e();
  const ArmJoint& elbow = arm.joints[2];
  double least = 1e9, most = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double between = elbow.lower_rad + (elbow.upper_rad - elbow.lower_rad) * i / 1000 + elbow.actuator.offset_rad;
    const double a = elbow.actuator.pivot_a_m, b = elbow.actuator.pivot_b_m;
    const double lever = std::abs(a * b * std::sin(between) / std::sqrt(a * a + b * b - 2 * a * b * std::cos(between)));
    least = std::min(least, lever), most = std::max(most, lever);
  }
  ASSERT_LT(least, 0.5 * most);
  Drives drives;
  JointDriveChoice choice = drive_of(drives, 2);
  choice.holding = "nothing";
  EXPECT_NEAR(held_nm(elbow, choice), 0.06 * 30 * least / most, 0.01);
}

TEST(Holding, WhatSinksIsNamedWithItsWeight) {
  const ArmDescription arm = arm5e();
  Drives drives;
  EXPECT_THAT(holding_notes(arm, holding_of(arm, drives)), IsEmpty());
  drives.joints[1].holding = "nothing";
  const std::vector<Holding> joints = holding_of(arm, drives);
  EXPECT_FALSE(joints[1].holds());
  EXPECT_TRUE(joints[2].holds());
  EXPECT_THAT(holding_notes(arm, joints),
              ElementsAre(testing::AllOf(HasSubstr("shoulder (nothing but friction, "), HasSubstr("the hand empty"),
                                         HasSubstr("drives.<joint>.holding"), testing::Not(HasSubstr("elbow")))));
  // Less than half as much again is not enough: a load in the hand comes on top.
  EXPECT_FALSE((Holding{"gear", 14.9, 10}).holds());
  EXPECT_TRUE((Holding{"gear", 15.1, 10}).holds());
  EXPECT_EQ((Holding{"gear", 0, 10}).text(), "nothing holds it");
}

}  // namespace
}  // namespace lf::config
