// The report's chain of parts stands where the simulated world's bodies do.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_sim/app/report_parts_of.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::app {
namespace {

// base_from_part of each, as docs/report.md says that the page does it.
std::vector<Pose> poses_of(const std::vector<record::ReportPart>& parts, const std::vector<double>& coordinates) {
  std::vector<Pose> poses;
  for (const record::ReportPart& part : parts) {
    Pose pose = part.parent < 0 ? part.parent_from_part : Pose(poses[static_cast<std::size_t>(part.parent)] * part.parent_from_part);
    if (part.coordinate >= 0) {
      const double value = coordinates[static_cast<std::size_t>(part.coordinate)];
      if (part.slides) {
        pose.translate(value * part.axis);
      } else {
        pose.rotate(Eigen::AngleAxisd(value, part.axis));
      }
    }
    poses.push_back(pose);
  }
  return poses;
}

// The nominal world and a post beside the panel.
world::WorldConfig with_a_post() {
  world::WorldConfig config = world::nominal_config();
  scene::Body post;
  post.name = "post";
  post.shapes.emplace_back().size_m = Vec3(0.05, 0.1, 0.3);
  post.base_from_body = Pose(Eigen::Translation3d(0.45, -0.6, 0.5) * Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  config.scene.push_back(post);
  return config;
}

void expect_parts_where_the_bodies_are(const world::World& world, const std::vector<record::ReportPart>& parts) {
  std::vector<double> coordinates;
  const JointReadings readings = world.readings();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) coordinates.push_back(readings[i].position_rad);
  for (std::size_t i = 0; i < world.valve_count(); ++i) coordinates.push_back(world.valve_angle_rad(i));
  for (std::size_t i = 0; i < world.button_count(); ++i) coordinates.push_back(world.button(i).depth_m);
  const std::vector<Pose> poses = poses_of(parts, coordinates);
  const scene::BodyPoses bodies = world.base_from_body();
  ASSERT_EQ(poses.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_LT((poses[i].translation() - bodies[i].translation()).norm(), 1e-6) << parts[i].name;
    // The jaw's angle is one for both fingers, which under way differ by some 0.05 mrad.
    const bool finger = i == arm5e_body::finger_a || i == arm5e_body::finger_b;
    EXPECT_LT((poses[i].linear() - bodies[i].linear()).norm(), finger ? 2e-4 : 1e-6) << parts[i].name;
  }
}

TEST(ReportParts, StandWhereTheBodiesDoAsTheArmMoves) {
  world::WorldConfig config = with_a_post();
  config.valves[0].start_rad = 0.4;
  const std::vector<record::ReportPart> parts = report_parts_of(config);
  world::World world(config);
  expect_parts_where_the_bodies_are(world, parts);
  world::Script drives(world, {0.3, 0.8, 1.6, -0.9, 0.1});
  for (int i = 0; i < 5; ++i) {
    drives.run(0.5);
    expect_parts_where_the_bodies_are(world, parts);
  }
}

TEST(ReportParts, StandWhereTheBodiesDoOnAPanelWithSeveralOfEachKind) {
  world::WorldConfig config = world::nominal_config();
  ASSERT_TRUE(config.layout.valves.push_back({.at_m{0.25, 0.02}}));
  ASSERT_TRUE(config.layout.buttons.push_back({.at_m{0.2, 0.17}}));
  config.scene = scene::make_scene(config.arm, config.layout, {{"V1", "V2"}, {"B1", "B2", "B3", "B4"}, {"7"}});
  config.valves.resize(2);
  config.buttons.resize(4);
  config.valves[0].start_rad = 0.4;
  config.valves[1].start_rad = -0.7;
  expect_parts_where_the_bodies_are(world::World(config), report_parts_of(config));
}

TEST(ReportParts, HaveTheWorldsShapes) {
  const world::WorldConfig config = with_a_post();
  const std::vector<record::ReportPart> parts = report_parts_of(config);
  ASSERT_EQ(parts.size(), config.scene.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].name, config.scene[i].name);
    EXPECT_EQ(parts[i].shapes.size(), config.scene[i].shapes.size());
  }
}

}  // namespace
}  // namespace lf::app
