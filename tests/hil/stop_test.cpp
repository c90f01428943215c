// The stop functions of docs/safety.md on the whole robot, measured on the bus, at the drives and in the world: from the report to the quick stop, from
// standstill to the power off, in every phase in which a drive has power, and in any order with a shut-down.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Step;
using safety::Fault;

constexpr double quick_stop_s = 0.012;        // from the report of an open chain to the last drive's quick stop on the bus
constexpr double unread_s = 0.026;            // from the last good report, when none comes any more
constexpr double after_standstill_s = 0.100;  // power off
constexpr double after_stop_s = 1.2;          // power off, at the latest

struct Moment {
  Step step;
  double later_s;
  const char* name;
};
void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }
constexpr std::array<Moment, 9> moments{{{Step::enable, 0.02, "Enabling"},
                                         {Step::check_jaw, 0.0, "CheckingTheJaw"},
                                         {Step::deploy, 1.0, "Deploying"},
                                         {Step::scan, 1.5, "Scanning"},
                                         {Step::perceive, 0.02, "Perceiving"},
                                         {Step::advance, 1.0, "Advancing"},
                                         {Step::grip, 0.3, "Gripping"},
                                         {Step::turn, 1.0, "Turning"},
                                         {Step::stow, 0.5, "Stowing"}}};

std::string name_of(const testing::TestParamInfo<Moment>& test) { return test.param.name; }

bool reach(Rig& rig, const Moment& moment) {
  rig.start();
  if (!rig.run_to(moment.step)) return false;
  rig.run_for(moment.later_s);
  return rig.step_now() == moment.step;
}

struct Times {
  double standstill_s = -1;  // for good, since the call
  double power_off_s = -1;
};

// Runs on for two seconds and says when the arm stood and when the last drive lost its power.
Times watch_stop(Rig& rig) {
  const Time began = rig.now();
  Times times;
  while (rig.now() - began < Duration::from_s(2)) {
    rig.step();
    const double t_s = (rig.now() - began).s();
    const bool stands = rig.fastest_joint_rad_s() < standing_rad_s;
    if (!stands) times.standstill_s = -1;
    if (stands && times.standstill_s < 0) times.standstill_s = t_s;
    const bool power = rig.any_power();
    if (power) times.power_off_s = -1;
    if (!power && times.power_off_s < 0) times.power_off_s = t_s;
  }
  return times;
}

void expect_stop_of_category_1(Rig& rig, const Times& times) {
  EXPECT_GE(times.standstill_s, 0) << "it still moves";
  ASSERT_GE(times.power_off_s, 0) << "a drive has power";
  EXPECT_LE(times.power_off_s, after_stop_s);
  EXPECT_LE(times.power_off_s - times.standstill_s, after_standstill_s + 0.008);  // measured in steps of 4 ms
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_TRUE(rig.mission().over()) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_FALSE(rig.devices().laser_on());
  testing::Test::RecordProperty("standstill_ms", static_cast<int>(times.standstill_s * 1e3));
  testing::Test::RecordProperty("power_off_ms", static_cast<int>(times.power_off_s * 1e3));
}

class Stop : public testing::TestWithParam<Moment> {};

TEST_P(Stop, ByTheButtonIsOfCategoryOne) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, GetParam())) << rig.story();
  const double grip_n = rig.world().contacts().grip_force_n;
  rig.bus().mark();
  rig.devices().set_estop_closed(false);
  const Times times = watch_stop(rig);
  ASSERT_TRUE(rig.bus().first_open());
  ASSERT_TRUE(rig.bus().all_stopped());
  const double sent_s = (*rig.bus().all_stopped() - *rig.bus().first_open()).s();
  EXPECT_LE(sent_s, quick_stop_s);
  RecordProperty("quick_stop_us", static_cast<int>(sent_s * 1e6));
  expect_stop_of_category_1(rig, times);
  EXPECT_EQ(rig.outcome().fault, Fault::estop);
  if (GetParam().step != Step::turn) return;
  EXPECT_GT(grip_n, 20) << "nothing was held";
  EXPECT_GT(rig.world().contacts().grip_force_n, 0.5 * grip_n) << "the screw holds the handle without power";
}

// The node that reads the chain falls silent: what cannot be read is open.
TEST_P(Stop, ComesWhenTheChainCannotBeRead) {
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, GetParam())) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: silent, node: io}]");
  Rig rig(overrides);
  ASSERT_TRUE(reach(rig, GetParam())) << rig.story();
  rig.bus().mark();
  const Times times = watch_stop(rig);
  ASSERT_TRUE(rig.bus().all_stopped()) << rig.story();
  const double sent_s = (*rig.bus().all_stopped() - rig.bus().last_closed()).s();
  EXPECT_LE(sent_s, unread_s);
  RecordProperty("quick_stop_us", static_cast<int>(sent_s * 1e6));
  expect_stop_of_category_1(rig, times);
  EXPECT_EQ(rig.outcome().fault, Fault::io_lost);
}

INSTANTIATE_TEST_SUITE_P(InEveryPhase, Stop, testing::ValuesIn(moments), name_of);

// ---- stops and shut-downs, in any order and at any distance ----

struct Order {
  const char* name;
  Command first, second;
  double apart_s;
};
void PrintTo(const Order& order, std::ostream* out) { *out << order.name; }

class StopAndShutDown : public testing::TestWithParam<Order> {};

TEST_P(StopAndShutDown, AlwaysEndWithoutPower) {
  const Order& order = GetParam();
  for (const Moment& moment : {moments[0], moments[2], moments[7]}) {
    SCOPED_TRACE(moment.name);
    Rig rig(turn_only());
    ASSERT_TRUE(reach(rig, moment)) << rig.story();
    EXPECT_TRUE(give(rig, order.first));
    if (order.apart_s > 0) rig.run_for(order.apart_s);
    EXPECT_TRUE(give(rig, order.second));
    const Time ordered = rig.now();
    while (!rig.mission().over() && rig.now() - ordered < Duration::from_s(5)) {
      rig.step();
      EXPECT_FALSE(rig.mission().over() && rig.any_power()) << "the loop would have ended with power on";
    }
    EXPECT_TRUE(rig.mission().over()) << rig.story();
    rig.run_for(2);
    EXPECT_FALSE(rig.any_power()) << rig.story();
    EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
    // The nodes are stopped, too: all that is heard of them is the heartbeat.
    const std::uint64_t heard = rig.controller().network().stats().frames_in;
    rig.run_for(1);
    EXPECT_LE(rig.controller().network().stats().frames_in - heard, 6u * 11u);
  }
}

INSTANTIATE_TEST_SUITE_P(InAnyOrder, StopAndShutDown,
                         testing::Values(Order{"StopAndShutDownAtOnce", Command::emergency_stop, Command::shut_down, 0},
                                         Order{"StopThenShutDown8ms", Command::emergency_stop, Command::shut_down, 0.008},
                                         Order{"StopThenShutDown300ms", Command::emergency_stop, Command::shut_down, 0.3},
                                         Order{"StopThenShutDownLater", Command::emergency_stop, Command::shut_down, 3},
                                         Order{"ShutDownAndStopAtOnce", Command::shut_down, Command::emergency_stop, 0},
                                         Order{"ShutDownThenStop8ms", Command::shut_down, Command::emergency_stop, 0.008},
                                         Order{"ShutDownThenStop100ms", Command::shut_down, Command::emergency_stop, 0.1},
                                         Order{"ShutDownThenStop300ms", Command::shut_down, Command::emergency_stop, 0.3},
                                         Order{"ShutDownThenStopLater", Command::shut_down, Command::emergency_stop, 3}),
                         [](const testing::TestParamInfo<Order>& test) { return std::string(test.param.name); });

// ---- what else ends without power ----

struct Loss {
  const char* name;
  Moment when;
  const char* fault;  // as a scenario has it, without its time
  Fault seen;         // as the core names it
  std::int32_t code;  // the joint
};
void PrintTo(const Loss& loss, std::ostream* out) { *out << loss.name; }

class LostDrive : public testing::TestWithParam<Loss> {};

TEST_P(LostDrive, EndsWithoutPower) {
  const Moment& when = GetParam().when;
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, when)) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", " + GetParam().fault + "}]");
  Rig rig(overrides);
  (void)reach(rig, when);  // the last tick of it may already see the loss
  const Times times = watch_stop(rig);
  ASSERT_GE(times.power_off_s, 0) << "a drive has power " << rig.story();
  EXPECT_LE(times.power_off_s, after_stop_s + 0.4);  // the master's heartbeat may have to be missed first
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, GetParam().seen) << rig.story();
  EXPECT_EQ(rig.outcome().code, GetParam().code) << rig.story();
  rig.run_for(1.5);
  EXPECT_TRUE(rig.mission().over()) << rig.story();
  RecordProperty("power_off_ms", static_cast<int>(times.power_off_s * 1e3));
}

constexpr Moment deploying{Step::deploy, 1.0, "Deploying"};
constexpr Moment perceiving{Step::perceive, 0.02, "Perceiving"};  // the arm is to stand still
constexpr Moment scanning{Step::scan, 1.5, "Scanning"};
constexpr Moment advancing{Step::advance, 1.0, "Advancing"};  // a contact is told by its name here, and this is none
INSTANTIATE_TEST_SUITE_P(AtOnce, LostDrive,
                         testing::Values(Loss{"Faulted", deploying, "kind: overcurrent, node: elbow", Fault::drive_fault, 2},
                                         Loss{"Silent", deploying, "kind: silent, node: shoulder", Fault::stale_position, 1},
                                         Loss{"Rebooted", deploying, "kind: reboot, node: shoulder", Fault::stale_position, 1},
                                         Loss{"HeartbeatLost", deploying, "kind: drop_frames, can_id: 1794", Fault::node_lost, 1},
                                         Loss{"EncoderStuck", deploying, "kind: stuck_encoder, node: elbow", Fault::following_error, 2},
                                         Loss{"EncoderStuckInTheSweep", scanning, "kind: stuck_encoder, node: elbow",
                                              Fault::following_error, 2},
                                         Loss{"RunawayAtRest", perceiving, "kind: runaway, node: shoulder", Fault::following_error, 1},
                                         Loss{"RunawaySlewAtRest", perceiving, "kind: runaway, node: slew", Fault::following_error, 0},
                                         Loss{"RunawayInTheAdvance", advancing, "kind: runaway, node: shoulder", Fault::following_error, 1},
                                         Loss{"PositionsLost", deploying, "kind: drop_frames, can_id: 386", Fault::stale_position, 1},
                                         Loss{"MasterOffTheBus", deploying, "kind: bus_off, node: master", Fault::bus_off, 0}),
                         [](const testing::TestParamInfo<Loss>& test) { return std::string(test.param.name); });

TEST(StopAfterTheEnd, IsObeyedAndChangesNoOutcome) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  rig.devices().set_estop_closed(false);  // at once: the drives are still on their way down
  const Times times = watch_stop(rig);
  EXPECT_GE(times.power_off_s, 0);
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_TRUE(rig.outcome().success);
  EXPECT_TRUE(rig.mission().over());
}

TEST(StopOfAHeldArm, TakesItsPower) {
  Rig rig(turn_only(), 1, [](ControllerConfig& told) { told.mission_limits.max_contact_torque_nm = 0.3; });
  rig.start();
  ASSERT_TRUE(rig.run_to_end());
  ASSERT_EQ(rig.step_now(), Step::held) << rig.story();
  rig.run_for(1);
  EXPECT_TRUE(rig.any_power()) << "held is powered";
  EXPECT_FALSE(rig.mission().over());
  rig.devices().set_estop_closed(false);
  const Times times = watch_stop(rig);
  EXPECT_GE(times.power_off_s, 0);
  EXPECT_LE(times.power_off_s, after_stop_s);
  EXPECT_EQ(rig.step_now(), Step::stopped);
}

// ---- a second master ----

TEST(SecondMaster, IsSeenNamedAndStopped) {
  for (const std::uint32_t id : {0x203u, 0x080u, 0x000u, 0x603u, 0x77Fu}) {
    SCOPED_TRACE(id);
    Rig rig(turn_only());
    ASSERT_TRUE(reach(rig, {Step::deploy, 1.0, "deploying"})) << rig.story();
    CanFrame foreign;
    foreign.id = id;
    foreign.length = id == 0x080 ? 0 : id == 0x77F ? 1 : id == 0 ? 2 : 8;
    rig.controller().on_can(0, foreign, rig.now());
    rig.bus().mark();
    const Times times = watch_stop(rig);
    EXPECT_GE(times.power_off_s, 0);
    EXPECT_EQ(rig.outcome().fault, Fault::second_master) << rig.story();
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(id));
    EXPECT_EQ(rig.count(Fault::second_master), 1u);
  }
}

// A master that goes on would take back a quick stop: the arm stands as its gears do, without power.
TEST(SecondMaster, ThatGoesOnEnablingADriveMovesNothing) {
  for (const char* joint : {"slew", "roll", "jaw"}) {
    SCOPED_TRACE(joint);
    double at_s = 0;
    {
      Rig rehearsal(turn_only());
      ASSERT_TRUE(reach(rehearsal, {Step::deploy, 1.0, ""})) << rehearsal.story();
      at_s = rehearsal.now().s();
    }
    std::vector<std::string> overrides = turn_only();
    overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: foreign_rpdo, node: " + joint + "}]");
    Rig rig(overrides);
    (void)reach(rig, {Step::deploy, 1.0, ""});
    const Times times = watch_stop(rig);
    EXPECT_GE(times.power_off_s, 0);
    EXPECT_LE(times.power_off_s, 0.1);
    EXPECT_EQ(rig.outcome().fault, Fault::second_master) << rig.story();
  }
}

// One that runs the whole arm sends more in a SYNC period than one identifier: each is told, and the one that orders drives takes the power.
TEST(SecondMaster, ThatRunsTheArmIsToldWithEachIdentifierAndMovesNothing) {
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, {Step::deploy, 1.0, ""})) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: foreign_master}]");
  Rig rig(overrides);
  (void)reach(rig, {Step::deploy, 1.0, ""});
  const Times times = watch_stop(rig);
  EXPECT_GE(times.standstill_s, 0);
  EXPECT_GE(times.power_off_s, 0);
  EXPECT_LE(times.power_off_s, 0.1);
  std::set<std::int32_t> told;
  for (const Event& event : rig.events()) {
    if (event.kind == Event::Kind::fault && event.fault == Fault::second_master) told.insert(event.code);
  }
  EXPECT_EQ(told, (std::set<std::int32_t>{0x080, 0x201, 0x202, 0x203, 0x204, 0x205, 0x77F})) << rig.story();
  EXPECT_EQ(rig.count(Fault::second_master), 7u) << "each once, however long it sends";
  EXPECT_EQ(rig.outcome().fault, Fault::second_master);
}

// The shoulder hears no targets on its way out of a contact.
Rig without_targets(const std::string& make) {
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("drives.shoulder.profile=" + make);
  double at_s = 0;
  {
    Rig rehearsal(overrides);
    EXPECT_TRUE(reach(rehearsal, {Step::back_off, 0.1, ""})) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: drop_frames, can_id: 514}]");
  return Rig(overrides);
}

// That is no contact, wherever the arm is on its way: a joint that stays behind without a load is named.
TEST(LostTargets, NameTheJointThatStaysBehindWhereItsDriveHasNoDeadline) {
  Rig rig = without_targets("copley");
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::following_error) << rig.story();
  EXPECT_EQ(rig.outcome().code, 1) << "the shoulder";
}

TEST(LostTargets, AreToldByADriveThatHasADeadline) {
  Rig rig = without_targets("lanternfish");
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::drive_fault) << rig.story();
  EXPECT_EQ(rig.outcome().code, 1) << "the shoulder";
  EXPECT_EQ(rig.outcome().emcy, 0x8250);
}

TEST(DriveFault, NamesTheJointAndItsComplaint) {
  double at_s = 0;
  {
    Rig rehearsal(turn_only());
    ASSERT_TRUE(reach(rehearsal, {Step::deploy, 1.0, ""})) << rehearsal.story();
    at_s = rehearsal.now().s();
  }
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(at_s) + ", kind: overcurrent, node: elbow}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  rig.run_for(0.1);
  EXPECT_EQ(rig.outcome().fault, Fault::drive_fault) << rig.story();
  EXPECT_EQ(rig.outcome().code, 2);
  EXPECT_EQ(rig.outcome().emcy, 0x2310);
  bool told = false;
  for (const Event& event : rig.events()) told = told || (event.kind == Event::Kind::emcy && event.code == 3 && event.emcy == 0x2310);
  EXPECT_TRUE(told) << rig.story();
}

}  // namespace
}  // namespace lf::test
