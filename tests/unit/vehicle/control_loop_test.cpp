// The vehicle's control loop on a scripted platform: orders in, answers and reports out, and an orderly end.
#include "hal/vehicle/control_loop.hpp"

#include <gtest/gtest.h>

#include <set>

#include "hal/config/limits_file.hpp"
#include "hal/mock/failing_platform.hpp"
#include "hal/mock/scripted_platform.hpp"
#include "hal/vehicle/status_json.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::hal {
namespace {

class Loop : public testing::Test {
 protected:
  Loop() {
    arm5e_joint::fill(config.network.drives, canopen::DriveSetup{});
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      canopen::DriveSetup& drive = config.network.drives[i];
      drive.node = can_map::drive_nodes[i];
      drive.min_counts = -1000;
      drive.max_counts = 1000;
      drive.max_speed_counts_s = 500;
      drive.following_window_counts = 50;
    }
    config.limits = config.mission_limits = config::read_limits(LANTERNFISH_SOURCE_DIR "/shared/safety/limits.yaml", {});
    config.mission.tasks.clear();
    EXPECT_TRUE(config.mission.tasks.push_back({}));
    loop = std::make_unique<ControlLoop<FailingPlatform<ScriptedPlatform>>>(failing, config, *rings);
  }

  OrderAnswer give(Command command) {
    mission::Order order;
    order.command = command;
    platform.script_order({++number, order});
    turn();
    EXPECT_EQ(platform.order_answers().size(), 1u);
    if (platform.order_answers().empty()) return {};
    const OrderAnswer answer = platform.order_answers().front();
    platform.order_answers().clear();
    EXPECT_EQ(answer.number, number);
    return answer;
  }
  void turn() {
    loop->turn([](ControlReport&) {});
  }

  // From a stop until the mission is over: 1.2 s at the latest, in which the power goes.
  static constexpr int stop_turns = 325;
  bool ends_within(int turns) {
    for (int i = 0; i < turns && !loop->controller().mission().over(); ++i) turn();
    return loop->controller().mission().over();
  }

  // The nodes that were told NMT reset node.
  std::set<int> restarted() const {
    std::set<int> nodes;
    for (const ReceivedFrame& sent : platform.sent()) {
      if (sent.frame.id == 0 && sent.frame.data[0] == 0x81) nodes.insert(sent.frame.data[1]);
    }
    return nodes;
  }
  void hear_sync() {
    CanFrame sync;
    sync.id = 0x80;
    platform.script_frame(sync, Time{});
    turn();
  }
  static constexpr std::uint16_t position_lost = 0x7320;
  void begin_with_drives_that_tell_a_lost_position() {
    for (canopen::DriveSetup& drive : config.network.drives) ASSERT_TRUE(drive.profile.position_lost.push_back(position_lost));
    loop = std::make_unique<ControlLoop<FailingPlatform<ScriptedPlatform>>>(failing, config, *rings);
  }
  void lose_position(std::size_t joint) {
    CanFrame emcy;
    emcy.id = 0x80u + can_map::drive_nodes[joint];
    emcy.length = 8;
    emcy.data = {position_lost & 0xFF, position_lost >> 8, 0x20};
    platform.script_frame(emcy, Time{});
    turn();
  }
  const std::set<int> all_drives{can_map::drive_nodes.begin(), can_map::drive_nodes.end()};

  ControllerConfig config;
  ScriptedPlatform platform;
  FailingPlatform<ScriptedPlatform> failing{platform};
  std::unique_ptr<LoopRings> rings = std::make_unique<LoopRings>();
  std::unique_ptr<ControlLoop<FailingPlatform<ScriptedPlatform>>> loop;
  std::uint64_t number = 0;
  std::vector<int> grown;
};

TEST_F(Loop, AnswersEachOrderWithWhereTheMissionStood) {
  const OrderAnswer resumed = give(Command::resume);
  EXPECT_FALSE(resumed.taken);
  EXPECT_EQ(resumed.standing, mission::Standing::idle);
  EXPECT_TRUE(give(Command::start).taken);
  EXPECT_EQ(loop->controller().orders_refused(), 1u);
}

TEST_F(Loop, EndsByShutDownAndNotBefore) {
  for (int i = 0; i < 50; ++i) turn();
  EXPECT_FALSE(loop->stopped());
  EXPECT_TRUE(give(Command::shut_down).taken);
  int turns = 0;
  while (!loop->stopped() && turns < 1000) {
    turn();
    ++turns;
  }
  EXPECT_LT(turns, stop_turns + 50) << "drives that answer nothing are told to restart for as long as a stop takes";
  EXPECT_EQ(loop->controller().mission().step(), mission::Step::off);
}

TEST_F(Loop, ReportsTenTimesASecond) {
  for (int i = 0; i < 100; ++i) turn();
  int reports = 0;
  for (ControlReport report; rings->reports.pop(report);) ++reports;
  EXPECT_EQ(reports, 4);
}

TEST_F(Loop, FaultsOfTheVisionThreadReachTheCore) {
  ASSERT_TRUE(rings->vision_faults.push({Port::camera, 19}));
  turn();
  EXPECT_EQ(loop->controller().port_errors()[static_cast<std::size_t>(Port::camera)], 1u);
}

TEST_F(Loop, CountsEveryFailedCallByItsPort) {
  failing.fail(Call::send_can, 0, 105, 1'000'000);
  EXPECT_TRUE(give(Command::start).taken);
  for (int i = 0; i < 10; ++i) turn();
  EXPECT_GE(loop->controller().port_errors()[static_cast<std::size_t>(Port::can_send)], 9u);
  ControlReport report, newest;
  loop->report([](ControlReport&) {});
  while (rings->reports.pop(report)) newest = report;
  const Json counted = counters_json(newest, {}, {})["platform calls failed"];
  EXPECT_GE(counted.value("can send", 0), 9);
  EXPECT_FALSE(counted.contains("camera"));
}

TEST_F(Loop, MakesNoHeapCall) {
  platform.reserve_record(100'000);
  const std::uint64_t before = HeapGuard::calls();
  EXPECT_TRUE(give(Command::start).taken);
  for (int i = 0; i < 500; ++i) {
    turn();
    for (ControlReport report; rings->reports.pop(report);) {
    }
  }
  EXPECT_GT(platform.sent().size(), 500u) << "a SYNC a turn at least";
  ASSERT_LE(platform.sent().size(), 100'000u);
  if (!HeapGuard::available()) GTEST_SKIP() << "a sanitizer's allocator is not counted";
  EXPECT_EQ(HeapGuard::calls() - before, 0u);
  {
    const CoreSection counted;  // and the counter counts
    std::vector<int>(1000).swap(grown);
  }
  EXPECT_GT(HeapGuard::calls() - before, 0u);
}

TEST_F(Loop, NamesInTheStatusWhatCameAfterTheEnd) {
  ControlReport report;
  report.faults_after_end[static_cast<std::size_t>(safety::Fault::node_lost)] = 2;
  EXPECT_FALSE(status_json(report, {}, {}, {}).contains("faults since the end")) << "before the end there is none";
  report.outcome.ended = report.outcome.success = true;
  const Json status = status_json(report, {}, {}, {});
  EXPECT_EQ(status["success"], true);
  EXPECT_EQ(status["faults since the end"], (Json{{"node lost", 2}}));
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  turn();
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  turn();
  ControlReport newest;
  loop->report([](ControlReport&) {});
  while (rings->reports.pop(report)) newest = report;
  EXPECT_EQ(status_json(newest, {}, {}, {})["faults since the end"], (Json{{"emergency stop", 1}}));
}

TEST_F(Loop, AnOpenEmergencyStopInputStopsAndGoesOnDoingSo) {
  EXPECT_TRUE(give(Command::start).taken);
  EXPECT_EQ(loop->controller().mission().standing(), mission::Standing::starting);
  platform.script_estop(false);
  EXPECT_TRUE(ends_within(stop_turns));
  EXPECT_TRUE(give(Command::reset).taken);
  turn();
  EXPECT_TRUE(give(Command::start).taken);
  EXPECT_TRUE(ends_within(25 + stop_turns));  // the input is told again within 100 ms
}

TEST_F(Loop, AnEmergencyStopInputThatCannotBeReadIsOpen) {
  EXPECT_TRUE(give(Command::start).taken);
  failing.fail(Call::read_estop, failing.calls(Call::read_estop), 5, 1);
  EXPECT_TRUE(ends_within(stop_turns));
}

// The daemon may have been started anew beside drives that the one before left under power (6007 = 3 and 605A = 6).
TEST_F(Loop, AnEmergencyStopBeforeAnyBootRestartsEveryDrive) {
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  EXPECT_TRUE(ends_within(stop_turns));
  EXPECT_EQ(restarted(), all_drives);
}

TEST_F(Loop, AnOpenEmergencyStopInputBeforeAnyBootRestartsEveryDrive) {
  platform.script_estop(false);
  EXPECT_TRUE(ends_within(stop_turns));
  EXPECT_EQ(restarted(), all_drives);
}

TEST_F(Loop, AShutDownBeforeAnyBootRestartsEveryDrive) {
  EXPECT_TRUE(give(Command::shut_down).taken);
  EXPECT_TRUE(ends_within(2 * stop_turns));
  EXPECT_EQ(restarted(), all_drives);
}

TEST_F(Loop, AShutDownLeavesTheDrivesOfAnotherMasterAlone) {
  hear_sync();
  EXPECT_TRUE(give(Command::shut_down).taken);
  EXPECT_TRUE(ends_within(2 * stop_turns));
  EXPECT_TRUE(platform.sent().empty());
}

// Whoever presses it wants the arm without power, whoever leads it.
TEST_F(Loop, AnEmergencyStopRestartsTheDrivesOfAnotherMasterToo) {
  hear_sync();
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  EXPECT_TRUE(ends_within(stop_turns));
  EXPECT_EQ(restarted(), all_drives);
}

TEST_F(Loop, AnEmergencyStopIsTakenAnywhere) {
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  turn();
  EXPECT_EQ(loop->controller().mission().step(), mission::Step::off);
  EXPECT_FALSE(give(Command::start).taken);
  EXPECT_TRUE(give(Command::reset).taken);
  turn();
  EXPECT_EQ(loop->controller().mission().standing(), mission::Standing::idle);
  EXPECT_TRUE(give(Command::start).taken);
}

// New zeros bring a new core. It must not take the place of one that an emergency stop has ended, and with it the stop.
TEST_F(Loop, ACoreThatWasStoppedIsExchangedOnlyAfterItsReset) {
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  EXPECT_TRUE(ends_within(stop_turns));
  rings->cores.push(new Controller(config));
  for (int i = 0; i < 10; ++i) turn();
  Controller* old = nullptr;
  EXPECT_FALSE(rings->old_cores.pop(old));
  EXPECT_EQ(loop->controller().mission().standing(), mission::Standing::ended);
  EXPECT_FALSE(give(Command::home).taken);
  EXPECT_TRUE(give(Command::reset).taken);
  turn();
  turn();
  EXPECT_TRUE(rings->old_cores.pop(old));
  delete old;
  EXPECT_TRUE(give(Command::home).taken);
}

// The stop is in the mailbox of the core before, which has not turned since.
TEST_F(Loop, AStopAtACommissioningsEndIsNotLostWithTheCoreBefore) {
  Commissioning::Config setup;
  setup.network = config.network;
  Commissioning commissioning(setup);
  ASSERT_TRUE(rings->commissionings.push({&commissioning}));
  turn();
  EXPECT_TRUE(give(Command::emergency_stop).taken);
  rings->cores.push(new Controller(config));
  CommissioningResult result;
  for (int i = 0; i < 2000 && !rings->commissioned.pop(result); ++i) turn();
  ASSERT_EQ(result.commissioning, &commissioning);
  for (int i = 0; i < stop_turns; ++i) turn();
  Controller* old = nullptr;
  EXPECT_FALSE(rings->old_cores.pop(old));
  EXPECT_EQ(loop->controller().mission().standing(), mission::Standing::ended);
}

TEST_F(Loop, ANewCoreHasTheJobThatWasOrdered) {
  mission::Order order;
  order.command = Command::set_tasks;
  mission::Task turn_to;
  turn_to.to_rad = 0.25;
  ASSERT_TRUE(order.tasks.push_back(turn_to));
  platform.script_order({++number, order});
  turn();
  ASSERT_TRUE(platform.order_answers().front().taken);
  rings->cores.push(new Controller(config));
  turn();
  Controller* old = nullptr;
  ASSERT_TRUE(rings->old_cores.pop(old));
  delete old;
  ASSERT_EQ(loop->controller().mission().tasks().size(), 1u);
  EXPECT_EQ(loop->controller().mission().tasks()[0].task.to_rad, 0.25);
}

// The core that comes was made before the drive said so.
TEST_F(Loop, ANewCoreKnowsWhichZerosWereLostMeanwhile) {
  constexpr std::size_t jaw = 4;
  begin_with_drives_that_tell_a_lost_position();
  lose_position(jaw);
  rings->cores.push(new Controller(config));
  turn();
  Controller* old = nullptr;
  ASSERT_TRUE(rings->old_cores.pop(old));
  delete old;
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(loop->controller().network().axis(i).zero_lost(), i == jaw) << i;
}

TEST_F(Loop, AReportSaysHowOftenTheCoreWasExchangedBeforeIt) {
  const auto told = [&] {
    std::uint32_t newest = 0;
    for (ControlReport report; rings->reports.pop(report);) newest = report.cores_taken;
    return newest;
  };
  turn();
  EXPECT_EQ(told(), 0u);
  for (const std::uint32_t taken : {1u, 2u}) {
    rings->cores.push(new Controller(config));
    for (std::uint64_t i = 0; i < ticks_a_report; ++i) turn();
    Controller* old = nullptr;
    ASSERT_TRUE(rings->old_cores.pop(old));
    delete old;
    EXPECT_EQ(told(), taken);
  }
}

// A commissioning has the bus: the core does not hear what is said meanwhile.
TEST_F(Loop, TheCoreIsToldWhichZerosWereLostWhileAJointWasCommissioned) {
  constexpr std::size_t elbow = 2;
  begin_with_drives_that_tell_a_lost_position();
  Commissioning::Config setup;
  setup.network = config.network;
  Commissioning commissioning(setup);
  ASSERT_TRUE(rings->commissionings.push({&commissioning}));
  turn();
  lose_position(elbow);
  EXPECT_TRUE(give(Command::abort).taken);
  CommissioningResult result;
  for (int i = 0; i < 2000 && !rings->commissioned.pop(result); ++i) turn();
  ASSERT_EQ(result.commissioning, &commissioning);
  EXPECT_TRUE(loop->controller().network().axis(arm5e_joint::elbow).zero_lost());
  EXPECT_FALSE(loop->controller().network().axis(arm5e_joint::slew).zero_lost());
}

// An abort came before it began, or the control thread took it after its client had given up.
TEST_F(Loop, ACommissioningThatIsVoidOrLateDoesNotBegin) {
  Commissioning::Config setup;
  setup.network = config.network;
  Commissioning commissioning(setup);
  turn();
  turn();
  const auto begun = [&](bool is_void, Time expires) {
    rings->loan_is_void = is_void;
    EXPECT_TRUE(rings->commissionings.push({&commissioning, expires}));
    turn();
    CommissioningResult result;
    const bool came_back = rings->commissioned.pop(result);
    EXPECT_FALSE(came_back && result.begun);
    return !came_back;
  };
  const Time later = Time::from_s(1e6);
  EXPECT_FALSE(begun(true, later));
  EXPECT_FALSE(begun(false, Time{}));
  EXPECT_TRUE(begun(false, later));
  EXPECT_TRUE(give(Command::abort).taken);
}

// The core has heard it; the one that is lent was made before.
TEST_F(Loop, ACommissioningKnowsWhichZerosWereLostBeforeIt) {
  constexpr std::size_t jaw = 4;
  begin_with_drives_that_tell_a_lost_position();
  lose_position(jaw);
  Commissioning::Config setup;
  setup.network = config.network;
  Commissioning commissioning(setup);
  ASSERT_TRUE(rings->commissionings.push({&commissioning}));
  turn();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(commissioning.zeros_lost()[i], i == jaw) << i;
}

}  // namespace
}  // namespace lf::hal
