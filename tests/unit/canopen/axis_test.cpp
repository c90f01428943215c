// One axis through the network against a scripted drive: enabling, stopping, faults, and what a target may do.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/canopen/codec.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/axis_bench.hpp"

namespace lf::canopen {
namespace {

using test::AxisTest;
using test::Bus;
using test::ScriptedNode;

TEST_F(AxisTest, StartsDisabledAndStaysSoUntilAsked) {
  bus.step(100);
  EXPECT_EQ(axis().state(), AxisState::disabled);
  EXPECT_EQ(drive().drive_state_bits(), 0x40);
  EXPECT_TRUE(std::all_of(drive().controlwords.begin(), drive().controlwords.end(), [](std::uint16_t w) { return w == 0; }));
}

TEST_F(AxisTest, IsEnabledThroughEveryStateInOrder) {
  drive().controlwords.clear();
  ASSERT_TRUE(enable(axis()));
  EXPECT_EQ(drive().controlwords, (std::vector<std::uint16_t>{0x06, 0x07, 0x0F}));
  bus.step(100);
  EXPECT_TRUE(axis().enabled());
  EXPECT_EQ(axis().fault(), AxisFault::none);
}

TEST_F(AxisTest, EachControlwordIsHeldForThreeSyncs) {
  bus.step(5);
  axis().request(AxisRequest::hold_enabled);
  std::vector<std::pair<std::uint16_t, int>> runs;
  for (int i = 0; i < 30; ++i) {
    bus.step();
    const auto word = get<std::uint16_t>(last_rpdo(), 0);
    if (runs.empty() || runs.back().first != word) runs.emplace_back(word, 0);
    ++runs.back().second;
  }
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_GE(runs[0].second, 3);
  EXPECT_GE(runs[1].second, 3);
}

TEST_F(AxisTest, TheTargetIsTheActualPositionAtTheMomentOfEnabling) {
  drive().actual_counts = -12'345;
  drive().targets_while_enabled.clear();
  bus.step(5);
  ASSERT_TRUE(enable(axis()));
  bus.step(50);
  ASSERT_GE(drive().targets_while_enabled.size(), 10u);
  for (const std::int32_t target : drive().targets_while_enabled) EXPECT_EQ(target, -12'345);
}

TEST_F(AxisTest, AJointMovedByHandWhileDisabledDoesNotJumpBackWhenEnabled) {
  ASSERT_TRUE(enable(axis()));
  ASSERT_TRUE(axis().set_target_counts(1020));
  bus.step(10);
  axis().request(AxisRequest::disable);
  ASSERT_TRUE(bus.run_until([&] { return axis().state() == AxisState::disabled; }, Duration::from_ms(500)));
  drive().actual_counts = 30'000;
  drive().targets_while_enabled.clear();
  bus.step(2);
  ASSERT_TRUE(enable(axis()));
  bus.step(20);
  ASSERT_GE(drive().targets_while_enabled.size(), 20u);
  for (const std::int32_t target : drive().targets_while_enabled) EXPECT_EQ(target, 30'000);
}

TEST_F(AxisTest, FollowsTargetsNoFasterThanTheMaximumSpeed) {
  ASSERT_TRUE(enable(axis()));
  drive().targets_while_enabled.clear();
  ASSERT_TRUE(axis().set_target_counts(2000));
  bus.step(60);
  EXPECT_EQ(axis().actual_counts(), 2000);
  ASSERT_GE(drive().targets_while_enabled.size(), 25u) << "1000 counts at 40 a cycle";
  std::int32_t last = 1000;
  for (const std::int32_t target : drive().targets_while_enabled) {
    EXPECT_LE(target - last, 41);  // 10,000 counts/s in 4 ms, and one for rounding
    EXPECT_GE(target, last);
    last = target;
  }
  EXPECT_GT(axis().stats().targets_limited, 10u);
}

TEST_F(AxisTest, ACoarseEncodersTargetKeepsTheMaximumSpeedOnAverage) {
  NetworkConfig coarse = config();
  coarse.drives[0].max_speed_counts_s = 60;  // a count in four cycles
  Bus slow(coarse);
  ASSERT_TRUE(slow.boot());
  Axis& a = slow.network.axis(arm5e_joint::slew);
  a.request(AxisRequest::hold_enabled);
  ASSERT_TRUE(slow.run_until([&a] { return a.enabled(); }, Duration::from_ms(500)));
  const std::int32_t start = a.target_counts();
  ASSERT_TRUE(a.set_target_counts(start + 1000));
  slow.step(250);  // 1 s
  EXPECT_NEAR(a.target_counts() - start, 60, 2);
}

TEST_F(AxisTest, KeepsTheSpeedOfThePoseWhereItIs) {
  ASSERT_TRUE(enable(axis()));
  axis().set_limits_here({.max_speed_counts_s = 2500, .following_window_counts = 500});
  ASSERT_TRUE(axis().set_target_counts(2000));
  bus.step(50);
  EXPECT_NEAR(axis().target_counts(), 1500, 1) << "10 counts a period";
  axis().set_limits_here({.max_speed_counts_s = 5000, .following_window_counts = 500});
  bus.step(20);
  EXPECT_NEAR(axis().target_counts(), 1900, 2) << "20 counts a period";
}

TEST_F(AxisTest, WatchesTheWindowOfThePoseWhereItIs) {
  ASSERT_TRUE(enable(axis()));
  axis().set_limits_here({.max_speed_counts_s = 10'000, .following_window_counts = 100});
  drive().jammed = true;
  ASSERT_TRUE(axis().set_target_counts(1100));
  bus.step(100);
  EXPECT_EQ(axis().fault(), AxisFault::none);
  ASSERT_TRUE(axis().set_target_counts(1101));
  bus.step(40);
  EXPECT_EQ(axis().fault(), AxisFault::following_error);
}

TEST_F(AxisTest, APoseAllowsNoMoreThanTheSetUp) {
  axis().set_limits_here({.max_speed_counts_s = 1'000'000, .following_window_counts = 1'000'000});
  EXPECT_EQ(axis().limits_here().max_speed_counts_s, 10'000u);
  EXPECT_EQ(axis().limits_here().following_window_counts, 500u);
}

TEST_F(AxisTest, TargetsOutsideTheLimitsOrWhileNotEnabledAreRefusedAndCounted) {
  EXPECT_FALSE(axis().set_target_counts(1000));
  ASSERT_TRUE(enable(axis()));
  EXPECT_FALSE(axis().set_target_counts(50'001));
  EXPECT_FALSE(axis().set_target_counts(-50'001));
  EXPECT_TRUE(axis().set_target_counts(1010));
  EXPECT_EQ(axis().stats().targets_refused, 3u);
  bus.step(10);
  EXPECT_EQ(axis().actual_counts(), 1010);
}

// Where it was powered it may stand; what brings it back is taken, what leads on is not.
TEST_F(AxisTest, OneEnabledOutsideItsLimitsCanOnlyComeBack) {
  drive().actual_counts = 50'300;
  bus.step(5);
  ASSERT_TRUE(enable(axis()));
  EXPECT_EQ(axis().target_counts(), 50'300);
  EXPECT_TRUE(axis().set_target_counts(50'300));
  EXPECT_FALSE(axis().set_target_counts(50'301));
  EXPECT_TRUE(axis().set_target_counts(50'200));
  bus.step(20);
  ASSERT_EQ(axis().target_counts(), 50'200);
  EXPECT_FALSE(axis().set_target_counts(50'201)) << "it has come as far as 50,200";
  EXPECT_TRUE(axis().set_target_counts(49'900));
  bus.step(50);
  EXPECT_FALSE(axis().set_target_counts(50'001)) << "the limits are the limits again";
  EXPECT_FALSE(axis().set_target_counts(-50'001));
}

TEST_F(AxisTest, ReportsValuesWithTheSyncTheyWereLatchedAt) {
  drive().actual_counts = 4711;
  drive().torque_permille = -250;
  const Time sync = bus.now;
  bus.step();
  EXPECT_EQ(axis().actual_counts(), 4711);
  EXPECT_EQ(axis().torque_permille(), -250);
  EXPECT_EQ(axis().actual_time(), sync);
}

TEST_F(AxisTest, TorqueFeedForwardIsLimitedAndEndsWithTheAxis) {
  axis().set_torque_offset_permille(100);
  bus.step();
  EXPECT_EQ(get<std::int16_t>(last_rpdo(), 6), 0);
  ASSERT_TRUE(enable(axis()));
  axis().set_torque_offset_permille(-5000);
  bus.step();
  EXPECT_EQ(get<std::int16_t>(last_rpdo(), 6), -1200);
  axis().request(AxisRequest::disable);
  bus.step();
  EXPECT_EQ(get<std::int16_t>(last_rpdo(), 6), 0);
}

TEST_F(AxisTest, DisablingGoesDownThroughEveryState) {
  ASSERT_TRUE(enable(axis()));
  drive().controlwords.clear();
  axis().request(AxisRequest::disable);
  ASSERT_TRUE(bus.run_until([&] { return axis().state() == AxisState::disabled; }, Duration::from_ms(500)));
  bus.step(5);
  EXPECT_EQ(drive().controlwords, (std::vector<std::uint16_t>{0x07, 0x06, 0x00}));
}

TEST_F(AxisTest, AQuickStopActsAtOnceHoldsAndIsLeftUnderPower) {
  ASSERT_TRUE(enable(axis()));
  bus.step(1);
  axis().request(AxisRequest::quick_stop);
  bus.step();
  EXPECT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0x02);
  bus.step(3);
  EXPECT_EQ(axis().state(), AxisState::stopped);
  EXPECT_EQ(axis().drive_state(), DriveState::quick_stop_active);
  bus.step(200);
  EXPECT_EQ(axis().state(), AxisState::stopped);
  drive().controlwords.clear();
  ASSERT_TRUE(enable(axis()));
  EXPECT_EQ(drive().controlwords, std::vector<std::uint16_t>{0x0F}) << "transition 16, the power never goes";
}

TEST_F(AxisTest, AQuickStopThatLosesPowerIsLeftThroughSwitchOnDisabled) {
  Axis& shoulder = bus.network.axis(arm5e_joint::shoulder);
  ASSERT_TRUE(enable(shoulder));
  shoulder.request(AxisRequest::quick_stop);
  ASSERT_TRUE(bus.run_until([&] { return shoulder.state() == AxisState::stopped; }, Duration::from_ms(100)));
  EXPECT_EQ(shoulder.drive_state(), DriveState::switch_on_disabled);
  EXPECT_EQ(shoulder.fault(), AxisFault::none);
  EXPECT_TRUE(enable(shoulder));
}

TEST_F(AxisTest, AQuickStopDoesNotWaitForAHandshake) {
  axis().request(AxisRequest::hold_enabled);
  bus.step();  // a new controlword has just been sent
  axis().request(AxisRequest::quick_stop);
  bus.step();
  EXPECT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0x02);
}

TEST_F(AxisTest, ADriveFaultIsLatchedAndNothingRestartsByItself) {
  ASSERT_TRUE(enable(axis()));
  drive().enter_fault(0x4210);
  bus.step(3);
  EXPECT_EQ(axis().state(), AxisState::fault);
  EXPECT_EQ(axis().fault(), AxisFault::drive_fault);
  EXPECT_EQ(bus.network.fault(0).emcy_code, 0x4210);
  axis().request(AxisRequest::hold_enabled);
  bus.step(100);
  EXPECT_EQ(axis().state(), AxisState::fault);
  EXPECT_EQ(drive().drive_state_bits(), 0x08);
}

TEST_F(AxisTest, FaultResetIsOneRisingEdgeAndEndsDisabled) {
  ASSERT_TRUE(enable(axis()));
  drive().enter_fault(0x8611);
  bus.step(10);
  drive().controlwords.clear();
  axis().request(AxisRequest::reset_fault);
  ASSERT_TRUE(bus.run_until([&] { return axis().state() == AxisState::disabled; }, Duration::from_ms(500)));
  bus.step(5);
  EXPECT_EQ(drive().controlwords, (std::vector<std::uint16_t>{0x80, 0x00}));
  EXPECT_EQ(axis().fault(), AxisFault::none);
  EXPECT_EQ(axis().requested(), AxisRequest::disable);
  EXPECT_TRUE(enable(axis()));
}

TEST_F(AxisTest, BitSevenWasLowForAHandshakeBeforeItRises) {
  ASSERT_TRUE(enable(axis()));
  drive().enter_fault(0x8611);
  bus.step();  // the statusword with the fault is on its way while the axis is still told to run
  std::vector<std::uint16_t> words;
  for (int i = 0; i < 20; ++i) {
    if (i == 1) axis().request(AxisRequest::reset_fault);
    bus.step();
    words.push_back(get<std::uint16_t>(last_rpdo(), 0));
  }
  const auto rise = std::find(words.begin(), words.end(), 0x80);
  ASSERT_NE(rise, words.end());
  ASSERT_GE(rise - words.begin(), 3);
  EXPECT_TRUE(std::all_of(rise - 3, rise, [](std::uint16_t word) { return (word & 0x80) == 0; }));
  EXPECT_EQ(drive().drive_state_bits(), 0x40);
}

// Found by fuzz_can_core: the drive was told to run for as long as it said that it reacts to its fault.
TEST_F(AxisTest, AResetOrderedInADrivesFaultReactionTakesTheEnablingWordAway) {
  ASSERT_TRUE(enable(axis()));
  CanFrame tpdo = empty_frame(0x181, 8);
  put<std::uint16_t>(tpdo, 0, 0x0F);  // fault reaction active
  put<std::int32_t>(tpdo, 2, 1000);
  drive().mute_tpdo = true;
  axis().request(AxisRequest::reset_fault);
  for (int i = 0; i < 20; ++i) {
    bus.network.on_frame(tpdo, bus.now);
    bus.step();
    ASSERT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0) << "SYNC " << i;
  }
  EXPECT_EQ(axis().state(), AxisState::resetting);
}

TEST_F(AxisTest, AFaultThatDoesNotClearIsTriedThreeTimesThenReported) {
  drive().refuses_reset = true;
  drive().enter_fault(0x2310);
  bus.step(5);
  drive().controlwords.clear();
  axis().request(AxisRequest::reset_fault);
  ASSERT_TRUE(bus.run_until([&] { return axis().state() == AxisState::fault; }, Duration::from_ms(2000)));
  EXPECT_EQ(axis().fault(), AxisFault::reset_refused);
  EXPECT_EQ(std::count(drive().controlwords.begin(), drive().controlwords.end(), 0x80), 3);
}

TEST_F(AxisTest, FollowingErrorStopsTheAxisBeforeTheDriveFaults) {
  ASSERT_TRUE(enable(axis()));
  drive().extra_status = 0x3000;
  bus.step();
  EXPECT_TRUE(axis().following_error());
  bus.step();
  EXPECT_EQ(axis().fault(), AxisFault::following_error);
  EXPECT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0x02);
}

TEST_F(AxisTest, TellsWhetherTheDriveFollowsItsTarget) {
  ASSERT_TRUE(enable(axis()));
  EXPECT_TRUE(axis().drive_follows());
  drive().extra_status = 0;
  bus.step();
  EXPECT_FALSE(axis().drive_follows());
}

TEST_F(AxisTest, AMissingTpdoIsStaleAfterThreeCyclesAndStopsTheAxis) {
  ASSERT_TRUE(enable(axis()));
  drive().mute_tpdo = true;
  bus.step(3);
  EXPECT_TRUE(axis().fresh(bus.now - Duration::from_ms(4)));
  EXPECT_EQ(axis().fault(), AxisFault::none);
  EXPECT_FALSE(axis().fresh(bus.now));
  bus.step();
  EXPECT_EQ(axis().fault(), AxisFault::stale);
  EXPECT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0x02);
  drive().mute_tpdo = false;
  bus.step(50);
  EXPECT_EQ(axis().state(), AxisState::fault) << "no restart by itself";
  axis().request(AxisRequest::reset_fault);
  bus.step(20);
  EXPECT_TRUE(enable(axis()));
}

TEST_F(AxisTest, TwoMissingTpdosAreBorne) {
  ASSERT_TRUE(enable(axis()));
  drive().mute_tpdo = true;
  bus.step(2);
  drive().mute_tpdo = false;
  bus.step(10);
  EXPECT_TRUE(axis().enabled());
}

TEST_F(AxisTest, SafeTorqueOffIsReportedAsDroppedOut) {
  ASSERT_TRUE(enable(axis()));
  CanFrame tpdo = empty_frame(0x181, 8);
  put<std::uint16_t>(tpdo, 0, 0x40);
  put<std::int32_t>(tpdo, 2, 1000);
  drive().mute_tpdo = true;
  drive().send(tpdo);
  bus.step(2);
  EXPECT_EQ(axis().fault(), AxisFault::dropped_out);
  EXPECT_EQ(get<std::uint16_t>(last_rpdo(), 0), 0x02);
}

TEST_F(AxisTest, ADriveThatIgnoresItsControlwordTimesOut) {
  drive().ignores_controlword = true;
  axis().request(AxisRequest::hold_enabled);
  EXPECT_FALSE(bus.run_until([&] { return axis().fault() != AxisFault::none; }, Duration::from_ms(390)));
  EXPECT_TRUE(bus.run_until([&] { return axis().fault() != AxisFault::none; }, Duration::from_ms(50)));
  EXPECT_EQ(axis().fault(), AxisFault::transition_timeout);
}

TEST_F(AxisTest, AStatuswordTheStandardDoesNotHaveIsCountedAndStopsTheAxis) {
  ASSERT_TRUE(enable(axis()));
  drive().mute_tpdo = true;
  CanFrame tpdo = empty_frame(0x181, 8);
  put<std::uint16_t>(tpdo, 0, 0x0001);
  drive().send(tpdo);
  bus.step(2);
  EXPECT_EQ(axis().stats().unknown_states, 1u);
  EXPECT_EQ(axis().state(), AxisState::fault);
}

TEST_F(AxisTest, RequestsBeforeTheBootAreForgotten) {
  Bus fresh(config());
  fresh.network.axis(arm5e_joint::slew).request(AxisRequest::hold_enabled);
  ASSERT_TRUE(fresh.boot());
  fresh.step(100);
  EXPECT_EQ(fresh.network.axis(arm5e_joint::slew).state(), AxisState::disabled);
}

// A drive with a brake leaves Operation enabled only when the brake is closed. 0.4 s are a transition's own time here.
TEST_F(AxisTest, TheTimeThatTheBrakeTakesToCloseIsWaitedFor) {
  for (const int closes_ms : {0, 2000}) {
    SCOPED_TRACE(closes_ms);
    NetworkConfig with_brake = config();
    with_brake.drives[0].profile.brake_closes = Duration::from_ms(closes_ms);
    Bus braked(with_brake);
    ASSERT_TRUE(braked.boot());
    Axis& one = braked.network.axis(arm5e_joint::slew);
    one.request(AxisRequest::hold_enabled);
    ASSERT_TRUE(braked.run_until([&] { return one.enabled(); }, Duration::from_ms(500)));
    braked.nodes[0].ignores_controlword = true;
    one.request(AxisRequest::disable);
    const auto faulted = [&] { return one.fault() != AxisFault::none; };
    EXPECT_FALSE(braked.run_until(faulted, Duration::from_ms(closes_ms + 390)));
    EXPECT_TRUE(braked.run_until(faulted, Duration::from_ms(50))) << "for no longer than the brake may take";
    EXPECT_EQ(one.fault(), AxisFault::transition_timeout);
  }
}

TEST_F(AxisTest, TargetsStandStillUntilTheBrakeIsOpen) {
  NetworkConfig braked = config();
  braked.drives[0].profile.brake_opens = Duration::from_ms(200);
  Bus slow(braked);
  ASSERT_TRUE(slow.boot());
  Axis& slew = slow.network.axis(arm5e_joint::slew);
  slew.request(AxisRequest::hold_enabled);
  ASSERT_TRUE(slow.run_until([&] { return slew.drive_state() == DriveState::operation_enabled; }, Duration::from_ms(400)));
  const Time powered = slow.now;
  EXPECT_FALSE(slew.enabled());
  EXPECT_FALSE(slew.set_target_counts(1100));
  ASSERT_TRUE(slow.run_until([&] { return slew.enabled(); }, Duration::from_ms(400)));
  EXPECT_NEAR((slow.now - powered).s(), 0.2, 0.01);
  EXPECT_TRUE(slew.set_target_counts(1100));
}

TEST_F(AxisTest, PositionsAndTorquesAreInTheDrivesUnitsOnTheBusAndInTheArmsInside) {
  NetworkConfig other = config();
  other.drives[0].profile.scale.position = {225, 4};
  other.drives[0].profile.scale.torque = {1092, 1000};
  other.drives[0].profile.scale.sign = -1;
  other.drives[0].encoder_zero_counts = 100;
  Bus changed(other);
  ASSERT_TRUE(changed.boot());
  changed.nodes[0].actual_counts = -56'250;
  changed.nodes[0].torque_permille = -546;
  changed.step(3);
  Axis& slew = changed.network.axis(arm5e_joint::slew);
  EXPECT_EQ(slew.actual_counts(), 900);
  EXPECT_EQ(slew.torque_permille(), 500);
  slew.request(AxisRequest::hold_enabled);
  ASSERT_TRUE(changed.run_until([&] { return slew.enabled(); }, Duration::from_ms(500)));
  ASSERT_TRUE(slew.set_target_counts(910));
  changed.step(3);
  EXPECT_EQ(changed.nodes[0].targets_while_enabled.back(), -56'813);  // (910 + 100) x 56.25, halves away from zero
}

TEST_F(AxisTest, TheMasterTimesTheFollowingErrorOfADriveThatDoesNotAndTwiceAsLongOfOneThatDoes) {
  int ticks[2] = {0, 0};
  for (const bool times : {false, true}) {
    NetworkConfig other = config();
    other.drives[0].profile.master_times_following = times;
    Bus changed(other);
    ASSERT_TRUE(changed.boot());
    Axis& slew = changed.network.axis(arm5e_joint::slew);
    slew.request(AxisRequest::hold_enabled);
    ASSERT_TRUE(changed.run_until([&] { return slew.enabled(); }, Duration::from_ms(500)));
    changed.nodes[0].jammed = true;
    ASSERT_TRUE(slew.set_target_counts(3000));
    for (int& n = ticks[times]; n < 200 && slew.fault() == AxisFault::none; ++n) changed.step(1);
    EXPECT_EQ(slew.fault(), AxisFault::following_error);
  }
  // The target takes as long to leave the window both times.
  EXPECT_NEAR(4.0 * (ticks[0] - ticks[1]), config().drives[0].following_timeout_ms, 4);
}

}  // namespace
}  // namespace lf::canopen
