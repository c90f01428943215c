// Objects of the scene in physics: they stop what moves, at their surface, and are told by their names.
#include <gtest/gtest.h>

#include "host_sim/world/fixed_object.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/world/sliding_rig.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::world {
namespace {

constexpr int iterations = 50;
constexpr double step_s = 0.001;
const int object_index = static_cast<int>(scene::own_body_count(scene::bare_scene()));

// A box of full extents `size_m` about `centre_m`, as twelve triangles that are counter-clockwise from outside.
void add_box(scene::Shape& mesh, const Vec3& size_m, const Vec3& centre_m) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (unsigned i = 0; i < 8; ++i)
    mesh.vertices_m.push_back(
        centre_m + Vec3((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5, (i & 4U) != 0 ? 0.5 : -0.5).cwiseProduct(size_m));
  constexpr std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

scene::Scene scene_with(const scene::Body& thing) {
  scene::Scene scene = scene::bare_scene();
  scene.push_back(thing);
  return scene;
}

scene::Body mesh_body(const std::vector<std::pair<Vec3, Vec3>>& boxes) {
  scene::Shape mesh;
  mesh.kind = scene::ShapeKind::mesh;
  mesh.friction = 0.5;
  for (const auto& [size_m, centre_m] : boxes) add_box(mesh, size_m, centre_m);
  return {"thing", {mesh}, scene::Role::object, Pose::Identity()};
}

Pose at(const Vec3& place_m) { return Pose(Eigen::Translation3d(place_m)); }

struct Stopped {
  double impulse_n_s = 0;
  double stopped_at_m = 0;  // of the sled's leading face
};

// A sled of 2 kg and 50 mm that slides along x at 0.2 m/s, from 0.1 m before the origin, for a second.
Stopped slide_into(const scene::Body& thing, const Pose& pose, double y_m = 0) {
  BulletWorld world(iterations, 0, scene_with(thing));
  Sled sled(world, 2, box_body(Vec3::Constant(0.05)), at({-0.1, y_m, 0}));
  const FixedObject object(world.get(), thing, pose, object_index);
  sled.set_speed(Vec3(0.2, 0, 0));
  std::vector<ContactImpulse> impulses;
  Stopped stopped;
  for (int i = 0; i < 1000; ++i) {
    world.step(step_s);
    take_contact_impulses(*world.get().getDispatcher(), impulses);
    for (const ContactImpulse& contact : impulses) {
      EXPECT_EQ(std::max(static_cast<int>(contact.a), static_cast<int>(contact.b)), object_index);
      stopped.impulse_n_s += contact.impulse_n_s.norm();
    }
  }
  stopped.stopped_at_m = -0.1 + sled.position_m().x() + 0.025;
  return stopped;
}

// Both as a box and as its triangles: the whole momentum, at the face that is met, at any pose that shows the sled the same face.
TEST(FixedObject, StopsASledAtItsFaceWithItsMomentum) {
  const scene::Body box = box_body(Vec3(0.2, 0.4, 0.4));
  const scene::Body mesh = mesh_body({{Vec3(0.2, 0.4, 0.4), Vec3::Zero()}});
  for (const double quarter : {0.0, 1.0, 2.0}) {
    Pose pose = at({0.1 + 0.02, 0, 0});
    pose.linear() = Eigen::AngleAxisd(quarter * pi / 2, Vec3::UnitX()).toRotationMatrix();
    for (const scene::Body* thing : {&box, &mesh}) {
      SCOPED_TRACE(testing::Message() << (thing == &box ? "box" : "mesh") << ", turned by " << quarter << " quarters");
      const Stopped stopped = slide_into(*thing, pose);
      EXPECT_NEAR(stopped.impulse_n_s, 2 * 0.2, 2e-3);
      EXPECT_NEAR(stopped.stopped_at_m, 0.02, 3e-4);
    }
  }
}

// Two bars with a gap of 0.1 m between them: its convex hull would be a wall.
TEST(FixedObject, AMeshIsHollowWhereItIs) {
  const scene::Body gate = mesh_body({{Vec3(0.02, 0.1, 0.4), Vec3(0, 0.1, 0)}, {Vec3(0.02, 0.1, 0.4), Vec3(0, -0.1, 0)}});
  EXPECT_EQ(slide_into(gate, Pose::Identity()).impulse_n_s, 0) << "the gap is closed";
  EXPECT_GT(slide_into(gate, Pose::Identity()).stopped_at_m, 0.1);
  EXPECT_NEAR(slide_into(gate, Pose::Identity(), 0.1).impulse_n_s, 2 * 0.2, 2e-3);
}

// A sled pushed down on it and sideways: it slides as soon as the push passes the product of both frictions.
TEST(FixedObject, AMeshHasItsShapesFriction) {
  scene::Body floor = mesh_body({{Vec3(2, 2, 0.1), Vec3(0, 0, -0.05)}});
  floor.shapes[0].friction = 0.8;
  for (const double push_n : {35.0, 45.0}) {
    BulletWorld world(iterations, 0, scene_with(floor));
    Sled sled(world, 2, box_body(Vec3::Constant(0.05), Pose::Identity(), 0.5), at({0.013, 0.017, 0.0255}));
    const FixedObject object(world.get(), floor, Pose::Identity(), object_index);
    for (int i = 0; i < 500; ++i) {
      sled.push(Vec3(i < 100 ? 0 : push_n, 0, -100));
      world.step(step_s);
    }
    const double expected_m_s = std::max(0.0, push_n - 0.8 * 0.5 * 100) / 2 * 0.4;
    EXPECT_NEAR(sled.speed_m_s().x(), expected_m_s, 0.02 + 0.02 * expected_m_s) << push_n << " N";
  }
}

TEST(FixedObject, IsToldByItsNameWhenTheArmHitsIt) {
  WorldConfig config = nominal_config();
  config.start_rad = {0, 1.327, 0.894, 0, 0.3};
  config.base_from_panel.translation() += Vec3(0.5, 0, 0);  // far away
  scene::Body post = box_body(Vec3(0.1, 0.6, 0.6));
  post.name = "post";
  World plain(config);
  post.base_from_body.translation() = plain.base_from_tool().translation() + Vec3(0.05 + 0.06, 0, 0);
  config.scene.push_back(post);
  World world(config);
  Script script(world, config.start_rad);
  script.targets_rad = {0, 1.574, 0.734, 0, 0.3};
  script.run(4.0);
  const ContactReport contacts = world.contacts();
  ASSERT_FALSE(contacts.unintended.empty());
  EXPECT_EQ(contacts.unintended.front().name_b, "post");
  EXPECT_GT(contacts.peak_force_n, 5);
  EXPECT_EQ(world.base_from_body().size(), config.scene.size());
  EXPECT_TRUE(world.base_from_body().back().isApprox(post.base_from_body));
}

std::string refusal_of(scene::Body thing, const Vec3& place_m) {
  WorldConfig config = nominal_config();
  thing.base_from_body.translation() = place_m;
  config.scene.push_back(thing);
  try {
    World world(config);
    return "";
  } catch (const InputError& problem) {
    return problem.what();
  }
}

// In what moves and in what carries the camera; in the panel it may be set.
TEST(FixedObject, IsRefusedWhereItStandsInTheRobotTheHandleOrAButton) {
  const WorldConfig config = nominal_config();
  const Vec3 tool_m = World(config).base_from_tool().translation();
  scene::Body post = box_body(Vec3::Constant(0.1));
  post.name = "post";
  EXPECT_EQ(refusal_of(post, tool_m).rfind("scene: 'post' stands in the ", 0), 0u) << refusal_of(post, tool_m);
  EXPECT_NE(refusal_of(post, Vec3(-0.37, 0, -0.115)).find("in the vehicle"), std::string::npos);
  EXPECT_NE(refusal_of(post, config.base_from_panel * Vec3(0, 0, 0.1)).find("in the handle"), std::string::npos);
  scene::Body cube = box_body(Vec3::Constant(0.04));
  EXPECT_NE(refusal_of(cube, config.base_from_panel * Vec3(0.067, 0.141, 0.02)).find("in the right button"), std::string::npos);
  EXPECT_EQ(refusal_of(post, config.base_from_panel * Vec3(0.3, -0.2, 0)), "");
}

// Bullet takes a mesh for a surface: what is all inside of it touches nothing.
TEST(FixedObject, IsRefusedWhereTheRobotIsInsideOfIt) {
  scene::Body room = mesh_body({{Vec3::Constant(8), Vec3::Zero()}});
  room.name = "room";
  EXPECT_NE(refusal_of(room, Vec3::Zero()).find("which lies inside of it"), std::string::npos) << refusal_of(room, Vec3::Zero());
  EXPECT_EQ(refusal_of(room, Vec3(0, 0, 6)), "");
}

// A bar that is turned meets what stands in its way: it is held there, and both are told.
TEST(FixedObject, StandsInTheHandlesWay) {
  WorldConfig config = nominal_config();
  config.valves[0].friction_nm = 0.5;
  config.valves[0].detent_nm = 0;
  scene::Body bead = box_body(Vec3(0.006, 0.006, 0.02));
  bead.name = "bead";
  bead.base_from_body = config.base_from_panel * Eigen::Translation3d(0.030, 0.030, 0.100);  // in the circle of the bar's ends
  config.scene.push_back(bead);
  config.start_rad = {0, 1.307, 1.151, pi / 2, 0.1};  // about the bar, as in the test of forces
  config.base_from_panel.translation() += Vec3(0, 0.002, 0);
  World world(config);
  Script script(world, config.start_rad);
  script.targets_rad[4] = -0.05;
  script.run(1.5);
  for (const double sign : {-1.0, 1.0}) {  // the bead is met one way round at the latest
    script.targets_rad[3] = pi / 2 + sign * 1.4;
    script.run(5.0);
  }
  bool met = false;
  for (const UnintendedContact& contact : world.contacts().unintended)
    met = met || (contact.name_a == "handle" && contact.name_b == "bead");
  EXPECT_TRUE(met);
}

TEST(FixedObject, FollowsTheScenesOwnBodies) {
  WorldConfig config = nominal_config();
  config.scene.insert(config.scene.begin() + 3, box_body(Vec3::Constant(0.1)));
  EXPECT_THROW(World{config}, InputError);
  config = nominal_config();
  config.scene.pop_back();
  EXPECT_THROW(World{config}, InputError);
  config = nominal_config();
  config.scene.push_back(box_body(Vec3::Constant(0.1)));
  config.scene.back().base_from_body.translation() = Vec3(0, 0, 5);
  EXPECT_NO_THROW(World{config});
  config.scene.back().role = scene::Role::finger;
  EXPECT_THROW(World{config}, InputError) << "another finger";
  config.scene.back().role = scene::Role::object;
  config.scene.back().base_from_body.translation().x() = std::nan("");
  EXPECT_THROW(World{config}, InputError);
  config.scene.back().base_from_body = at({0, 0, 5});
  while (config.scene.size() <= scene::max_bodies) config.scene.push_back(config.scene.back());
  EXPECT_THROW(World{config}, InputError) << "one too many";
}

}  // namespace
}  // namespace lf::world
