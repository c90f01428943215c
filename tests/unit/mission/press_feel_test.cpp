// When a press is said to have met the bottom, and how hard it may push: of the default arm, of a stronger one, of one with small levers.
#include <gtest/gtest.h>

#include <limits>

#include "firmware/mission/workbench.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "tests/arm5e.hpp"

namespace lf::mission {
namespace {

// Torques that are far from any joint's limit, so that `contact_nm` counts.
safety::Limits limits_of(double contact_nm) {
  safety::Limits limits;
  limits.max_contact_torque_nm = contact_nm;
  for (std::size_t i = 0; i < capacity::joints; ++i) {
    safety::JointLimit joint;
    joint.max_torque_nm = 1000;
    (void)limits.joints.push_back(joint);
  }
  return limits;
}

TEST(BottomTorques, AreTheKeysForTheDefaultArmAndForAWeakerOne) {
  for (const double press_nm : {2.0, 7.0, 20.0}) {
    for (const double contact_nm : {6.0, 13.0}) {
      const arm::JointVector bottom = bottom_torques_nm(test::arm5e, limits_of(contact_nm), press_nm);
      for (std::size_t i = 0; i < test::arm5e.arm_joints(); ++i) EXPECT_EQ(bottom[static_cast<Eigen::Index>(i)], press_nm) << i;
    }
  }
}

// 50 N m of contact are 50/13 of the default's; the roll has no part in a press.
TEST(BottomTorques, AreThreeThirteenthsOfAStrongArmsContactAtLeast) {
  const arm::JointVector bottom = bottom_torques_nm(test::arm5e, limits_of(50), 7);
  for (const Eigen::Index i : {0, 1, 2}) EXPECT_NEAR(bottom[i], 3 * 50.0 / 13, 1e-12) << i;
  EXPECT_EQ(bottom[3], 7);
  EXPECT_EQ(bottom_torques_nm(test::arm5e, limits_of(50), 18)[0], 18) << "the key asks for more";
  const arm::Arm predator(make_model(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/predator/predator.urdf")));
  const arm::JointVector all = bottom_torques_nm(predator, limits_of(50), 7);
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(all[i], 3 * 50.0 / 13, 1e-12) << i << ", none of which rolls";
}

TEST(PressPush, IsLessTheMoreItTakesToBeFelt) {
  EXPECT_EQ(press_push_n(0), usual_push_n);
  EXPECT_EQ(press_push_n(most_press_n - usual_push_n), usual_push_n);
  EXPECT_EQ(press_push_n(50), most_press_n - 50);
  EXPECT_EQ(press_push_n(300), least_push_n);
  EXPECT_EQ(press_push_n(std::numeric_limits<double>::infinity()), least_push_n);
}

}  // namespace
}  // namespace lf::mission
