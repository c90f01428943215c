#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "shared/input_error.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::world {
namespace {

using scene::BodyId;

TEST(World, restsParkedWithoutAnyContact) {
  World world(nominal_config());
  Script script(world, nominal_config().start_rad);
  script.run(0.5);
  EXPECT_TRUE(world.contacts().unintended.empty());
  EXPECT_EQ(world.contacts().peak_force_n, 0);
  EXPECT_EQ(world.valve_angle_rad(0), 0);
  EXPECT_NEAR(world.time_s(), 0.5, 1e-9);
}

// Half a detent's width beside it, where friction does not hold: with the arm parked it stood there until the hand came near.
TEST(World, aHandleBesideItsDetentFallsInWithNoArmNear) {
  WorldConfig config = nominal_config();
  config.valves[0].friction_nm = 0.1;
  config.valves[0].viscous_nm_s = 0.05;
  config.valves[0].detents_rad = {0.5};
  config.valves[0].detent_nm = 0.3;
  config.valves[0].start_rad = 0.5 - 0.5 * config.valves[0].detent_width_rad;
  World world(config);
  Script script(world, config.start_rad);
  script.run(2);
  const double held_within_rad =
      std::asin(config.valves[0].friction_nm / config.valves[0].detent_nm) / pi * config.valves[0].detent_width_rad;
  EXPECT_NEAR(world.valve_angle_rad(0), 0.5, held_within_rad + 1e-6);
  const double fallen_rad = world.valve_angle_rad(0);
  script.run(1);
  EXPECT_EQ(world.valve_angle_rad(0), fallen_rad) << "and stays";
}

TEST(World, placesThePanelsBodiesAsTheLayoutSays) {
  WorldConfig config = nominal_config();
  config.valves[0].start_rad = 0.4;
  config.base_from_panel.translation() += Vec3(0.01, -0.02, 0.015);
  const World world(config);
  const scene::BodyPoses poses = world.base_from_body();
  EXPECT_TRUE(poses[arm5e_body::panel].isApprox(config.base_from_panel));
  EXPECT_TRUE(poses[arm5e_body::first_feature].isApprox(config.base_from_panel * Eigen::AngleAxisd(0.4, Vec3::UnitZ()), 1e-9));
  for (std::size_t i = 0; i < config.layout.buttons.size(); ++i) {
    const Vec2& centre = config.layout.buttons[i].at_m;
    EXPECT_TRUE(
        poses[arm5e_body::first_feature + 1 + i].translation().isApprox(config.base_from_panel * Vec3(centre.x(), centre.y(), 0), 1e-9));
  }
}

// Along the arm's own arc onto the centre button: from 30 mm before its cap to 3 mm, where the pads, 10 mm ahead of the tool point, have pressed it in.
TEST(World, closedJawPressesAButtonWhichClicksAtItsForce) {
  WorldConfig config = nominal_config();
  const Targets before{0, 1.3460, 1.4903, pi / 2, -0.04};
  const Targets pressed{0, 1.4073, 1.4320, pi / 2, -0.04};
  config.start_rad = before;
  World world(config);
  Script script(world, config.start_rad);
  double normal_n = 0;          // of the last step before the click, along the panel's axis
  constexpr int steps = 13500;  // 2 mm/s
  for (int i = 0; i < steps && !world.button(1).pressed; ++i) {
    for (std::size_t j = 1; j < 3; ++j) script.targets_rad[j] = before[j] + (pressed[j] - before[j]) * i / steps;
    normal_n = -world.contacts().base_wrench.force_n.x();
    script.step();
  }
  ASSERT_TRUE(world.button(1).pressed);
  EXPECT_EQ(world.button(1).presses, 1u);
  EXPECT_EQ(world.button(0).presses + world.button(2).presses, 0u);
  const ButtonConfig& button = config.buttons[1];
  const double click_n = button.preload_n + button.spring_n_m * button.click_depth_m;
  EXPECT_NEAR(normal_n, click_n, 0.01 * click_n);
  EXPECT_TRUE(world.contacts().unintended.empty());
  script.targets_rad = before;
  script.run(1.0);
  EXPECT_FALSE(world.button(1).pressed);
  EXPECT_NEAR(world.button(1).depth_m, 0, 1e-6);
}

TEST(World, listsAnArmThatHitsThePanel) {
  WorldConfig config = nominal_config();
  config.start_rad = {0, 1.327, 0.894, 0, 0.3};
  config.base_from_panel.translation() += Vec3(-0.03, 0.25, 0);  // plain plate ahead
  World world(config);
  Script script(world, config.start_rad);
  script.targets_rad = {0, 1.574, 0.734, 0, 0.3};
  script.run(4.0);
  const ContactReport contacts = world.contacts();
  ASSERT_FALSE(contacts.unintended.empty());
  EXPECT_EQ(contacts.unintended.front().b, arm5e_body::panel);
  EXPECT_GT(contacts.unintended.front().first_s, 0.1);
  EXPECT_GT(contacts.unintended.front().peak_force_n, 5);
  EXPECT_GE(contacts.peak_force_n, 5);
}

TEST(World, forcesAtTheWristAndAtTheBaseAreTheSameForceInTheirFrames) {
  WorldConfig config = nominal_config();
  config.start_rad = {0, 1.307, 1.151, pi / 2, 0.1};
  config.base_from_panel.translation() += Vec3(0, 0.002, 0);
  World world(config);
  Script script(world, config.start_rad);
  script.targets_rad[4] = -0.05;
  script.run(1.5);
  const ContactReport contacts = world.contacts();
  EXPECT_GT(contacts.grip_force_n, 60);
  EXPECT_TRUE(contacts.unintended.empty());
  EXPECT_GT(contacts.base_wrench.force_n.norm(), 5);
  EXPECT_NEAR(contacts.base_wrench.force_n.norm(), contacts.tool_wrench.force_n.norm(), 0.02);
  EXPECT_NEAR((contacts.base_wrench.force_n + contacts.handle_force_n).norm(), 0, 1e-9);
  const Pose base_from_tool = world.base_from_tool();
  EXPECT_NEAR((base_from_tool.linear() * contacts.tool_wrench.force_n - contacts.base_wrench.force_n).norm(), 0, 0.02);
  const Vec3 arm = base_from_tool.translation() - config.vehicle_com_m;
  const Vec3 moved = base_from_tool.linear() * contacts.tool_wrench.torque_nm + arm.cross(contacts.base_wrench.force_n);
  EXPECT_NEAR((moved - contacts.base_wrench.torque_nm).norm(), 0, 0.02);
}

std::uint64_t digest_of_a_grasp() {
  WorldConfig config = nominal_config();
  config.start_rad = {0, 1.307, 1.151, pi / 2, 0.1};
  World world(config);
  Script script(world, config.start_rad);
  script.targets_rad = {0, 1.307, 1.151, 1.0, -0.05};
  std::uint64_t digest = 0;
  for (int i = 0; i < 1500; ++i) {
    script.step();
    digest = digest * 31 + world.state_digest();
  }
  return digest;
}

TEST(World, equalCallsGiveEqualBits) { EXPECT_EQ(digest_of_a_grasp(), digest_of_a_grasp()); }

TEST(World, refusesWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(WorldConfig&)>> faults{
      [&](WorldConfig& c) { c.valves[0].friction_nm = -1; },
      [&](WorldConfig& c) { c.valves[0].friction_nm = nan; },
      [&](WorldConfig& c) { c.valves[0].start_rad = 3; },
      [&](WorldConfig& c) { c.valves[0].stop_min_rad = 2; },
      [&](WorldConfig& c) { c.valves[0].inertia_kg_m2 = 1e-6; },
      [&](WorldConfig& c) { c.valves[0].detents_rad = {nan}; },
      [&](WorldConfig& c) { c.buttons[0].click_depth_m = 0.1; },
      [&](WorldConfig& c) { c.buttons[1].click_drop_n = 100; },
      [&](WorldConfig& c) { c.buttons[2].mass_kg = 0; },
      [&](WorldConfig& c) { c.start_rad[1] = -0.5; },
      [&](WorldConfig& c) { c.start_rad[2] = nan; },
      [&](WorldConfig& c) { c.base_from_panel.translation().x() = nan; },
      [&](WorldConfig& c) { c.base_from_panel.linear() *= 2; },
      [&](WorldConfig& c) { c.step_s = 0; },
      [&](WorldConfig& c) { c.force_window_s = 1e-5; },
      [&](WorldConfig& c) { c.solver_iterations = 0; },
      [&](WorldConfig& c) { c.restitution = 1.5; },
      [&](WorldConfig& c) { c.drive_stiffness_nm_rad[0] = -1; },
      [&](WorldConfig& c) { c.arm.links[3].mass_kg = 0; },
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    WorldConfig config = nominal_config();
    faults[i](config);
    EXPECT_THROW(World{config}, InputError) << "fault " << i;
  }
}

}  // namespace
}  // namespace lf::world
