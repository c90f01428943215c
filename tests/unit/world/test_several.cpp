// A panel with two valves and five buttons: each is a body of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::world {
namespace {

using scene::Role;
using testing::HasSubstr;

constexpr double apart_m = 0.25;
const PanelNames names{{"V1", "V2"}, {"B1", "B2", "B3", "B4", "B5"}, {"7"}};

// The docked mission's panel, a second valve to the right of its valve, and two buttons above that one.
WorldConfig several() {
  WorldConfig config = nominal_config();
  PanelLayout::Valve second;
  second.at_m = Vec2(apart_m, 0);
  EXPECT_TRUE(config.layout.valves.push_back(second));
  for (const double x_m : {0.2, 0.33}) EXPECT_TRUE(config.layout.buttons.push_back({.at_m{x_m, 0.17}}));
  config.scene = scene::make_scene(config.arm, config.layout, names);
  config.valves.resize(2);
  config.buttons.resize(5);
  return config;
}

TEST(Several, standEachAtItsOwnPlaceAndAngle) {
  WorldConfig config = several();
  config.valves[0].start_rad = 0.4;
  config.valves[1].start_rad = -0.7;
  config.base_from_panel.translation() += Vec3(0.01, -0.02, 0.015);
  const World world(config);
  ASSERT_EQ(world.valve_count(), 2u);
  ASSERT_EQ(world.button_count(), 5u);
  const scene::BodyPoses poses = world.base_from_body();
  ASSERT_EQ(poses.size(), config.scene.size());
  const std::vector<std::size_t> handles = scene::bodies_of(config.scene, Role::handle),
                                 caps = scene::bodies_of(config.scene, Role::button);
  ASSERT_EQ(handles.size(), 2u);
  ASSERT_EQ(caps.size(), 5u);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    const Vec2& at_m = config.layout.valves[i].at_m;
    const Pose expected =
        config.base_from_panel * Eigen::Translation3d(at_m.x(), at_m.y(), 0) * Eigen::AngleAxisd(config.valves[i].start_rad, Vec3::UnitZ());
    EXPECT_TRUE(poses[handles[i]].isApprox(expected, 1e-9)) << names.valves[i];
    EXPECT_EQ(config.scene[handles[i]].name, names.valves[i] + "'s handle");
    EXPECT_EQ(world.valve_angle_rad(i), config.valves[i].start_rad);
  }
  for (std::size_t i = 0; i < caps.size(); ++i) {
    const Vec2& at_m = config.layout.buttons[i].at_m;
    EXPECT_LT((poses[caps[i]].translation() - config.base_from_panel * Vec3(at_m.x(), at_m.y(), 0)).norm(), 1e-9) << names.buttons[i];
    EXPECT_EQ(config.scene[caps[i]].name, names.buttons[i] + " button");
  }
}

// Grips the valve before it and turns the wrist by 60 degrees. The panel is shifted so that this is `valve`.
void turn_one(std::size_t valve, bool broken) {
  SCOPED_TRACE(names.valves[valve]);
  const std::size_t other = 1 - valve;
  WorldConfig config = several();
  config.valves[other].start_rad = 0.3;
  config.base_from_panel.translation() -= config.base_from_panel.linear() * Vec3(config.layout.valves[valve].at_m.x(), 0, 0);
  config.start_rad = {0, 1.307, 1.151, pi / 2, 0.3};
  World world(config);
  if (broken) world.break_handle(valve);
  Script script(world, config.start_rad);
  script.torque_limit_nm = {20, 20, 20, 12, 15};
  script.targets_rad[4] = -0.05;
  script.run(1.0);
  const double gripped_n = world.contacts().grip_force_n, before_rad = world.valve_angle_rad(valve);
  script.targets_rad[3] -= rad_from_deg(60);
  script.run(3.0);
  if (broken) {
    EXPECT_EQ(gripped_n, 0);
    EXPECT_EQ(world.valve_angle_rad(valve), 0);
  } else {
    EXPECT_GT(gripped_n, 20);
    EXPECT_NEAR(deg_from_rad(world.valve_angle_rad(valve) - before_rad), 60, 4.5);
  }
  EXPECT_NEAR(world.valve_angle_rad(other), 0.3, 1e-9) << "the other one";
  EXPECT_TRUE(world.contacts().unintended.empty());
}

TEST(Several, aTurnedValveLeavesTheOther) {
  turn_one(0, false);
  turn_one(1, false);
}

TEST(Several, aHandleThatBreaksIsThatOfItsValve) {
  turn_one(0, true);
  turn_one(1, true);
}

// As in the test of the world with one valve: along the arm's own arc onto B2.
TEST(Several, aPressedButtonLeavesTheOthers) {
  WorldConfig config = several();
  const Targets before{0, 1.3460, 1.4903, pi / 2, -0.04}, pressed{0, 1.4073, 1.4320, pi / 2, -0.04};
  config.start_rad = before;
  World world(config);
  Script script(world, config.start_rad);
  constexpr int steps = 13500;
  for (int i = 0; i < steps && !world.button(1).pressed; ++i) {
    for (std::size_t j = 1; j < 3; ++j) script.targets_rad[j] = before[j] + (pressed[j] - before[j]) * i / steps;
    script.step();
  }
  for (std::size_t i = 0; i < world.button_count(); ++i) EXPECT_EQ(world.button(i).presses, i == 1 ? 1u : 0u) << names.buttons[i];
}

std::string refusal(const WorldConfig& config) {
  return test::message_of<InputError>([&] { const World world(config); });
}

TEST(Several, ofAnotherNumberThanTheLayoutsAreRefusedByName) {
  EXPECT_NO_THROW(World{several()});
  WorldConfig config = several();
  config.valves.pop_back();
  EXPECT_THAT(refusal(config), HasSubstr("world: valves must be as many as the layout's"));
  config = several();
  config.buttons.emplace_back();
  EXPECT_THAT(refusal(config), HasSubstr("world: buttons must be as many as the layout's"));
  config = several();
  config.scene = nominal_config().scene;
  EXPECT_THAT(refusal(config), HasSubstr("world: scene must have its 16 own bodies"));
  // As many bodies, of other kinds: one valve more and one button less.
  config = several();
  PanelLayout other = config.layout;
  EXPECT_TRUE(other.valves.push_back({}));
  other.buttons.pop_back();
  config.scene = scene::make_scene(config.arm, other, {{"V1", "V2", "V3"}, {"B1", "B2", "B3", "B4"}, {"7"}});
  EXPECT_THAT(refusal(config), HasSubstr("world: scene must begin with its own bodies"));
}

TEST(Several, areRefusedEachByItsNumber) {
  WorldConfig config = several();
  config.valves[1].friction_nm = -1;
  EXPECT_THAT(refusal(config), HasSubstr("valves[1].friction_nm"));
  config = several();
  config.buttons[4].stroke_m = 0;
  EXPECT_THAT(refusal(config), HasSubstr("buttons[4].stroke_m"));
}

}  // namespace
}  // namespace lf::world
