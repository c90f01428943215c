// The stop functions on a booted bus of scripted drives: when the quick stop and the power off are on the bus, read from the drives' side.
#include "firmware/safety/power.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "firmware/arm/actuator.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::safety {
namespace {

using canopen::test::ScriptedNode;
constexpr std::uint8_t unpowered = 0x40, enabled = 0x27, holding = 0x07;

class PowerTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bus.boot());
    enable_all();
  }
  void enable_all() {
    power.switch_on();
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) bus.network.axis(i).request(canopen::AxisRequest::hold_enabled);
    ASSERT_TRUE(bus.run_until([this] { return all_in(enabled); }, Duration::from_ms(500)));
  }

  bool all_in(std::uint8_t state) const {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      if (bus.nodes[i].drive_state_bits() != state) return false;
    }
    return true;
  }

  void step() {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      joints.fresh[i] = bus.network.axis(i).fresh(bus.now) && !taken_for_stale[i];
      joints.position_rad[i] += speed_rad_s[i] * 0.004;
      if (joints.fresh[i]) joints.velocity_rad_s[i] = speed_rad_s[i];
      joints.speed_known[i] = speeds_known;
      bus.nodes[i].actual_counts += static_cast<std::int32_t>(speed_rad_s[i] * 0.004 * 1e5);
    }
    power.tick(joints, bus.now, bus.network);
    bus.step();
  }

  // Seconds until `condition`; 10 when it never holds.
  double until(const std::function<bool()>& condition) {
    const Time began = bus.now;
    while (!condition() && bus.now - began < Duration::from_s(10)) step();
    return (bus.now - began).s();
  }

  // The elbow falls silent under way, with a ramp of so long before it. The others stand.
  void stop_with_the_elbow_silent(double ramp_s) {
    speed_rad_s[2] = ramp_s * deceleration_rad_s2;
    for (int i = 0; i < 6; ++i) step();
    bus.nodes[2].mute_tpdo = true;
    for (int i = 0; i < 6; ++i) step();
    speed_rad_s[2] = 0;
    power.stop(bus.now, bus.network);
  }

  static Limits limits() {
    Limits limits;
    arm5e_joint::fill(limits.joints, JointLimit{});
    limits.stale_position_s = 0.012;
    return limits;
  }

  static canopen::NetworkConfig config() {
    canopen::NetworkConfig config = canopen::test::plain_config();
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      config.drives[i].quick_stop_counts_s2 =
          static_cast<std::uint32_t>(deceleration_rad_s2 / std::abs(arm::rad_per_count(test::arm5e.joint(i), 0)));
    }
    return config;
  }

  static constexpr double deceleration_rad_s2 = 0.5;
  canopen::test::Bus bus{config()};
  Power power{test::arm5e};
  JointStates joints;
  bool speeds_known = true;
  PerJoint<bool> taken_for_stale{};  // by limits that are tighter than an axis'
  PerJoint<double> speed_rad_s{};
};

TEST_F(PowerTest, AStopTakesThePowerOfAnArmThatStands) {
  power.stop(bus.now, bus.network);
  step();
  step();
  EXPECT_TRUE(all_in(holding)) << "two cycles later every drive is in quick stop";
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.1) << "100 ms after standstill";
  EXPECT_LT(until([this] { return power.off(); }), 0.05);
}

TEST_F(PowerTest, AStopWaitsForAnArmThatMoves) {
  speed_rad_s[1] = 0.2;
  power.stop(bus.now, bus.network);
  for (int i = 0; i < 100; ++i) step();
  EXPECT_EQ(bus.nodes[1].drive_state_bits(), holding) << "still on its ramp";
  speed_rad_s[1] = 0;
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.1);
}

TEST_F(PowerTest, AStopEndsAtTheLatestAfterTwelveTenthsOfASecond) {
  speed_rad_s.fill(0.2);
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return all_in(unpowered); }), 1.2);
}

TEST_F(PowerTest, AStopReachesADriveThatIsSilentAndTheOthersDoNotWaitForIt) {
  bus.nodes[2].mute_tpdo = true;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.1) << "it stood when it was heard last";
  EXPECT_FALSE(power.off()) << "one drive has not said so";
  EXPECT_LT(until([this] { return power.off(); }), 1.1);
}

// Its speed over its deceleration, from where it was heard last. The others have stood for long.
TEST_F(PowerTest, ADriveThatWasSilencedUnderWayKeepsItsPowerUntilItsRampIsOver) {
  const double ramp_s = 0.3;
  stop_with_the_elbow_silent(ramp_s);
  const double lost_s = until([this] { return all_in(unpowered); });
  EXPECT_GT(lost_s, ramp_s - 0.01);
  EXPECT_LT(lost_s, ramp_s + 0.1);
}

// They stand, and do not wait under power for a ramp that nobody sees. The silent one is told to stop until it is over.
TEST_F(PowerTest, WhatIsHeardAndStandsDoesNotWaitForTheRampOfASilentDrive) {
  const double ramp_s = 0.3;
  stop_with_the_elbow_silent(ramp_s);
  const auto others_off = [this] {
    for (const std::size_t i : {0, 1, 3, 4}) {
      if (bus.nodes[i].drive_state_bits() != unpowered) return false;
    }
    return true;
  };
  EXPECT_LT(until(others_off), 0.1);
  EXPECT_EQ(bus.nodes[2].drive_state_bits(), holding) << "it may be on its ramp";
  const double lost_s = until([this] { return all_in(unpowered); });
  EXPECT_GT(lost_s, 0.15);
  EXPECT_LT(lost_s, ramp_s + 0.1);
}

// A screw without power may be driven back, and a brake takes its time.
TEST_F(PowerTest, ASilentDriveDoesNotWaitForAJointThatSagsWithoutPower) {
  bus.nodes[2].mute_tpdo = true;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  ASSERT_LT(until([this] { return bus.nodes[1].drive_state_bits() == unpowered; }), 0.1);
  speed_rad_s[1] = 0.2;
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.1);
}

// One that is too old for the limits, but not for its axis, may be on its ramp: it is not among those that stand.
TEST_F(PowerTest, WhatIsTooOldForTheLimitsIsNotTakenWithThoseThatStand) {
  speed_rad_s[0] = 0.2;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  for (int i = 0; i < 20; ++i) step();
  taken_for_stale[0] = true;
  for (int i = 0; i < 4; ++i) step();
  EXPECT_EQ(bus.nodes[0].drive_state_bits(), holding);
}

// No position is fresh for one tick in the middle of the ramp: what was left of it then is left still.
TEST_F(PowerTest, ALateTickInMidRampTakesNoPower) {
  const double began_rad_s = 0.2;
  for (int tick = 0; tick < 90; ++tick) {
    if (tick == 6) power.stop(bus.now, bus.network);
    speed_rad_s[1] = std::max(0.0, began_rad_s - deceleration_rad_s2 * std::max(0, tick - 8) * 0.004);
    for (ScriptedNode& node : bus.nodes) node.mute_tpdo = tick >= 70 && tick < 74;
    step();
    ASSERT_EQ(bus.nodes[1].drive_state_bits(), tick < 9 ? bus.nodes[1].drive_state_bits() : holding) << tick;
  }
}

// Its process data are lost both ways, and its own deadline takes it out of operation 100 ms after the stop: its ramp begins there.
TEST_F(PowerTest, ADriveThatLeavesOperationByItsDeadlineIsNotRestartedOnItsRamp) {
  const double ramp_s = 0.4;
  speed_rad_s[3] = ramp_s * deceleration_rad_s2;
  for (int i = 0; i < 6; ++i) step();
  bus.nodes[3].mute_tpdo = bus.nodes[3].ignores_controlword = true;
  power.stop(bus.now, bus.network);
  for (int i = 0; i < 25; ++i) step();
  const std::uint8_t id = bus.network.config().drives[3].node;
  CanFrame leave;
  leave.length = 2;
  leave.data = {128, id};
  bus.nodes[3].receive(leave, bus.now);
  const double restarted_s = until([this] { return bus.nodes[3].drive_state_bits() == unpowered; });
  EXPECT_GT(restarted_s, ramp_s - 0.02 / deceleration_rad_s2) << "until it stands";
  EXPECT_LT(restarted_s, ramp_s + 0.25);
}

// The laser's order to go off is lost: stopped by NMT, the node switches its outputs off by itself (6206, 6207).
TEST_F(PowerTest, OutputsThatStayOnAreStoppedByNmt) {
  ScriptedNode& outputs = bus.nodes[arm5e_joint::count];
  bus.network.io().set_outputs(can_map::output_laser);
  for (int i = 0; i < 6; ++i) step();
  ASSERT_EQ(outputs.outputs, can_map::output_laser);
  outputs.ignores_outputs = true;
  bus.network.io().set_outputs(0);
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([&] { return outputs.nmt() == 4; }), 0.03);
}

TEST_F(PowerTest, OutputsThatGoOffAreLeftInOperation) {
  ScriptedNode& outputs = bus.nodes[arm5e_joint::count];
  bus.network.io().set_outputs(can_map::output_laser);
  for (int i = 0; i < 6; ++i) step();
  bus.network.io().set_outputs(0);
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.2);
  EXPECT_EQ(outputs.nmt(), 5);
}

// It stands and is told to go down, and stays in quick stop.
TEST_F(PowerTest, ADriveThatIsTakenAndKeepsItsPowerIsRestartedWhileASilentOneBrakes) {
  stop_with_the_elbow_silent(0.4);
  ASSERT_TRUE(bus.run_until([this] { return bus.nodes[0].drive_state_bits() == holding; }, Duration::from_ms(20)));
  bus.nodes[0].ignores_controlword = true;
  EXPECT_LT(until([this] { return bus.nodes[0].drive_state_bits() == unpowered; }), 0.25);
  EXPECT_EQ(bus.nodes[2].drive_state_bits(), holding);
}

// One that is heard and moves keeps the others waiting: the arm stands when each of its joints does.
TEST_F(PowerTest, WhatIsHeardAndMovesKeepsThePowerOfTheOthers) {
  speed_rad_s[1] = 0.2;
  bus.nodes[2].mute_tpdo = true;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  for (int i = 0; i < 100; ++i) step();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(bus.nodes[i].drive_state_bits(), holding) << i;
}

// As in a commissioning: where no speed is observed, nor where the drive homes by itself, it may be braking for as long as any.
TEST_F(PowerTest, ASilentDriveOfUnknownSpeedIsGivenTheLongestRamp) {
  speeds_known = false;
  bus.nodes[2].mute_tpdo = true;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  const double lost_s = until([this] { return all_in(unpowered); });
  EXPECT_GT(lost_s, Power::unknown_ramp.s());
  EXPECT_LT(lost_s, Power::unknown_ramp.s() + 0.1);
}

// It does not hear its process data, or somebody took it out of operation: 6007 makes NMT stop a quick stop, and a restart takes any make's power.
TEST_F(PowerTest, ADriveThatDoesNotHeedIsStoppedAndThenRestartedByNmtAndTheOthersAreNot) {
  bus.nodes[3].ignores_controlword = true;
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return bus.nodes[3].nmt() == 4; }), 0.03) << "stopped";
  EXPECT_LT(until([this] { return bus.nodes[0].drive_state_bits() == unpowered; }), 0.35);
  EXPECT_EQ(bus.nodes[0].nmt(), 5) << "operational";
  EXPECT_LT(until([this] { return power.off(); }), 0.5);
  EXPECT_TRUE(all_in(unpowered)) << "by its restart";
  EXPECT_EQ(bus.nodes[0].nmt(), 5);
}

// The master is deaf: it cannot know which drive does not hear it.
TEST_F(PowerTest, WhereNoDriveIsHeardEachIsToldByProcessDataAndByNmt) {
  for (auto& node : bus.nodes) node.mute_tpdo = true;
  bus.nodes[3].ignores_controlword = true;
  for (int i = 0; i < 6; ++i) step();
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return bus.nodes[0].drive_state_bits() == holding; }), 0.012) << "the quick stop comes first";
  EXPECT_LT(until([this] { return bus.nodes[3].nmt() == 4 && bus.nodes[0].nmt() == 4; }), 0.024) << "stopped";
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.35) << "by their restart";
  EXPECT_LT(until([this] { return power.off(); }), 1.1);
}

// A frame of long ago, or before the boot, makes no later stop another one.
// NMT reset communication brings a boot-up, and some drives keep their power through it.
TEST_F(PowerTest, ABootUpThatNobodyOrderedDoesNotProveThatThereIsNoPower) {
  CanFrame reset_communication;
  reset_communication.length = 2;
  reset_communication.data = {130, can_map::drive_nodes[2]};
  for (const bool heard : {false, true}) {
    SCOPED_TRACE(heard);
    bus.nodes[2].receive(reset_communication, bus.now);
    if (heard) bus.network.on_frame(reset_communication, bus.now);
    for (int i = 0; i < 3; ++i) step();
    ASSERT_TRUE(bus.network.fault(2).rebooted);
    ASSERT_EQ(bus.nodes[2].drive_state_bits(), enabled);
    power.stop(bus.now, bus.network);
    EXPECT_LT(until([this] { return all_in(unpowered); }), 0.5) << "its ramp, and a restart";
    // The boot-up may be the other master's doing: it is told again, for a second.
    const double off_s = until([this] { return power.off(); });
    EXPECT_NEAR(off_s, heard ? 1.0 : 0.1, heard ? 0.2 : 0.1);
    if (heard) return;
    ASSERT_TRUE(bus.boot());
    enable_all();
  }
}

TEST_F(PowerTest, AnotherMastersNmtOfLongAgoChangesNoStop) {
  CanFrame frame;
  frame.id = 0;
  frame.length = 2;
  frame.data = {1, 99};
  bus.network.on_frame(frame, bus.now);
  for (int i = 0; i < 100; ++i) step();
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.3);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(bus.nodes[i].nmt(), 5) << "no node was stopped";
}

TEST_F(PowerTest, AMilderStopNeverTakesBackASeverer) {
  speed_rad_s.fill(0.2);
  power.remove(bus.now, bus.network);
  power.stop(bus.now, bus.network);
  power.lower(bus.now, bus.network);
  EXPECT_EQ(power.state(), Power::State::removing);
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.02);

  power.stop(bus.now, bus.network);
  for (int i = 0; i < 50; ++i) step();
  EXPECT_TRUE(power.off());
}

TEST_F(PowerTest, TheOrderlyWayDownGoesThroughEveryState) {
  bus.nodes[0].controlwords.clear();
  power.lower(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.2) << "no current in a motor";
  for (int i = 0; i < 20; ++i) step();
  EXPECT_EQ(bus.nodes[0].controlwords, (std::vector<std::uint16_t>{0x07, 0x06, 0x00}));
}

// The elbow's drive keeps its torque while its brake closes, and does not go down meanwhile.
TEST(PowerWithBrakes, TheOrderlyWayDownWaitsForTheSlowestBrake) {
  struct Case {
    int closes_ms;
    double removed_s;  // when the orderly way is given up
  };
  for (const Case& c : {Case{0, 0.7}, Case{500, 0.7}, Case{2000, 2.2}, Case{10'000, 10.2}}) {
    SCOPED_TRACE(c.closes_ms);
    canopen::NetworkConfig config = canopen::test::plain_config();
    config.drives[2].profile.brake_closes = Duration::from_ms(c.closes_ms);
    canopen::test::Bus bus(config);
    ASSERT_TRUE(bus.boot());
    canopen::Axis& elbow = bus.network.axis(arm5e_joint::elbow);
    elbow.request(canopen::AxisRequest::hold_enabled);
    ASSERT_TRUE(bus.run_until([&] { return elbow.enabled(); }, Duration::from_ms(500)));
    Power power{test::arm5e};
    power.switch_on();
    bus.nodes[2].ignores_controlword = true;
    const Time began = bus.now;
    power.lower(began, bus.network);
    while (power.state() == Power::State::lowering && bus.now - began < Duration::from_s(20)) {
      power.tick({}, bus.now, bus.network);
      bus.step();
    }
    EXPECT_NEAR((bus.now - began).s(), c.removed_s, 0.01);
  }
}

TEST_F(PowerTest, AStopOnTheOrderlyWayDownIsObeyed) {
  bus.nodes[1].ignores_controlword = true;  // its brake takes its time
  power.lower(bus.now, bus.network);
  for (int i = 0; i < 10; ++i) step();
  bus.nodes[1].ignores_controlword = false;
  power.stop(bus.now, bus.network);
  EXPECT_EQ(power.state(), Power::State::stopping);
  EXPECT_LT(until([this] { return all_in(unpowered); }), 0.1);
}

TEST_F(PowerTest, OffIsSaidAgainToADriveThatComesOnByItself) {
  power.remove(bus.now, bus.network);
  until([this] { return power.off(); });
  bus.network.axis(arm5e_joint::elbow).request(canopen::AxisRequest::hold_enabled);
  EXPECT_LT(until([this] { return !power.off(); }), 0.2);
  EXPECT_LT(until([this] { return power.off(); }), 0.1);
  EXPECT_TRUE(all_in(unpowered));
}

// The program before this one died: its drives made their quick stop (6007 = 3), and stay powered at its end (605A = 6). This one has sent nothing yet.
class PowerFromBefore : public PowerTest {
 protected:
  void SetUp() override {
    PowerTest::SetUp();
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      bus.nodes[i].set_object(0x605A, 0, 6, 2);
      bus.network.axis(i).request(canopen::AxisRequest::quick_stop);
    }
    ASSERT_TRUE(bus.run_until([this] { return all_in(holding); }, Duration::from_ms(100)));
    std::destroy_at(&bus.network);
    std::construct_at(&bus.network, canopen::test::plain_config());
    power = Power(test::arm5e);
    bus.log.clear();
    step();
    ASSERT_TRUE(all_in(holding));
    ASSERT_TRUE(bus.log.empty());
  }

  // NMT reset node to this drive and to no other node.
  int resets(std::size_t joint) const {
    return static_cast<int>(std::count_if(bus.log.begin(), bus.log.end(), [&](const CanFrame& frame) {
      return frame.id == 0 && frame.length == 2 && frame.data[0] == 0x81 && frame.data[1] == joint + 1;
    }));
  }
  bool only_resets() const {
    return std::all_of(bus.log.begin(), bus.log.end(), [](const CanFrame& frame) { return frame.id == 0 && frame.data[0] == 0x81; });
  }
};

TEST_F(PowerFromBefore, IsTakenByARestartWhenItIsOrderedOffBeforeAnyBoot) {
  power.remove(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.1);
  EXPECT_TRUE(all_in(unpowered));
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_GE(resets(i), 1) << i;
  EXPECT_TRUE(only_resets()) << "the bus is not run: no SYNC, no heartbeat";
}

TEST_F(PowerFromBefore, IsTakenByAStop) {
  power.stop(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.1);
  EXPECT_TRUE(all_in(unpowered));
}

TEST_F(PowerFromBefore, IsOffOnlyWhenTheDriveHasBootedUp) {
  bus.nodes[2].boot_ups_to_lose = 3;
  power.remove(bus.now, bus.network);
  EXPECT_GT(until([this] { return power.off(); }), 0.1);
  EXPECT_EQ(resets(2), 4);
  EXPECT_EQ(resets(0), 1) << "who has booted up is left alone";
}

TEST_F(PowerFromBefore, ADriveThatNeverAnswersIsToldForASecond) {
  bus.nodes[2].dead = true;
  power.remove(bus.now, bus.network);
  const double off_s = until([this] { return power.off(); });
  EXPECT_GE(off_s, 1.0);
  EXPECT_LT(off_s, 1.1);
  EXPECT_GE(resets(2), 10);
}

TEST_F(PowerFromBefore, AStopThatGoesOnRestartsNoDriveTwiceUnlessAnotherMasterSpoke) {
  power.remove(bus.now, bus.network);
  ASSERT_LT(until([this] { return power.off(); }), 0.1);
  power.remove(bus.now, bus.network);
  ASSERT_LT(until([this] { return power.off(); }), 0.1);
  EXPECT_EQ(resets(0), 1);
  CanFrame start;
  start.length = 2;
  start.data = {1, 1};
  bus.network.on_frame(start, bus.now);
  power.remove(bus.now, bus.network);
  ASSERT_NEAR(until([this] { return power.off(); }), 1.0, 0.1) << "a boot-up now may be the other master's doing";
  EXPECT_GT(resets(0), 2);
}

// Reset communication, with which a boot begins, takes no drive's power.
TEST_F(PowerFromBefore, IsTakenInTheMiddleOfABoot) {
  bus.network.start_boot(bus.now);
  for (int i = 0; i < 10; ++i) step();
  ASSERT_EQ(bus.network.boot().state, canopen::BootState::running);
  ASSERT_TRUE(all_in(holding));
  power.remove(bus.now, bus.network);
  EXPECT_LT(until([this] { return power.off(); }), 0.2);
  EXPECT_TRUE(all_in(unpowered));
}

}  // namespace
}  // namespace lf::safety
