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
  joint.holding_torque_nm = 15, joint.effort_nm = 12, joint.rated_torque_nm = 6, joint.friction.coulomb_share = 0.05;
  JointDriveChoice choice;
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 15);
  choice.holding = "brake";
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 18);
  choice.holding = "nothing";
  EXPECT_DOUBLE_EQ(held_nm(joint, choice), 0.3);
}

TEST(Holding, WhatSinksIsNamedWithItsWeight) {
  const ArmDescription arm = arm5e();
  Drives drives;
  EXPECT_THAT(holding_notes(arm, holding_of(arm, drives)), IsEmpty());
  drives.joints[1].holding = "nothing";
  ArmDescription oiled = arm;
  oiled.joints[1].friction.coulomb_share = 0.01;
  const std::vector<Holding> joints = holding_of(oiled, drives);
  EXPECT_FALSE(joints[1].holds());
  EXPECT_THAT(holding_notes(oiled, joints),
              ElementsAre(testing::AllOf(HasSubstr("shoulder (nothing but friction, 0.3 N m, the arm's weight takes"),
                                         HasSubstr("drives.<joint>.holding"))));
}

}  // namespace
}  // namespace lf::config
