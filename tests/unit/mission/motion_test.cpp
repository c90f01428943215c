#include "firmware/mission/motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "firmware/arm/inverse_kinematics.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::mission {
namespace {

constexpr double period_s = 0.004;

safety::Limits limits() {
  safety::Limits limits;
  limits.workspace_min_m.fill(-2);
  limits.workspace_max_m.fill(2);
  const arm::JointLimits urdf = test::arm5e.limits();
  arm5e_joint::fill(limits.joints, safety::JointLimit{});
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    limits.joints[i] = {urdf.lower_rad[k] + 0.02, urdf.upper_rad[k] - 0.02, 0.8 * urdf.velocity_rad_s[k], 50};
  }
  limits.joints[4] = {-0.05, 1.3, 0.5, 20};
  return limits;
}

const arm::JointVector park = arm::planar_joints(0, 0.6, 1.9, 0);

const PanelLayout docked;
const arm::VehicleShape no_vehicle;

Motion at_park(PanelLayout&& gone_after) = delete;
Motion at_park(const PanelLayout& layout = docked) {
  Motion motion(test::arm5e, limits(), layout, no_vehicle, park);
  motion.start_at(park);
  return motion;
}

Room closed_before(const Pose& base_from_panel) {
  Room room;
  room.base_from_panel = base_from_panel;
  return room;
}

// A panel that nothing comes near to.
Room far_away() {
  Pose pose = PanelLayout{}.nominal_base_from_panel();
  pose.translation().x() += 2;
  return closed_before(pose);
}

scan::SweepRequest sweep_over_the_panel() {
  scan::SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  return request;
}

LaserCalibration forearm_laser() {
  LaserCalibration laser;
  laser.tool_from_laser.translation() = Vec3(-0.090, 0, -0.365);
  return laser;
}

// Until the order is planned; false when it cannot be.
bool planned(Motion& motion) {
  while (motion.planning()) motion.step(period_s);
  return motion.failure() == StepFailure::none;
}

// Steps to the end and returns the largest joint speed seen, relative to its limit.
double run(Motion& motion, int max_steps = 100'000) {
  double fastest = 0;
  const arm::JointVector speed = motion.limits(1).velocity_rad_s;
  for (int i = 0; i < max_steps && !motion.done(); ++i) {
    const arm::JointVector before = motion.target();
    motion.step(period_s);
    fastest = std::max(fastest, ((motion.target() - before) / period_s).cwiseAbs().cwiseQuotient(speed).maxCoeff());
  }
  EXPECT_TRUE(motion.done());
  return fastest;
}

TEST(Motion, RandomWaysArriveExactlyAndKeepTheSpeedLimits) {
  constexpr unsigned seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  Motion motion = at_park();
  const arm::JointLimits bounds = motion.limits(1);
  const auto draw = [&] {
    arm::JointVector q = arm::JointVector::Zero();
    for (Eigen::Index i = 0; i < 4; ++i) q[i] = std::uniform_real_distribution<double>(bounds.lower_rad[i], bounds.upper_rad[i])(random);
    return q;
  };
  motion.start_at(draw());
  for (int i = 0; i < 100; ++i) {
    const std::array way{draw(), draw()};
    motion.go(way, 0.6);
    ASSERT_EQ(motion.failure(), StepFailure::none);
    EXPECT_LE(run(motion), 0.6 * 1.001);
    EXPECT_LT((motion.target() - way[1]).norm(), 1e-9);
  }
}

TEST(Motion, RefusesGoalsOutsideTheSafetyLimitsAndStaysWhereItIs) {
  Motion motion = at_park();
  motion.go(std::array{arm::planar_joints(0, 0.005, 1.9, 0)}, 0.6);  // inside the URDF's, outside the mission's
  EXPECT_EQ(motion.failure(), StepFailure::unreachable);
  EXPECT_TRUE(motion.done());
  EXPECT_EQ(motion.target(), park);
}

TEST(Motion, ATurnBeyondTheRollsLimitsIsRefused) {
  Motion motion = at_park();
  motion.turn(0, 7, far_away(), 0, 0.2);
  EXPECT_EQ(motion.failure(), StepFailure::unreachable);
  EXPECT_TRUE(motion.done());
  EXPECT_EQ(motion.target(), park);
}

TEST(Motion, ALineStaysOnTheLine) {
  Motion motion = at_park();
  const arm::IkResult start = arm::inverse_kinematics(test::arm5e, {0.25, 0, 0.59}, 0.3);
  ASSERT_TRUE(start.ok());
  motion.start_at(start.q_rad);
  const Vec3 from = test::arm5e.base_from_tool(start.q_rad).translation();
  const Vec3 to(0.34, 0.01, 0.592);
  motion.line(to, 0.3, far_away(), 0, 0.04);
  ASSERT_TRUE(planned(motion));
  while (!motion.done()) {
    motion.step(period_s);
    const Vec3 tool = test::arm5e.base_from_tool(motion.target()).translation();
    EXPECT_LT((tool - from).cross((to - from).normalized()).norm(), 1e-9);
  }
  EXPECT_LT((test::arm5e.base_from_tool(motion.target()).translation() - to).norm(), 1e-9);
}

TEST(Motion, AStopEndsAtRestWithoutAJump) {
  Motion motion = at_park();
  motion.go(std::array{arm::planar_joints(0.3, 1.2, 1.0, 1.0)}, 1.0);
  for (int i = 0; i < 300; ++i) motion.step(period_s);
  ASSERT_FALSE(motion.done());
  motion.stop();
  EXPECT_LE(run(motion), 1.001);
  EXPECT_GT((motion.target() - arm::planar_joints(0.3, 1.2, 1.0, 1.0)).norm(), 0.1);  // it did stop on the way
}

TEST(Motion, TheSweepIsStrictlyAtConstantSpeedBetweenRunUpAndRunOut) {
  const scan::SweepRequest request = sweep_over_the_panel();
  Motion motion = at_park();
  motion.go_to_sweep(request, forearm_laser(), closed_before(request.base_from_panel), 0, 0.6);
  ASSERT_TRUE(planned(motion));
  const scan::SweepPlan plan = motion.sweep_plan();
  ASSERT_EQ(plan.outcome, scan::SweepOutcome::ok);
  run(motion);
  motion.sweep();
  int cruising = 0;
  while (!motion.done()) {
    const bool before = motion.cruising();
    const arm::JointVector q = motion.target();
    motion.step(period_s);
    if (!before || !motion.cruising()) continue;
    ++cruising;
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
      EXPECT_NEAR((motion.target() - q)[static_cast<Eigen::Index>(i)] / period_s, plan.speed_rad_s[i], 1e-6);
    }
  }
  EXPECT_NEAR(cruising * period_s, plan.duration.s(), 0.02);
}

// The sweep's speed is the mission's; the elbow may not go as fast.
TEST(Motion, ASweepFasterThanItsJointMayGoIsRefused) {
  const scan::SweepRequest request = sweep_over_the_panel();
  safety::Limits slow = limits();
  slow.joints[2].max_speed_rad_s = 0.5 * request.slowest_rad_s;
  Motion motion(test::arm5e, slow, docked, no_vehicle, park);
  motion.start_at(park);
  motion.go_to_sweep(request, forearm_laser(), closed_before(request.base_from_panel), 0, 0.6);
  EXPECT_FALSE(planned(motion));
  EXPECT_EQ(motion.failure(), StepFailure::unreachable);
  EXPECT_EQ(motion.target(), park);
}

// A board of 100 x 400 mm stands in the arm's space: nothing else of the panel is anywhere near.
const PanelLayout& board() {
  static const PanelLayout all = [] {
    PanelLayout layout;
    layout.plate_min_m = Vec2(-0.05, -0.2);
    layout.plate_max_m = Vec2(0.05, 0.2);
    layout.plate_thickness_m = 0.02;
    for (PanelLayout::Button& button : layout.buttons) {
      button.at_m = Vec2(0, 0);
      button.width_m = button.height_m = 0.001;
    }
    PanelLayout::Marker& marker = layout.markers[0];
    marker.centre_m = Vec2(0, 0);
    marker.plate_m = marker.plate_thickness_m = 0.001;
    PanelLayout::Valve& valve = layout.valves[0];
    valve.handle_length_m = valve.handle_thickness_m = valve.handle_height_m = valve.stem_radius_m = 0.001;
    return layout;
  }();
  return all;
}

Room board_at(double x_m, double y_m, double z_m) {
  Room room;
  room.base_from_panel = board().nominal_base_from_panel();
  room.base_from_panel.translation() = Vec3(x_m, y_m, z_m);
  return room;
}

// The nearest that the arm comes to the board on its way to rest.
double nearest_m(Motion& motion, const Room& room) {
  const arm::PanelShape panel(board());
  double nearest = 1e9;
  for (int i = 0; i < 100'000 && !motion.done(); ++i) {
    motion.step(period_s);
    nearest =
        std::min(nearest, panel.clearance(test::arm5e.link_capsules(motion.target(), room.jaw.low_rad), room.base_from_panel).distance_m);
  }
  EXPECT_TRUE(motion.done());
  return nearest;
}

const arm::JointVector behind_board = arm::planar_joints(-0.3, 0.2, 1.1, 0), past_board = arm::planar_joints(0.1, 1.5, 1.9, 0);

double straight_s() {
  Motion motion = at_park(board());
  motion.start_at(behind_board);
  motion.go(std::array{past_board}, 0.6);
  return motion.duration_s();
}

TEST(MotionPastThePanel, SaysWhatBarsIt) {
  EXPECT_EQ(failure_of(arm::Barrier::panel), StepFailure::panel_in_the_way);
  EXPECT_EQ(failure_of(arm::Barrier::vehicle), StepFailure::vehicle_in_the_way);
  EXPECT_EQ(failure_of(arm::Barrier::itself), StepFailure::arm_in_its_own_way);
  EXPECT_EQ(failure_of(arm::Barrier::none), StepFailure::no_motion);
}

TEST(MotionPastThePanel, IsStraightWhereThatIsClear) {
  Motion motion = at_park(board());
  motion.start_at(behind_board);
  motion.go_clear(past_board, board_at(1.5, 0, 0.55), 0, 0.6);
  ASSERT_TRUE(planned(motion));
  EXPECT_EQ(motion.duration_s(), straight_s());
}

TEST(MotionPastThePanel, LeadsByTheParkPositionWhereTheStraightWayIsBarred) {
  const Room room = board_at(0.30, -0.05, 0.55);
  Motion straight = at_park(board());
  straight.start_at(behind_board);
  straight.go(std::array{past_board}, 0.6);
  EXPECT_LT(nearest_m(straight, room), 0.010) << "nothing bars the straight way";

  Motion motion = at_park(board());
  motion.start_at(behind_board);
  motion.go_clear(past_board, room, 0, 0.6);
  ASSERT_TRUE(planned(motion));
  EXPECT_GT(motion.duration_s(), straight_s());
  EXPECT_GE(nearest_m(motion, room), clearance_m - arm::ClearWay::resolution_m);
  EXPECT_LT((motion.target() - past_board).norm(), 1e-9);
}

// Nothing stands in the way, and the tool would leave its workspace.
TEST(MotionPastThePanel, KeepsToItsWorkspace) {
  const Room room = board_at(2, -0.05, 0.55);
  const arm::JointVector from = arm::planar_joints(-1.2, 0.9, 1.2, 0), to = arm::planar_joints(0.3, 0.9, 1.2, 0);
  Motion free = at_park(board());
  free.start_at(from);
  free.go_clear(to, room, 0, 0.6);
  EXPECT_TRUE(planned(free));

  safety::Limits tight = limits();
  const Vec3 from_m = test::arm5e.base_from_tool(from).translation();
  for (std::size_t i = 0; i < 3; ++i) {
    tight.workspace_min_m[i] = from_m[static_cast<Eigen::Index>(i)] - 0.02;
    tight.workspace_max_m[i] = from_m[static_cast<Eigen::Index>(i)] + 0.02;
  }
  const PanelLayout far_board = board();
  Motion boxed(test::arm5e, tight, far_board, no_vehicle, park);
  boxed.start_at(from);
  boxed.go_clear(to, room, 0, 0.6);
  EXPECT_FALSE(planned(boxed));
  EXPECT_EQ(boxed.target(), from);
}

// From the park position all would be clear, but the way there is barred.
TEST(MotionPastThePanel, LooksAtTheWayToTheParkPositionToo) {
  const arm::JointVector from = arm::planar_joints(-0.5, 0.9, 2.0, 0), to = arm::planar_joints(0.3, 1.2, 0.5, 0);
  const Room room = board_at(0.15, 0.05, 0.40);
  Motion from_park = at_park(board());
  from_park.go_clear(to, room, 0, 0.6);
  EXPECT_TRUE(planned(from_park));

  Motion motion = at_park(board());
  motion.start_at(from);
  motion.go_clear(to, room, 0, 0.6);
  EXPECT_FALSE(planned(motion));
  EXPECT_EQ(motion.failure(), StepFailure::panel_in_the_way);
  EXPECT_TRUE(motion.done());
  EXPECT_EQ(motion.target(), from);
}

TEST(MotionPastThePanel, MayLeaveFromNearerThanItWouldGo) {
  Motion motion = at_park(board());
  const arm::JointVector near = arm::planar_joints(0, 1.2, 1.2, 0);
  motion.start_at(near);
  Room room = board_at(0.5, 0, 0.55);
  const arm::PanelShape panel(board());
  // The board comes up until the arm is 5 mm off it.
  while (panel.clearance(test::arm5e.link_capsules(near, 0), room.base_from_panel).distance_m > 0.005)
    room.base_from_panel.translation().x() -= 0.0005;
  motion.go_clear(park, room, 0, 0.6);
  EXPECT_TRUE(planned(motion));
  motion.stop();
  motion.go_clear(arm::planar_joints(0, 1.25, 1.1, 0), room, 0, 0.6);
  EXPECT_FALSE(planned(motion)) << "on into the board";
}

TEST(Motion, HeldOnItsWayComesToRestThereAndGoesOnToTheSameEnd) {
  Motion motion = at_park();
  const arm::JointVector goal = park + arm::planar_joints(0.3, 0.2, -0.2, 0.1);
  motion.go(std::array{goal}, 0.5);
  while (motion.elapsed_s() < 0.3 * motion.duration_s()) motion.step(period_s);
  motion.hold();
  for (int i = 0; i < 200; ++i) motion.step(period_s);
  EXPECT_TRUE(motion.paused());
  const arm::JointVector held = motion.target();
  for (int i = 0; i < 200; ++i) motion.step(period_s);
  EXPECT_EQ(motion.target(), held);
  motion.resume();
  EXPECT_LE(run(motion), 0.5 + 1e-9);
  EXPECT_LT((motion.target() - goal).norm(), 1e-9);
}

TEST(Motion, HeldWhileItIsPlannedDoesNotSetOut) {
  Motion motion = at_park();
  const arm::JointVector goal = park + arm::planar_joints(0.1, 0.1, -0.1, 0);
  motion.go_clear(goal, far_away(), 0, 0.5);
  ASSERT_TRUE(motion.planning());
  motion.hold();
  for (int i = 0; i < 500; ++i) motion.step(period_s);
  EXPECT_EQ(motion.target(), park);
  EXPECT_TRUE(motion.paused());
  motion.resume();
  (void)run(motion);
  EXPECT_LT((motion.target() - goal).norm(), 1e-9);
}

TEST(Motion, IsPlannedInSharesAndStoppedMeanwhileStaysWhereItIs) {
  Motion motion = at_park();
  scan::SweepRequest request;
  request.base_from_panel = PanelLayout{}.nominal_base_from_panel();
  (void)request.handles.push_back({});
  LaserCalibration laser;
  laser.tool_from_laser.translation() = Vec3(-0.090, 0, -0.365);
  motion.go_to_sweep(request, laser, closed_before(request.base_from_panel), 0, 0.6);
  for (int tick = 0; tick < 5; ++tick) {
    motion.step(period_s);
    EXPECT_TRUE(motion.planning());
    EXPECT_FALSE(motion.done());
    EXPECT_EQ(motion.target(), park);
  }
  motion.stop();
  EXPECT_TRUE(motion.done());
  motion.step(period_s);
  EXPECT_EQ(motion.target(), park);
}

}  // namespace
}  // namespace lf::mission
