// Buttons that work, that are stuck, and that are gone: what the core finds, and what is true.
#include <gtest/gtest.h>

#include <string>

#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Step;

const mission::TaskResult& result(Rig& rig) { return rig.mission().tasks()[0]; }

class AButton : public testing::TestWithParam<const char*> {};

std::size_t index_of(const std::string& button) { return button == "left" ? 0 : button == "centre" ? 1 : 2; }
std::vector<std::string> press(const std::string& button) { return {"tasks=[{press_buttons: {order: [" + button + "]}}]"}; }

TEST_P(AButton, ThatWorksGoesInByItsStroke) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Rig rig(press(GetParam()), seed);
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(rig.outcome().success) << "seed " << seed << ": " << rig.story();
    EXPECT_EQ(rig.world().button(index_of(GetParam())).presses, 1u) << rig.story();
    EXPECT_EQ(result(rig).presses, 1u);
    EXPECT_NEAR(result(rig).travel_m, PanelLayout{}.buttons[0].stroke_m, 0.0015) << "seed " << seed;
    EXPECT_EQ(result(rig).failure, StepFailure::none);
    EXPECT_TRUE(result(rig).face_felt);
    EXPECT_NEAR(result(rig).face_off_m, 0, 0.0036) << "seed " << seed;
  }
}

// The panel is not where the look said that it is, by as much as a camera whose principal point is off puts it. The arm's own error is in both presses.
TEST(AButtonThatIsSeenAtAWrongDistance, IsFeltWhereItIs) {
  const auto felt_m = [](double deeper_m) {
    Rig rig(press("centre"), 1, {}, [&](hal::SimConfig& truth) {
      truth.world.base_from_panel.translation() -= deeper_m * truth.world.base_from_panel.linear().col(2);
    });
    rig.start();
    EXPECT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(result(rig).face_felt) << rig.story();
    return result(rig).face_off_m;
  };
  EXPECT_NEAR(felt_m(0.004) - felt_m(-0.004), 0.008, 0.0005);
}

int clicks_felt(const char* drop_n, std::uint64_t seeds) {
  int felt = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Rig rig({"tasks=[{press_buttons: {order: [left, centre, right]}}]", std::string("buttons.click_drop_n=") + drop_n}, seed);
    rig.start();
    EXPECT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(rig.outcome().success) << rig.story();
    for (const mission::TaskResult& one : rig.mission().tasks()) felt += one.click_felt ? 1 : 0;
  }
  return felt;
}

// Through screws that rub, the default's 3 N are seldom felt; a hard click is, and of a button that does not click none ever is.
TEST(AClick, ThatIsFeltIsOne) {
  EXPECT_GE(clicks_felt("8", 2), 2);
  EXPECT_EQ(clicks_felt("0", 3), 0);
}

// A long spring pushes the finger on most of its way back. That was taken for a contact: the arm stopped, swayed in by a millimetre, and the button
// clicked again.
TEST(AButtonOfALongStroke, ClicksOnceAndIsNoContactOnTheWayBack) {
  for (const std::uint64_t seed : {170, 171, 172}) {
    std::vector<std::string> scenario = press("left");
    for (const char* set :
         {"mission.press_speed_m_s=0.04146", "physics.drag_coefficient=1.88", "mounting.joints_deg=-0.1497", "mounting.marker_m=-0.001846",
          "mission.docking_rad=0.02264", "panel.button_stroke_m=0.01245", "panel.button_height_m=0.032"}) {
      scenario.emplace_back(set);
    }
    Rig rig(scenario, seed);
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(rig.outcome().success) << rig.story();
    EXPECT_EQ(rig.world().button(0).presses, 1u) << "seed " << seed << ": " << rig.story();
    EXPECT_EQ(rig.count(safety::Fault::step_failed), 0u) << "seed " << seed << ": " << rig.story();
  }
}

// Docked at a corner of what is accepted, the hand comes tilted by 19 degrees, and its broad side is too near to the panel: seed 129 of the default mission
// pressed nothing. The next try comes with the hand turned.
class ADockingCorner : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<std::string> corner(std::vector<std::string> scenario) {
    const bool left = GetParam() == std::string("left");
    for (const char* set : {"docking.x_m=-0.02", "docking.z_m=-0.02", "docking.roll_deg=-2", "docking.pitch_deg=-2"})
      scenario.emplace_back(set);
    scenario.emplace_back(left ? "docking.y_m=-0.02" : "docking.y_m=0.02");
    scenario.emplace_back(left ? "docking.yaw_deg=2" : "docking.yaw_deg=-2");
    return scenario;
  }
  static void expect_pressed(Rig& rig, std::uint32_t barred) {
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(rig.outcome().success) << rig.story();
    EXPECT_EQ(rig.world().button(index_of(GetParam())).presses, 1u) << rig.story();
    EXPECT_TRUE(rig.world().contacts().unintended.empty());
    EXPECT_LT(rig.world().contacts().peak_force_n, 150);
    EXPECT_EQ(rig.count(safety::Fault::step_failed), barred) << "the corner is no longer one: " << rig.story();
  }
};

TEST_P(ADockingCorner, IsNoReasonNotToPress) {
  Rig rig(corner({std::string("tasks=[{press_buttons: {order: [") + GetParam() + ", centre]}}]"}), 1);
  expect_pressed(rig, 1);
  EXPECT_EQ(rig.world().button(1).presses, 1u);
}

// Its limits leave the other way.
TEST_P(ADockingCorner, IsNoneWithARollThatTurnsOneWay) {
  Rig rig(corner(press(GetParam())), 1, [](ControllerConfig& told) { told.mission_limits.joints[3].max_rad = 1.2; });
  expect_pressed(rig, 1);
}

TEST_P(ADockingCorner, IsSaidToBeOneWithARollThatDoesNotTurn) {
  Rig rig(corner(press(GetParam())), 1, [](ControllerConfig& told) {
    told.mission_limits.joints[3].min_rad = -1.2;
    told.mission_limits.joints[3].max_rad = 1.2;
  });
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::panel_in_the_way)) << rig.story();
  EXPECT_EQ(rig.count(safety::Fault::step_failed), 2u) << "nothing is tried twice: " << rig.story();
}

TEST_P(ADockingCorner, OfAStuckButtonIsOneOfAStuckButton) {
  std::vector<std::string> scenario = corner(press(GetParam()));
  scenario.push_back(std::string("buttons.stuck=[") + GetParam() + "]");
  Rig rig(scenario, 1);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::button_stuck)) << rig.story();
  EXPECT_EQ(result(rig).presses, 0u);
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
  EXPECT_LT(rig.world().contacts().peak_force_n, 150);
}

INSTANTIATE_TEST_SUITE_P(OfTwo, ADockingCorner, testing::Values("left", "right"), [](const auto& one) { return std::string(one.param); });

// A stop along its ramp wound the arm up against the bottom: 155 N, and an overload where the torque that says bottom was set high.
TEST(APress, StopsWhereItFindsTheBottom) {
  for (const char* torque_nm : {"4", "7", "14.94", "20"}) {
    SCOPED_TRACE(torque_nm);
    std::vector<std::string> scenario = press("centre");
    scenario.push_back(std::string("mission.press_torque_nm=") + torque_nm);
    Rig rig(scenario, 57);
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_TRUE(rig.outcome().success) << rig.story();
    EXPECT_EQ(rig.world().button(1).presses, 1u) << rig.story();
    EXPECT_LT(rig.world().contacts().peak_force_n, 140);
  }
}

// After a valve the jaw closes for the second look. Something gets between the fingers there: as thick as the bar it looks held, thicker it jams them.
TEST(APress, IsNotBegunWithSomethingBetweenTheFingers) {
  const double widest_rad = test::arm5e.model().joints[4].upper_rad;
  for (const double thick_m : {PanelLayout{}.valves[0].handle_thickness_m, 0.025}) {
    Rig rig({"tasks=[{turn_valve: {to_deg: 90}}, {press_buttons: {order: [left]}}]"});
    rig.start();
    ASSERT_TRUE(rig.run_to(Step::back_off)) << rig.story();
    rig.block_jaw(arm::jaw_from_gap(test::jaw5e, thick_m), widest_rad);
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_FALSE(rig.outcome().success) << rig.story();
    EXPECT_EQ(rig.outcome().step, Step::verify_reach) << rig.story();
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::jaw_not_closed)) << thick_m << " m: " << rig.story();
    EXPECT_EQ(rig.world().button(0).presses, 0u);
    EXPECT_EQ(rig.world().button(0).depth_m, 0) << "it was touched";
    EXPECT_TRUE(rig.world().contacts().unintended.empty());
  }
}

// A job without a press has no step after the second look that needs closed fingers. Without power the jaw's screw would go on squeezing what is there.
TEST(AValve, IsNoSuccessWithSomethingBetweenTheFingers) {
  Rig rig({"tasks=[{turn_valve: {to_deg: 90}}]"});
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::back_off)) << rig.story();
  rig.block_jaw(arm::jaw_from_gap(test::jaw5e, 0.025), test::arm5e.model().joints[4].upper_rad);
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  rig.run_for(1);
  EXPECT_FALSE(rig.outcome().success) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::jaw_not_closed)) << rig.story();
  EXPECT_GT(arm::gap_from_jaw(test::jaw5e, angle_rad(rig, arm5e_joint::jaw)), 0.04) << "it still holds it";
}

// The jaw's motor seizes before the second look: its torque rises while it stands.
TEST(APress, IsNotBegunWithAJawThatHasSeized) {
  Rig rig({"tasks=[{turn_valve: {to_deg: 90}}, {press_buttons: {order: [left]}}]"});
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::back_off)) << rig.story();
  rig.devices().add_fault({0, devices::DeviceFaultKind::following, 5}, rig.now());
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_FALSE(rig.outcome().success) << rig.story();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(arm5e_joint::jaw)) << rig.story();
  EXPECT_GT(arm::gap_from_jaw(test::jaw5e, angle_rad(rig, arm5e_joint::jaw)), 0.02) << "it has not closed";
  EXPECT_EQ(rig.world().button(0).presses, 0u);
  EXPECT_EQ(rig.world().button(0).depth_m, 0) << "it was touched";
}

// It was pressed as hard as one that works, three times; the arm is home again, and touched nothing else.
TEST_P(AButton, ThatIsStuckIsNotPressedAndSaidToBeStuck) {
  std::vector<std::string> scenario = press(GetParam());
  scenario.push_back(std::string("buttons.stuck=[") + GetParam() + "]");
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Rig rig(scenario, seed);
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_FALSE(rig.outcome().success);
    EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::button_stuck)) << "seed " << seed << ": " << rig.story();
    EXPECT_EQ(rig.world().button(index_of(GetParam())).presses, 0u);
    EXPECT_EQ(result(rig).presses, 0u);
    EXPECT_FALSE(result(rig).done);
    EXPECT_EQ(result(rig).failure, StepFailure::button_stuck);
    EXPECT_LT(result(rig).travel_m, 0.0015);
    EXPECT_TRUE(rig.world().contacts().unintended.empty());
    EXPECT_LT(rig.world().contacts().peak_force_n, 150);
  }
}

// With 30 N m, more than the drives give, the press ends at the end of its way and not by the torque.
TEST(AStuckButton, IsStuckWhateverTorqueSaysBottom) {
  for (const double torque_nm : {15.0, 20.0, 30.0}) {
    Rig rig({"tasks=[{press_buttons: {order: [left]}}]", "buttons.stuck=[left]"}, 1,
            [&](ControllerConfig& told) { told.mission.press_torque_nm = torque_nm; });
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::button_stuck)) << torque_nm << " N m: " << rig.story();
    EXPECT_LT(rig.world().contacts().peak_force_n, 150) << torque_nm;
  }
}

TEST_P(AButton, ThatIsGoneIsMissed) {
  std::vector<std::string> scenario = press(GetParam());
  scenario.push_back(std::string("buttons.missing=[") + GetParam() + "]");
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Rig rig(scenario, seed);
    rig.start();
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_FALSE(rig.outcome().success);
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::button_missing)) << "seed " << seed << ": " << rig.story();
    EXPECT_EQ(result(rig).presses, 0u);
    EXPECT_EQ(result(rig).failure, StepFailure::button_missing);
    EXPECT_TRUE(rig.world().contacts().unintended.empty()) << "the plate was touched";
  }
}

INSTANTIATE_TEST_SUITE_P(OfThree, AButton, testing::Values("left", "centre", "right"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace lf::test
