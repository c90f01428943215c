// Planned motions held against a model of arm, panel and vehicle that shares nothing with the planner: tests/unit/arm/solid_arm.hpp.
#include <gtest/gtest.h>

#include <random>

#include "firmware/arm/gripper.hpp"
#include "firmware/mission/motion.hpp"
#include "hal/config/machine.hpp"
#include "shared/scene/panel_scene.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/arm/solid_arm.hpp"

namespace lf::mission {
namespace {

constexpr double period_s = 0.004;
constexpr unsigned seed = 20261122;
const arm::JointVector park = arm::planar_joints(0, 0.6, 1.9, 0);

const ArmDescription& described_arm() {
  static const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  return arm;
}

arm::VehicleShape default_vehicle() {
  config::Machine machine;
  machine.file = "default";
  return config::make_core(machine).controller.mission.vehicle;
}

safety::Limits limits() {
  safety::Limits limits;
  limits.workspace_min_m.fill(-2);
  limits.workspace_max_m.fill(2);
  const arm::JointLimits urdf = test::arm5e.limits();
  arm5e_joint::fill(limits.joints, safety::JointLimit{});
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    limits.joints[i] = {urdf.lower_rad[k], urdf.upper_rad[k], urdf.velocity_rad_s[k], 50};
  }
  return limits;
}

class Draws {
 public:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double either(double most) { return uniform(0, 1) < 0.7 ? (uniform(0, 1) < 0.5 ? most : -most) : uniform(-most, most); }
  arm::JointVector joints() {
    const arm::JointLimits l = test::arm5e.limits(0.01);
    arm::JointVector q = arm::JointVector::Zero();
    for (Eigen::Index i = 0; i < 4; ++i) q[i] = uniform(l.lower_rad[i], l.upper_rad[i]);
    return q;
  }
  Pose off(const Pose& believed, const arm::PanelDoubt& doubt) {
    Pose real = believed;
    real.translation() += Vec3(either(doubt.shift_m), either(doubt.shift_m), either(doubt.shift_m));
    real.linear() = Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitZ()).toRotationMatrix() *
                    Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitY()).toRotationMatrix() *
                    Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitX()).toRotationMatrix() * real.linear() *
                    Eigen::AngleAxisd(either(doubt.spin_rad), Vec3::UnitZ()).toRotationMatrix();
    return real;
  }

 private:
  std::mt19937_64 random_{seed};
};

// The nearest of the arm's points, wherever its jaw is, to panels that stand where the doubt lets them, and to the vehicle. `fingers_too`: or only the rest.
struct Nearest {
  double panel_m = 1e9, vehicle_m = 1e9;
};

class Model {
 public:
  Model(const PanelLayout& layout, const arm::VehicleShape& vehicle) : layout_(layout), vehicle_(vehicle), arm_(described_arm(), 0.015) {}

  Nearest at(const arm::JointVector& q, double jaw_rad, const Pose& base_from_panel, bool fingers_too = true) const {
    const auto links = arm_.base_from_links(q, jaw_rad);
    const Pose panel_from_base = base_from_panel.inverse();
    Nearest nearest;
    for (const arm::SolidArm::Point& point : arm_.points()) {
      const Vec3 p = links[point.link] * point.at_m;
      if (fingers_too || point.link < 5) nearest.panel_m = std::min(nearest.panel_m, arm::to_panel_m(panel_from_base * p, layout_));
      if (point.link < 2) continue;  // the slew stands on the vehicle
      for (const auto& box : vehicle_.boxes) nearest.vehicle_m = std::min(nearest.vehicle_m, arm::to_box_m(p, box.centre_m, box.size_m));
      for (const auto& rod : vehicle_.rods) {
        const double bound = (p - (rod.a_m + rod.b_m) / 2).norm() - (rod.b_m - rod.a_m).norm() / 2 - rod.radius_m;
        if (bound < nearest.vehicle_m) nearest.vehicle_m = std::min(nearest.vehicle_m, arm::to_rod_m(p, rod));
      }
    }
    return nearest;
  }

 private:
  PanelLayout layout_;
  arm::VehicleShape vehicle_;
  arm::SolidArm arm_;
};

constexpr double kept_m = clearance_m - arm::ClearWay::resolution_m;

// Random ways before the first look, and after it; half of them with the jaw opening or closing on the way.
TEST(RandomWays, ThatArePlannedKeepClearOfPanelAndVehicleWhereverThePanelMayBe) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Draws draw;
  const PanelLayout layout;
  const arm::VehicleShape vehicle = default_vehicle();
  const Model model(layout, vehicle);
  Motion motion(test::arm5e, limits(), layout, vehicle, park);
  int ways = 0, refused_for_panel = 0, refused_for_vehicle = 0, near = 0;
  for (int k = 0; k < 400 || ways < 60; ++k) {
    ASSERT_LT(k, 3000) << "too few ways are found";
    const arm::JointVector from = draw.joints(), to = draw.joints();
    Room room;
    room.base_from_panel = layout.nominal_base_from_panel();
    room.doubt = k % 2 == 0 ? arm::PanelDoubt{0.020, 0.0349} : arm::PanelDoubt{0.003, 0.004, 0.0105};
    const double open_rad = arm::jaw_from_gap(test::jaw5e, 0.0606);
    room.jaw = k % 4 < 2 ? arm::JawSweep{-0.05, -0.05} : arm::JawSweep{-0.05, open_rad};
    // A way out of a place that is too near already is another matter: see MayLeaveFromNearerThanItWouldGo.
    const Nearest start = model.at(from, room.jaw.low_rad, room.base_from_panel);
    if (start.panel_m < 0.12 || start.vehicle_m < 0.02) continue;
    motion.start_at(from);
    motion.go_clear(to, room, room.jaw.low_rad, 0.8);
    while (motion.planning()) motion.step(period_s);
    refused_for_panel += motion.failure() == StepFailure::panel_in_the_way;
    refused_for_vehicle += motion.failure() == StepFailure::vehicle_in_the_way;
    if (motion.failure() != StepFailure::none) {
      ASSERT_EQ(motion.target(), from);
      continue;
    }
    ++ways;
    const Pose real = draw.off(room.base_from_panel, room.doubt);
    for (int tick = 0; !motion.done(); ++tick) {
      motion.step(period_s);
      if (tick % 8 != 0) continue;
      const Nearest here = model.at(motion.target(), draw.uniform(room.jaw.low_rad, room.jaw.high_rad), real);
      ASSERT_GE(here.panel_m, kept_m) << "draw " << k << " at " << motion.target().transpose();
      ASSERT_GE(here.vehicle_m, kept_m) << "draw " << k << " at " << motion.target().transpose();
      near += std::min(here.panel_m, here.vehicle_m) < 0.05;
    }
  }
  EXPECT_GE(ways, 60);
  EXPECT_GT(refused_for_panel, 5);
  EXPECT_GT(refused_for_vehicle, 5);
  EXPECT_GT(near, 20) << "nothing was put to the test";
}

// From a stand-off to the handle and to each button: only the fingers may touch, and only what they are meant to.
TEST(RandomLines, ToTheHandleAndTheButtonsKeepAllButTheFingersClear) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Draws draw;
  const PanelLayout layout;
  const arm::VehicleShape vehicle = default_vehicle();
  const Model model(layout, vehicle);
  Motion motion(test::arm5e, limits(), layout, vehicle, park);
  int lines = 0;
  for (int k = 0; k < 60; ++k) {
    Room room;
    room.base_from_panel = draw.off(layout.nominal_base_from_panel(), {0.020, 0.0349});  // as it was found
    room.doubt = {0.003, 0.004};
    const bool handle = k % 4 == 0;
    const std::size_t button = static_cast<std::size_t>(k % 4 + 2) % 3;
    const double jaw_rad = handle ? arm::jaw_from_gap(test::jaw5e, 0.0606) : -0.05;
    room.jaw = {jaw_rad, jaw_rad};
    room.meant_for_fingers =
        handle ? arm::bit(arm::PanelPart::valve(0)) : arm::bit(arm::PanelPart::plate()) | arm::bit(arm::PanelPart::button(button));
    const Vec3 aim = handle ? layout.valves[0].handle_centre_m() : Vec3(layout.buttons[button].face_m() + Vec3(0, 0, 0.012));
    const double roll = handle ? draw.uniform(-1.5, 1.5) : 0;
    const arm::IkResult start = arm::inverse_kinematics(test::arm5e, room.base_from_panel * (aim + Vec3(0, 0, 0.08)), roll, 0.01);
    if (!start.ok()) continue;
    motion.start_at(start.q_rad);
    motion.line(room.base_from_panel * aim, roll, room, jaw_rad, 0.04);
    while (motion.planning()) motion.step(period_s);
    ASSERT_EQ(motion.failure(), StepFailure::none) << "draw " << k << ": " << name(motion.failure());
    ++lines;
    const Pose real = draw.off(room.base_from_panel, room.doubt);
    for (int tick = 0; !motion.done(); ++tick) {
      motion.step(period_s);
      if (tick % 8 != 0) continue;
      const Nearest here = model.at(motion.target(), jaw_rad, real, false);
      ASSERT_GE(here.panel_m, kept_m) << "draw " << k;
      ASSERT_GE(here.vehicle_m, kept_m) << "draw " << k;
    }
  }
  EXPECT_GT(lines, 40);
}

// The 24 mm to either side that an opening jaw takes are part of the way. The board bars the open jaw, not the closed one.
TEST(AWay, IsThatOfTheJawAtItsWidest) {
  const PanelLayout layout;
  arm::VehicleShape post;
  const arm::JointVector from = arm::planar_joints(-0.25, 1.0, 1.2, 0), to = arm::planar_joints(0.25, 1.0, 1.2, 0);
  const double open_rad = arm::jaw_from_gap(test::jaw5e, 0.0606);
  // Beside the fingers where the way begins, 20 mm off the closed ones: nearer than their opening.
  const arm::LinkCapsules closed = test::arm5e.link_capsules(from, 0);
  Room room;
  room.base_from_panel = layout.nominal_base_from_panel();
  room.base_from_panel.translation().x() += 2;
  Vec3 beside = test::arm5e.base_from_tool(from) * Vec3(-0.03, 0, 0);
  const Vec3 outward = test::arm5e.base_from_tool(from).linear().col(0);
  const auto off_m = [&] { return arm::clearance_to_vehicle(closed, post); };
  do {
    beside -= 0.001 * outward;
    post.rods.clear();
    ASSERT_TRUE(post.rods.push_back({beside, beside, 0.002}));
  } while (off_m() < 0.020);
  const auto failure = [&](double high_rad) {
    Motion motion(test::arm5e, limits(), layout, post, park);
    motion.start_at(from);
    room.jaw = {0, high_rad};
    motion.go_clear(to, room, 0, 0.8);
    while (motion.planning()) motion.step(period_s);
    return motion.failure();
  };
  EXPECT_EQ(failure(0), StepFailure::none);
  EXPECT_EQ(failure(open_rad), StepFailure::vehicle_in_the_way);
}

// A post on the straight way, off the way by the park position.
TEST(AWay, LeadsRoundWhatTheVehicleHasInIt) {
  const PanelLayout layout;
  Room room;
  room.base_from_panel = layout.nominal_base_from_panel();
  room.base_from_panel.translation().x() += 2;
  const arm::IkResult left = arm::inverse_kinematics(test::arm5e, {0.1, -0.45, 0.5}, 0),
                      right = arm::inverse_kinematics(test::arm5e, {0.35, 0.15, 0.5}, 0);
  ASSERT_TRUE(left.ok() && right.ok());
  const arm::JointVector from = left.q_rad, to = right.q_rad, middle = (from + to) / 2;
  arm::VehicleShape post;
  const Vec3 tool = test::arm5e.base_from_tool(middle).translation();
  ASSERT_TRUE(post.rods.push_back({tool, tool + Vec3(0, 0, 0.05), 0.01}));
  const Model model(layout, post);
  Motion motion(test::arm5e, limits(), layout, post, park);
  motion.start_at(from);
  motion.go_clear(to, room, 0, 0.8);
  while (motion.planning()) motion.step(period_s);
  ASSERT_EQ(motion.failure(), StepFailure::none) << name(motion.failure());
  double nearest_m = 1e9;
  while (!motion.done()) {
    motion.step(period_s);
    nearest_m = std::min(nearest_m, model.at(motion.target(), 0, room.base_from_panel).vehicle_m);
  }
  EXPECT_GE(nearest_m, kept_m);
  EXPECT_LT((motion.target() - to).norm(), 1e-9);
  EXPECT_LT(model.at(middle, 0, room.base_from_panel).vehicle_m, 0.001) << "nothing stands in the straight way";
}

TEST(AJog, ThatIsBarredMovesNothingAndSaysByWhat) {
  const PanelLayout layout;
  const arm::VehicleShape vehicle = default_vehicle();
  Motion motion(test::arm5e, limits(), layout, vehicle, park);
  const arm::JointVector near_panel = arm::planar_joints(0, 1.307, 1.0, 0);
  Room room;
  room.base_from_panel = layout.nominal_base_from_panel();
  room.doubt = {0.020, 0.0349};
  motion.start_at(near_panel);
  motion.jog(near_panel + arm::planar_joints(0, 0, 0.3, 0), room, 0, 0.25);
  ASSERT_TRUE(motion.planning());
  while (motion.planning()) motion.step(period_s);
  EXPECT_EQ(motion.failure(), StepFailure::panel_in_the_way);
  EXPECT_EQ(motion.target(), near_panel);
  motion.jog(near_panel + arm::planar_joints(0, -0.3, 0, 0), room, 0, 0.25);
  while (motion.planning()) motion.step(period_s);
  EXPECT_EQ(motion.failure(), StepFailure::none) << "away from it";
}

// What the simulator draws and collides of the vehicle within the arm's reach is inside of what the core keeps clear of.
TEST(TheDefaultVehicle, CoversTheSimulatorsWhereTheArmCouldBe) {
  constexpr double arm_reach_m = 1.05;
  const arm::VehicleShape vehicle = default_vehicle();
  const scene::Scene scene = scene::make_scene(described_arm(), PanelLayout{});
  int points = 0;
  for (const scene::Shape& shape : scene[arm5e_body::vehicle].shapes) {
    ASSERT_NE(shape.kind, scene::ShapeKind::mesh);
    const bool box = shape.kind == scene::ShapeKind::box;
    const double radius = shape.size_m.x(), caps = shape.kind == scene::ShapeKind::capsule ? radius : 0;
    for (int i = 0; i < 4096; ++i) {
      Vec3 p;
      if (box) {
        p = Vec3(i % 16 / 15.0 - 0.5, i / 16 % 16 / 15.0 - 0.5, i / 256 / 15.0 - 0.5).cwiseProduct(shape.size_m);
      } else {
        const double z = (i / 64 / 63.0 - 0.5) * (shape.size_m.z() + 2 * caps), beyond = std::max(0.0, std::abs(z) - shape.size_m.z() / 2);
        const double r = caps > 0 ? std::sqrt(std::max(0.0, radius * radius - beyond * beyond)) : radius;
        p = Vec3(r * std::cos(i % 64 * pi / 32), r * std::sin(i % 64 * pi / 32), z);
      }
      p = shape.body_from_shape * p;
      if (p.norm() > arm_reach_m) continue;
      ++points;
      double least = 1e9;
      for (const auto& b : vehicle.boxes) least = std::min(least, arm::to_box_m(p, b.centre_m, b.size_m));
      for (const auto& rod : vehicle.rods) least = std::min(least, arm::to_rod_m(p, rod));
      ASSERT_LT(least, 0.004) << p.transpose();
    }
  }
  EXPECT_GT(points, 10'000);
}

}  // namespace
}  // namespace lf::mission
