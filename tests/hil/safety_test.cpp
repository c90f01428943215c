// What each fault does in each phase, on the whole robot: the table of docs/mission.md is the specification.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using mission::Step;
using safety::Fault;

// From a quick stop's order on: the SYNC that carries it, and the drives' ramps (the roll from its 0.7 rad/s in 0.2 s), with the arm's swing after it.
constexpr double stop_time_s = 0.5;
// The drives' stated compliance lets a stopped arm swing by less.
constexpr double standing_rad_s = 0.02;

// The phases under way, by a step in each, and how far into it the fault comes.
struct Moment {
  Step step;
  double later_s;
  const char* name;
};
constexpr Moment free_motion{Step::deploy, 1.0, "deploying"}, scanning{Step::scan, 1.5, "scanning"},
    in_contact{Step::advance, 1.0, "advancing"}, gripping{Step::turn, 1.0, "turning"}, pressing{Step::press, 1.0, "pressing"},
    stowing{Step::stow, 0.5, "stowing"};

void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }

std::vector<std::string> turn_only() { return {"tasks=[{turn_valve: {to_deg: 90}}]"}; }
std::vector<std::string> press_only() { return {"tasks=[{press_buttons: {order: [centre]}}]"}; }
std::vector<std::string> job_with(const Moment& moment) { return moment.step == Step::press ? press_only() : turn_only(); }

bool reach(Rig& rig, const Moment& moment) {
  rig.start();
  if (!rig.run_to(moment.step)) return false;
  rig.run_for(moment.later_s);
  return rig.step_now() == moment.step;
}

// Of a screw, whose length closes a triangle with its pivots, or of a gear.
double rad_per_count(const ArmActuator& actuator, double q_rad) {
  if (actuator.counts_per_rad > 0) return 1 / actuator.counts_per_rad;
  const double a = actuator.pivot_a_m, b = actuator.pivot_b_m, angle_rad = q_rad + actuator.offset_rad;
  return std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle_rad)) / (actuator.counts_per_m * a * b * std::sin(angle_rad));
}

class EmergencyStop : public testing::TestWithParam<Moment> {};

TEST_P(EmergencyStop, StopsTheDrivesAndHoldsWhatIsHeld) {
  Rig rig(job_with(GetParam()));
  ASSERT_TRUE(reach(rig, GetParam())) << rig.story();
  const double moving_rad_s = rig.fastest_joint_rad_s();
  const double grip_n = rig.world().contacts().grip_force_n;
  rig.devices().set_estop_closed(false);
  rig.run_for(stop_time_s);
  EXPECT_GT(moving_rad_s, 2 * standing_rad_s) << "there was nothing to stop";
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  const double valve_rad = rig.world().valve_angle_rad(0);
  rig.run_for(2);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::estop);
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_FALSE(rig.devices().laser_on());
  EXPECT_FALSE(rig.devices().lamps_on());
  if (GetParam().step != Step::turn) return;
  EXPECT_GT(grip_n, 20) << "nothing was held";
  EXPECT_GT(rig.world().contacts().grip_force_n, 0.5 * grip_n);
  EXPECT_NEAR(rig.world().valve_angle_rad(0), valve_rad, 0.005);
}

INSTANTIATE_TEST_SUITE_P(InEveryPhase, EmergencyStop, testing::Values(free_motion, scanning, in_contact, gripping, pressing, stowing),
                         [](const testing::TestParamInfo<Moment>& test) { return std::string(test.param.name); });

TEST(EmergencyStopByCommand, IsTheSameAsTheButton) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, free_motion)) << rig.story();
  rig.controller().on_command(Command::emergency_stop, rig.now());
  rig.run_for(stop_time_s);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_EQ(rig.step_now(), Step::stopped);
  EXPECT_EQ(rig.outcome().fault, Fault::estop);
}

TEST(EmergencyStopBeforeTheStart, KeepsThePowerOff) {
  Rig rig;
  rig.devices().set_estop_closed(false);
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60));
  rig.run_for(1);
  EXPECT_FALSE(rig.any_power()) << rig.story();
  EXPECT_TRUE(rig.mission().over()) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::estop);
}

TEST(EmergencyStopWhileHeld, StillStops) {
  Rig rig(turn_only(), 1, [](ControllerConfig& told) {
    // An unexpected contact holds in free motion: what counts as one is set below what deploying takes.
    told.mission_limits.max_contact_torque_nm = 0.3;
  });
  rig.start();
  ASSERT_TRUE(rig.run_to_end());
  ASSERT_EQ(rig.step_now(), Step::held) << rig.story();
  rig.devices().set_estop_closed(false);
  rig.run_for(stop_time_s);
  EXPECT_EQ(rig.step_now(), Step::stopped);
  EXPECT_EQ(rig.outcome().fault, Fault::unexpected_contact) << "the first fault is the one that ended the mission";
}

class Abort : public testing::TestWithParam<Moment> {};

TEST_P(Abort, EndsStowed) {
  Rig rig(job_with(GetParam()));
  ASSERT_TRUE(reach(rig, GetParam())) << rig.story();
  rig.controller().on_command(Command::abort, rig.now());
  ASSERT_TRUE(rig.run_to_end(120)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::aborted);
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
  rig.run_for(0.2);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_FALSE(rig.devices().laser_on());
  EXPECT_FALSE(rig.devices().lamps_on());
}

INSTANTIATE_TEST_SUITE_P(InEveryPhase, Abort, testing::Values(free_motion, scanning, in_contact, gripping, pressing),
                         [](const testing::TestParamInfo<Moment>& test) { return std::string(test.param.name); });

TEST(AbortBeforeTheStart, IsRefusedAndChangesNothing) {
  Rig rig;
  EXPECT_FALSE(rig.controller().on_command(Command::abort, rig.now()));
  rig.run_for(0.1);
  EXPECT_EQ(rig.step_now(), Step::idle) << rig.story();
  EXPECT_EQ(rig.controller().orders_refused(), 1u);
}

TEST(AbortAtBoot, EndsOff) {
  Rig rig;
  rig.start();
  rig.run_for(0.3);
  rig.controller().on_command(Command::abort, rig.now());
  rig.run_for(0.5);
  EXPECT_EQ(rig.step_now(), Step::off) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::aborted);
}

// ---- drives and nodes ----

struct NodeCase {
  const char* name;
  const char* fault;  // as a scenario has it, without its time
  Moment moment;
  Fault named;
  double seen_within_s = 0.5;
};

void PrintTo(const NodeCase& c, std::ostream* out) { *out << c.name; }

class NodeFaults : public testing::TestWithParam<NodeCase> {};

TEST_P(NodeFaults, StopTheArmWhereItIsAndAreNamed) {
  const NodeCase& c = GetParam();
  double at_s = 0;
  {
    Rig rehearsal(job_with(c.moment));
    ASSERT_TRUE(reach(rehearsal, c.moment)) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = job_with(c.moment);
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", " + c.fault + "}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end(at_s + 5)) << rig.story();
  EXPECT_LT(rig.now().s() - at_s, c.seen_within_s) << "the fault was seen late";
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, c.named) << rig.story();
  const double grip_n = rig.world().contacts().grip_force_n;
  rig.run_for(stop_time_s);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_FALSE(rig.devices().laser_on());
  if (c.moment.step == Step::turn) {
    EXPECT_GT(rig.world().contacts().grip_force_n, 0.5 * grip_n) << "let go";
  }
}

INSTANTIATE_TEST_SUITE_P(
    InMotion, NodeFaults,
    testing::Values(NodeCase{"DriveFaultWhileGripping", "kind: overcurrent, node: elbow", gripping, Fault::drive_fault},
                    NodeCase{"JawsDriveFaultWhileGripping", "kind: hot, node: jaw", gripping, Fault::drive_fault},
                    NodeCase{"DriveFaultWhileScanning", "kind: overcurrent, node: elbow", scanning, Fault::drive_fault},
                    NodeCase{"SilentDriveInFreeMotion", "kind: silent, node: shoulder", free_motion, Fault::stale_position},
                    NodeCase{"RebootedDriveInFreeMotion", "kind: reboot, node: shoulder", free_motion, Fault::stale_position},
                    NodeCase{"HeartbeatOfOneNodeLost", "kind: drop_frames, can_id: 1794", free_motion, Fault::node_lost},
                    NodeCase{"PositionsLostInFreeMotion", "kind: drop_frames, can_id: 386", free_motion, Fault::stale_position},
                    NodeCase{"MasterOffTheBus", "kind: bus_off, node: master", free_motion, Fault::bus_off}),
    [](const testing::TestParamInfo<NodeCase>& test) { return std::string(test.param.name); });

// ---- what stands in the way ----

// The panel stands where the arm is told to deploy: it has docked 220 mm too near.
TEST(UnexpectedContact, OnTheWayToTheScanStopsTheArmAndHoldsIt) {
  Rig rig(turn_only(), 1, {}, [](hal::SimConfig& truth) { truth.world.base_from_panel.translation().x() -= 0.22; });
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::held) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::unexpected_contact) << rig.story();
  rig.run_for(1);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_FALSE(rig.world().contacts().unintended.empty()) << "nothing was touched";
  EXPECT_LT(rig.world().contacts().peak_force_n, 200);
}

// A joint that does not move with its target has met something, in the arm's way or in its gear.
// It stays behind without a load: nothing is touched, the drive is not to be trusted.
TEST(JammedDrive, InFreeMotionDoesNotFollow) {
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, free_motion)) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: following, node: shoulder}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end(at_s + 5)) << rig.story();
  EXPECT_LT(rig.now().s() - at_s, 0.6);
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, 1) << "the shoulder";
  rig.run_for(stop_time_s);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
}

// A drive has one following window and one speed for all poses, in counts. The master keeps the joint's own, in angles, at each.
TEST(EveryPose, HasTheSpeedAndTheFollowingWindowOfItsJoints) {
  constexpr double window_rad = 0.15;
  constexpr double between_syncs = 1.03;  // a joint in motion is read a SYNC ago, and a target sent after the limits were set
  Rig rig(press_only());
  rig.start();
  PerJoint<double> least_rad{};
  least_rad.fill(window_rad);
  while (!rig.mission().outcome().ended && rig.now() < Time::from_s(300)) {
    rig.step();
    if (!rig.any_power()) continue;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const auto joint = i;
      const canopen::AxisLimits& here = rig.controller().network().axis(joint).limits_here();
      const double rad = rad_per_count(rig.arm().joints[i].actuator, rig.world().readings()[i].motor_position_rad);
      ASSERT_LE(here.following_window_counts * rad, between_syncs * window_rad) << rig.arm().joints[i].name << rig.story();
      ASSERT_LE(here.max_speed_counts_s * rad, between_syncs * rig.arm().joints[i].velocity_rad_s)
          << rig.arm().joints[i].name << rig.story();
      least_rad[i] = std::min(least_rad[i], here.following_window_counts * rad);
    }
  }
  ASSERT_EQ(rig.step_now(), Step::done) << rig.story();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i)
    EXPECT_GT(least_rad[i], 0.8 * window_rad) << rig.arm().joints[i].name << ": needlessly narrow";
}

// A position is stale after three SYNC cycles without one. Two cycles are fewer.
TEST(LostFrames, OfTwoCyclesChangeNothing) {
  std::vector<std::string> overrides = press_only();
  overrides.push_back("faults=[{at_s: 2.001, kind: drop_frames, can_id: 386, duration_s: 0.007}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(OutputNode, LostWhileTurningStopsAndKeepsTheHandle) {
  std::vector<std::string> overrides = turn_only();
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, gripping)) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: silent, node: io}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_LT(rig.now().s() - at_s, 0.03) << "an emergency stop cannot be read any more";
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::io_lost);
  rig.run_for(2);
  EXPECT_GT(rig.world().contacts().grip_force_n, 10);
  EXPECT_FALSE(rig.any_power());
}

TEST(Interlock, OpenInTheScanIsTriedAgainAndThenGivenUp) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  rig.devices().set_interlock_closed(false);
  rig.run_for(0.1);
  EXPECT_FALSE(rig.devices().laser_on());
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::interlock);
}

TEST(Interlock, ClosedAgainLetsTheMissionGoOn) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  rig.devices().set_interlock_closed(false);
  rig.run_for(0.2);
  rig.devices().set_interlock_closed(true);
  EXPECT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
}

// ---- sight ----

constexpr std::uint32_t for_good = std::numeric_limits<std::uint32_t>::max();

std::uint32_t times_begun(const Rig& rig, Step step) {
  return static_cast<std::uint32_t>(std::count_if(rig.events().begin(), rig.events().end(), [step](const Event& event) {
    return event.kind == Event::Kind::step && event.step == step;
  }));
}

TEST(Images, OfWhichASingleOneIsLostAreEnough) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  rig.sight().lose_images(1);
  ASSERT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
  EXPECT_EQ(rig.count(Fault::image_lost), 1u);
  EXPECT_EQ(rig.count(Fault::camera_lost), 0u);
  EXPECT_EQ(times_begun(rig, Step::scan), 1u);
}

TEST(Images, OfWhichTheStillIsLostAreTakenAgain) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::look)) << rig.story();
  rig.sight().lose_images(1);
  ASSERT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
  EXPECT_EQ(rig.count(Fault::camera_lost), 1u);
  EXPECT_EQ(times_begun(rig, Step::look), 2u);
  EXPECT_EQ(times_begun(rig, Step::scan), 1u);
}

TEST(Images, ThatComeAgainAreTakenFromTheSweepsBeginningOn) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  rig.sight().lose_images(8);  // six until it is seen, two of the next sweep
  ASSERT_TRUE(rig.run_to(Step::reach_valve)) << rig.story();
  EXPECT_EQ(rig.count(Fault::camera_lost), 1u);
  EXPECT_EQ(times_begun(rig, Step::scan), 2u);
}

TEST(Images, ThatStopComingEndTheMissionStowed) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  const Time lost = rig.now();
  rig.sight().lose_images(for_good);
  while (rig.count(Fault::camera_lost) == 0 && rig.now() - lost < Duration::from_s(1)) rig.step();
  EXPECT_LT((rig.now() - lost).s(), 0.3) << "seen late";
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::camera_lost);
  EXPECT_EQ(times_begun(rig, Step::scan), 3u);
  EXPECT_FALSE(rig.devices().laser_on());
}

class FrozenImages : public testing::TestWithParam<KnownSight::Frozen> {};

TEST_P(FrozenImages, AreNoImages) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, scanning)) << rig.story();
  const Time frozen = rig.now();
  rig.sight().freeze(GetParam());
  while (rig.count(Fault::camera_lost) == 0 && rig.now() - frozen < Duration::from_s(1)) rig.step();
  EXPECT_LT((rig.now() - frozen).s(), 0.35) << "seen late";
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::camera_lost);
}

INSTANTIATE_TEST_SUITE_P(InTheScan, FrozenImages, testing::Values(KnownSight::Frozen::camera, KnownSight::Frozen::sensor),
                         [](const testing::TestParamInfo<KnownSight::Frozen>& test) {
                           return std::string(test.param == KnownSight::Frozen::camera ? "Camera" : "Sensor");
                         });

TEST(PanelVision, ThatNeverAnswersIsAskedThreeTimesAndGivenUp) {
  Rig rig(turn_only());
  rig.sight().answer(false);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::vision_late);
  EXPECT_EQ(rig.sight().questions(), 3u);
}

TEST(PanelVision, WhosePortFailsForGoodIsGivenUp) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::perceive)) << rig.story();
  rig.ports().fail(hal::Call::receive_panel, rig.ports().calls(hal::Call::receive_panel), 5, std::numeric_limits<std::uint64_t>::max());
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::vision_late);
}

// ---- after the end ----

TEST(AfterTheEnd, AFaultIsCountedAndTheOutcomeStays) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  ASSERT_EQ(rig.step_now(), Step::done) << rig.story();
  const auto later = [&rig](Fault fault) { return rig.mission().faults_after_end()[static_cast<std::size_t>(fault)]; };
  rig.run_for(5);
  for (const std::uint32_t count : rig.mission().faults_after_end()) EXPECT_EQ(count, 0u) << rig.story();
  rig.devices().set_estop_closed(false);
  rig.run_for(0.1);
  EXPECT_EQ(later(Fault::estop), 1u);
  rig.ports().fail(hal::Call::receive_can, rig.ports().calls(hal::Call::receive_can), 5, std::numeric_limits<std::uint64_t>::max());
  rig.run_for(1);
  EXPECT_EQ(later(Fault::node_lost), arm5e_joint::count);
  EXPECT_GE(later(Fault::port_error), 100u);
  EXPECT_EQ(rig.count(Fault::estop), 1u) << "told, as an event";
  EXPECT_EQ(rig.step_now(), Step::done);
  EXPECT_TRUE(rig.outcome().success);
  EXPECT_EQ(rig.outcome().fault, Fault::count);
}

TEST(AfterTheEnd, ByAQuickStopTheNodesAreWatchedOn) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, free_motion)) << rig.story();
  rig.devices().set_estop_closed(false);
  rig.run_for(2);
  ASSERT_EQ(rig.step_now(), Step::stopped) << rig.story();
  rig.ports().fail(hal::Call::receive_can, rig.ports().calls(hal::Call::receive_can), 5, std::numeric_limits<std::uint64_t>::max());
  rig.run_for(1);
  EXPECT_GE(rig.mission().faults_after_end()[static_cast<std::size_t>(Fault::node_lost)], 1u) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::stopped);
  EXPECT_EQ(rig.outcome().fault, Fault::estop);
}

TEST(AfterTheEnd, AResetForgetsWhatCameSince) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  rig.devices().set_estop_closed(false);
  rig.run_for(0.1);
  rig.devices().set_estop_closed(true);
  rig.run_for(0.1);
  ASSERT_TRUE(rig.controller().on_command(Command::reset, rig.now()));
  rig.run_for(0.1);
  for (const std::uint32_t count : rig.mission().faults_after_end()) EXPECT_EQ(count, 0u) << rig.story();
}

// ---- limits ----

TEST(Limits, WithAWrongChecksumMoveNothing) {
  Rig rig({}, 1, [](ControllerConfig& told) { told.limits.checksum ^= 1; });
  const JointReadings before = rig.world().readings();
  rig.start();
  ASSERT_TRUE(rig.run_to_end(10));
  rig.run_for(1);
  EXPECT_EQ(rig.step_now(), Step::off) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::limits_refused);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i)
    EXPECT_NEAR(rig.world().readings()[i].position_rad, before[i].position_rad, 2e-3);  // the jaw's play
}

TEST(Limits, ThatAMissionWidensAreRefused) {
  Rig rig({}, 1, [](ControllerConfig& told) { told.mission_limits.joints[2].max_speed_rad_s *= 1.01; });
  rig.start();
  ASSERT_TRUE(rig.run_to_end(10));
  EXPECT_EQ(rig.step_now(), Step::off) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::limits_refused);
}

TEST(Clock, LostForGoodInMotionStops) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, free_motion)) << rig.story();
  rig.ports().fail(hal::Call::wait_for_tick, rig.ports().calls(hal::Call::wait_for_tick), 5, std::numeric_limits<std::uint64_t>::max());
  rig.run_for(stop_time_s);
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::clock_lost);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
}

}  // namespace
}  // namespace lf::test
