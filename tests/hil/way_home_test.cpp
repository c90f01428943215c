// A jaw that cannot let go, and a contact on the way back: the arm stops, and pulls at nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Step;
using safety::Fault;

bool failed_by(const Rig& rig, StepFailure failure) {
  return std::any_of(rig.events().begin(), rig.events().end(), [failure](const Event& event) {
    return event.kind == Event::Kind::fault && event.fault == Fault::step_failed && event.code == static_cast<std::int32_t>(failure);
  });
}

// The fingers stay where they are, but for what their pads give way by.
void jam(Rig& rig) {
  const double jaw_rad = angle_rad(rig, arm5e_joint::jaw);
  rig.block_jaw(jaw_rad - 0.001, jaw_rad + 0.001);
}

enum class When { turning, letting_go, leaving };
void PrintTo(When when, std::ostream* out) {
  *out << (when == When::turning ? "turning" : when == When::letting_go ? "letting go" : "leaving");
}

void bring_to(Rig& rig, When when) {
  ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
  rig.run_for(1);
  if (when == When::turning) return jam(rig);
  if (when == When::letting_go) {
    ASSERT_TRUE(rig.run_to(Step::let_go)) << rig.story();
    return jam(rig);
  }
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to(Step::abandon)) << rig.story();
  jam(rig);
}

class AJawThatDoesNotOpen : public testing::TestWithParam<When> {};

TEST_P(AJawThatDoesNotOpen, EndsTheWayHomeWithAStopAndNoPullOnTheHandle) {
  Rig rig(turn_only());
  rig.start();
  bring_to(rig, GetParam());
  const Vec3 tool_m = rig.world().base_from_tool().translation();
  const double pulled_before_n = rig.world().contacts().handle_force_n.norm();
  if (GetParam() == When::turning) {
    ASSERT_TRUE(give(rig, Command::abort));
  }
  double pulled_n = 0, moved_m = 0;
  for (int i = 0; i < 250 * 90 && !rig.outcome().ended; ++i) {
    rig.step();
    pulled_n = std::max(pulled_n, rig.world().contacts().handle_force_n.norm());
    moved_m = std::max(moved_m, (rig.world().base_from_tool().translation() - tool_m).norm());
  }
  rig.run_for(1);
  EXPECT_TRUE(rig.step_now() == Step::held || rig.step_now() == Step::stopped) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_TRUE(failed_by(rig, StepFailure::jaw_stuck)) << rig.story();
  EXPECT_LT(moved_m, 0.005) << "it went back with the handle in the jaw";
  EXPECT_LT(pulled_n, pulled_before_n + 20) << rig.story();
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_LT(arm::gap_from_jaw(test::jaw5e, angle_rad(rig, arm5e_joint::jaw)), PanelLayout{}.valves[0].handle_thickness_m + 0.002)
      << "it is not jammed on the handle";
}

INSTANTIATE_TEST_SUITE_P(WhereItJams, AJawThatDoesNotOpen, testing::Values(When::turning, When::letting_go, When::leaving));

double fastest_arm_joint_rad_s(const Rig& rig) {
  double fastest = 0;
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) fastest = std::max(fastest, std::abs(rig.world().readings()[i].velocity_rad_s));
  return fastest;
}

// Something gets between the fingers as they close on the way home: as thick as the bar, and thicker. The jaw opened while the arm moved, on a way that had been
// checked for a closed jaw.
TEST(WhatTheJawClosesOnOnTheWayHome, IsLetGoOfByAnArmAtRest) {
  const double widest_rad = test::arm5e.model().joints[4].upper_rad;
  for (const double thick_m : {PanelLayout{}.valves[0].handle_thickness_m, 0.025}) {
    SCOPED_TRACE(thick_m);
    Rig rig(turn_only());
    rig.start();
    ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
    ASSERT_TRUE(give(rig, Command::abort));
    ASSERT_TRUE(rig.run_to(Step::stow)) << rig.story();
    rig.block_jaw(arm::jaw_from_gap(test::jaw5e, thick_m), widest_rad);
    const double pads_m = 0.003;  // by which the pads may stand apart more than what they hold
    const double open_m = 0.04;   // well open: the jaw goes on to 0.0606
    double narrowest_m = 1, moved_before_rad_s = 0, opening_rad_s = 0;
    for (int i = 0; i < 250 * 90 && rig.step_now() == Step::stow; ++i) {
      rig.step();
      const double gap_m = arm::gap_from_jaw(test::jaw5e, angle_rad(rig, arm5e_joint::jaw));
      narrowest_m = std::min(narrowest_m, gap_m);
      const double speed_rad_s = fastest_arm_joint_rad_s(rig);
      if (narrowest_m > thick_m + pads_m) moved_before_rad_s = std::max(moved_before_rad_s, speed_rad_s);
      const bool opens = narrowest_m < thick_m + pads_m && gap_m > narrowest_m + 0.002 && gap_m < open_m;
      if (opens) opening_rad_s = std::max(opening_rad_s, speed_rad_s);
    }
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_LT(narrowest_m, thick_m + pads_m) << "the jaw did not close on it";
    EXPECT_GT(moved_before_rad_s, standing_rad_s) << "the arm did not move while the jaw closed";
    EXPECT_LT(opening_rad_s, standing_rad_s) << "the arm moves while the jaw opens";
    EXPECT_FALSE(rig.outcome().success) << rig.story();
    EXPECT_TRUE(failed_by(rig, StepFailure::jaw_not_closed)) << rig.story();
    EXPECT_GT(arm::gap_from_jaw(test::jaw5e, angle_rad(rig, arm5e_joint::jaw)), open_m) << "it still holds it";
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
      EXPECT_NEAR(rig.world().readings()[i].position_rad, mission::MissionConfig{}.park_rad[static_cast<Eigen::Index>(i)], 0.02)
          << "it is not at home: " << rig.story();
    }
    EXPECT_TRUE(rig.world().contacts().unintended.empty());
  }
}

// It comes from the wrist's left, 0.6 s after it is sent: on the first 11 mm the load of the press is let off, and nothing is told from that.
TEST(AContactOnTheWayBackFromAPress, StopsTheArmAndIsNamed) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::button_back)) << rig.story();
  rig.run_for(0.6);
  rig.push_obstacle();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  rig.run_for(1);
  EXPECT_FALSE(rig.outcome().success) << rig.story();
  EXPECT_TRUE(failed_by(rig, StepFailure::touched_on_the_way_back)) << rig.story();
  EXPECT_FALSE(rig.world().contacts().unintended.empty()) << "nothing was touched";
  EXPECT_LT(rig.world().contacts().peak_force_n, 150) << rig.story();
  EXPECT_EQ(rig.world().button(1).presses, 1u);
}

struct Push {
  Step step;
  double after_s;
};
void PrintTo(const Push& push, std::ostream* out) { *out << mission::row(push.step).name << " + " << push.after_s << " s"; }

// The press learns free motion anew when it has come to its speed, after 0.4 s, and finds what pushes by then. Where the operator gave a hold just then, the
// finding was lost, and the press went on against the push.
TEST(APushThatAPressFindsOnHold, IsNotForgotten) {
  for (const char* torque_nm : {"8", "20"}) {
    for (const double hold_s : {0.42, 0.46, 0.50}) {
      SCOPED_TRACE(testing::Message() << torque_nm << " N m, hold after " << hold_s << " s");
      std::vector<std::string> scenario = press_only();
      scenario.push_back(std::string("mission.press_torque_nm=") + torque_nm);
      Rig rig(scenario);
      rig.start();
      ASSERT_TRUE(rig.run_to(Step::press)) << rig.story();
      rig.push_obstacle();
      rig.run_for(hold_s);
      ASSERT_FALSE(rig.outcome().ended) << rig.story();
      ASSERT_TRUE(give(rig, Command::hold));
      rig.run_for(3);
      EXPECT_EQ(rig.count(Fault::unexpected_contact), 1u) << rig.story();
      EXPECT_FALSE(rig.world().contacts().unintended.empty()) << "nothing was touched";
      if (!rig.outcome().ended) (void)give(rig, Command::resume);
      ASSERT_TRUE(rig.run_to_end()) << rig.story();
      EXPECT_FALSE(rig.outcome().success) << rig.story();
      EXPECT_EQ(rig.world().button(1).presses, 0u) << rig.story();
      EXPECT_LT(rig.world().contacts().peak_force_n, 150) << rig.story();
    }
  }
}

// A next try went the same way, what floats gave way to it, and the job ended in success.
class APushFromTheSide : public testing::TestWithParam<Push> {};

TEST_P(APushFromTheSide, EndsTheJobWhereTheArmIs) {
  const bool presses = GetParam().step == Step::press;
  Rig rig(presses ? press_only() : turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(GetParam().step)) << rig.story();
  rig.run_for(GetParam().after_s);
  rig.push_obstacle();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  const Vec3 tool_m = rig.world().base_from_tool().translation();
  EXPECT_EQ(rig.step_now(), Step::held) << rig.story();
  EXPECT_EQ(rig.outcome().step, GetParam().step) << "it went on: " << rig.story();
  rig.run_for(3);
  EXPECT_FALSE(rig.outcome().success) << rig.story();
  EXPECT_FALSE(rig.world().contacts().unintended.empty()) << "nothing was touched";
  EXPECT_LT((rig.world().base_from_tool().translation() - tool_m).norm(), 0.02)
      << "it goes on against what it has touched: " << rig.story();
  EXPECT_LT(rig.world().contacts().peak_force_n, 150) << rig.story();
}

INSTANTIATE_TEST_SUITE_P(Steps, APushFromTheSide,
                         testing::Values(Push{Step::advance, 0.1}, Push{Step::advance, 0.6}, Push{Step::press, 0.05},
                                         Push{Step::press, 0.2}));

}  // namespace
}  // namespace lf::test
