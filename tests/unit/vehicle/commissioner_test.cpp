// What a commissioning tells of what it has found.
#include "hal/vehicle/commissioner.hpp"

#include <gtest/gtest.h>

#include "hal/vehicle/operator_client.hpp"

namespace lf::hal {
namespace {

TEST(Commissioned, TheFrictionOfEachJointIsToldWithItsResidual) {
  config::HomingOffsets offsets;
  offsets.friction_known[2] = true;
  offsets.friction[2] = {2.5, 0.0125, 0.25};
  const Json friction = friction_json(offsets);
  EXPECT_EQ(friction, Json::parse(R"({"elbow": {"coulomb_mnm": 2.5, "viscous_mnm_s": 0.0125, "rms_mnm": 0.25}})"));

  const Json done{{"state", "done"}, {"zeros", {{"elbow", -37}, {"jaw", 0}}}, {"friction", friction}};
  EXPECT_EQ(commissioning_text(done),
            "elbow     zero at -37 counts; friction 2.5 mN m and 0.0125 mN m per rad/s at the motor, residual 0.25 mN m\n"
            "jaw       zero at 0 counts; friction not measured: as the arm's description has it\n");
}

TEST(Commissioned, AJointThatSomethingRubsAgainstIsLeftOutAndTheOthersAreTakenOver) {
  std::array<Motor, joint_count> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known[1] = true;
  offsets.zero_counts[1] = 11;
  Commissioned commissioned;
  commissioned.found = {true, true, false, true, false};
  commissioned.zero_counts = {5, 6, 7, 8, 9};
  commissioned.friction_found = {true, true, true, false, false};
  commissioned.friction = {{{1, 1e-3, 0.1}, {100, 1e-3, 0.1}, {1, 1e-3, 0.1}, {}, {}}};
  commissioned.how = "in the jig";
  const std::vector<std::string> left_out = take_over(commissioned, motors, offsets);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_NE(left_out[0].find("'shoulder.coulomb_mnm' is 100"), std::string::npos) << left_out[0];
  EXPECT_EQ(offsets.known, (std::array<bool, joint_count>{true, false, false, true, false})) << "the old zero may be as wrong";
  EXPECT_EQ(offsets.zero_counts[0], 5);
  EXPECT_EQ(offsets.zero_counts[3], 8);
  EXPECT_EQ(offsets.friction_known, (std::array<bool, joint_count>{true, false, false, false, false}));
  EXPECT_EQ(offsets.friction[0].coulomb_mnm, 1);
}

// In a jig no friction is measured: that of the file is forgotten when it cannot be, and does not take the power again.
TEST(Commissioned, AZeroOfAJigHealsAJointWhoseFileHasAFrictionThatCannotBe) {
  std::array<Motor, joint_count> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known = offsets.friction_known = {true, true, false, false, false};
  offsets.friction = {{{1, 1e-3, 0.1}, {100, 1e-3, 0.1}, {}, {}, {}}};
  Commissioned commissioned;
  commissioned.found = {true, true, false, false, false};
  EXPECT_TRUE(take_over(commissioned, motors, offsets).empty());
  EXPECT_EQ(offsets.friction_known, (std::array<bool, joint_count>{true, false, false, false, false}));
  EXPECT_TRUE(config::leave_out_doubtful(offsets, motors).empty());
  EXPECT_TRUE(offsets.known[1]);
}

TEST(HomingFile, JointsWhoseFrictionCannotBeTakeNoPower) {
  std::array<Motor, joint_count> motors;
  for (Motor& motor : motors) motor.coulomb_nm = 1e-3, motor.viscous_nm_s = 1e-6;
  config::HomingOffsets offsets;
  offsets.known.fill(true);
  offsets.friction_known = {true, true, false, false, false};
  offsets.friction = {{{1, 1e-3, 0.1}, {1, 1, 0.1}, {100, 1, 0.1}, {}, {}}};
  const std::vector<std::string> left_out = config::leave_out_doubtful(offsets, motors);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_NE(left_out[0].find("'shoulder.viscous_mnm_s' is 1"), std::string::npos) << left_out[0];
  EXPECT_EQ(offsets.known, (std::array<bool, joint_count>{true, false, true, true, true})) << "what was not measured is not judged";
}

}  // namespace
}  // namespace lf::hal
