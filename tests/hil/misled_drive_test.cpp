// A drive begins to mislead in a step in which its joint bears a load: what follows is named after its joint, and no drive keeps its power for a
// contact that is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Step;

struct Misled {
  const char* name;
  std::vector<std::string> (*task)();
  Step step;
  double into;        // of the step
  const char* fault;  // as a scenario has it, without its time
  std::size_t joint;
};
void PrintTo(const Misled& misled, std::ostream* out) { *out << misled.name; }

class MisledDriveUnderALoad : public testing::TestWithParam<Misled> {};

TEST_P(MisledDriveUnderALoad, IsNamedAndEndsWithoutPower) {
  const Misled& misled = GetParam();
  double at_s = 0;
  {
    Rig rehearsal(misled.task());
    rehearsal.start();
    ASSERT_TRUE(rehearsal.run_to(misled.step)) << rehearsal.story();
    const double began_s = rehearsal.now().s();
    while (rehearsal.step_now() == misled.step) rehearsal.step();
    at_s = began_s + misled.into * (rehearsal.now().s() - began_s);
  }
  std::vector<std::string> overrides = misled.task();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", " + misled.fault + "}]");
  Rig rig(overrides);
  rig.start();
  while (rig.now().s() < at_s) rig.step();
  const auto joint = static_cast<std::size_t>(misled.joint);
  const auto angle_rad = [&] { return rig.world().readings()[joint].position_rad; };
  const double from_rad = angle_rad();
  double gone_rad = 0;
  while (!rig.outcome().ended && rig.now().s() < at_s + 60) {
    rig.step();
    gone_rad = std::max(gone_rad, std::abs(angle_rad() - from_rad));
  }
  // A roll may turn in its place up to its stop (docs/safety.md): 1.5 rad were seen.
  const double farthest_rad = misled.joint == arm5e_joint::roll ? 2 : 0.5;
  EXPECT_LT(gone_rad, farthest_rad) << "it went on unseen";
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_EQ(rig.outcome().fault, safety::Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(misled.joint)) << rig.story();
  rig.run_for(1.5);
  EXPECT_FALSE(rig.any_power()) << rig.story();
}

INSTANTIATE_TEST_SUITE_P(All, MisledDriveUnderALoad,
                         testing::Values(Misled{"SlewEncoderStuckAfterTheAdvance", turn_only, Step::advance, 0.97,
                                                "kind: stuck_encoder, node: slew", arm5e_joint::slew},
                                         Misled{"RollEncoderStuckInTheTurn", turn_only, Step::turn, 0.8, "kind: stuck_encoder, node: roll",
                                                arm5e_joint::roll},
                                         Misled{"ShoulderSeizesAfterTheTurn", turn_only, Step::turn, 0.9, "kind: following, node: shoulder",
                                                arm5e_joint::shoulder},
                                         Misled{"ShoulderEncoderStuckAfterThePress", press_only, Step::press, 0.9,
                                                "kind: stuck_encoder, node: shoulder", arm5e_joint::shoulder}),
                         [](const testing::TestParamInfo<Misled>& test) { return std::string(test.param.name); });

// The shoulder has been blind for 0.2 s when the elbow's torque rises, as if the shoulder had driven the arm into something.
TEST(MisledDrive, OfAnotherJointThanTheOneThatFeelsIsNamed) {
  std::vector<std::string> overrides = turn_only();
  overrides.emplace_back(
      "faults=[{at_step: deploy, after_s: 1, kind: stuck_encoder, node: shoulder}, {at_step: deploy, after_s: 1.2, kind: torque_high, "
      "node: elbow}]");
  Rig rig(overrides);
  rig.start();
  (void)rig.run_to_end();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(arm5e_joint::shoulder)) << rig.story();
  rig.run_for(1.5);
  EXPECT_FALSE(rig.any_power()) << rig.story();
}

// What the arm felt is explained by a joint that does not follow on the way to the parking pose. The task's result keeps what was felt.
TEST(MisledDrive, OnTheWayToTheParkingPoseExplainsWhatWasFelt) {
  std::vector<std::string> overrides = press_only();
  overrides.emplace_back("buttons.stuck=[centre]");
  Rig felt(overrides);
  felt.start();
  (void)felt.run_to_end();
  ASSERT_EQ(felt.outcome().fault, safety::Fault::step_failed) << felt.story();
  ASSERT_EQ(felt.outcome().code, static_cast<std::int32_t>(StepFailure::button_stuck)) << felt.story();
  overrides.emplace_back("faults=[{at_step: stow, after_s: 0.5, kind: stuck_encoder, node: elbow}]");
  Rig rig(overrides);
  rig.start();
  (void)rig.run_to_end();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(arm5e_joint::elbow)) << rig.story();
  EXPECT_EQ(rig.outcome().step, Step::stow) << rig.story();
}

}  // namespace
}  // namespace lf::test
