// Homing of one axis against a scripted drive, and what becomes of its zero.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/canopen/codec.hpp"
#include "tests/unit/canopen/axis_bench.hpp"

namespace lf::canopen {
namespace {

using test::AxisTest;
using test::Bus;
using test::ScriptedNode;

TEST_F(AxisTest, AbsoluteEncodersAreHomedFromTheStart) {
  EXPECT_TRUE(axis().homed());
  EXPECT_FALSE(elbow().homed());
  axis().request(AxisRequest::home);
  bus.step(2);
  EXPECT_EQ(axis().state(), AxisState::disabled);
  EXPECT_TRUE(axis().homed());
}

TEST_F(AxisTest, HomingRunsInItsModeAndEndsDisabledInCyclicMode) {
  elbow_drive().controlwords.clear();
  elbow().request(AxisRequest::home);
  bus.step(3);
  EXPECT_EQ(elbow().state(), AxisState::homing);
  ASSERT_TRUE(bus.run_until([&] { return elbow().homed(); }, Duration::from_ms(1400)));
  EXPECT_EQ(elbow().state(), AxisState::disabled);
  EXPECT_EQ(elbow().actual_counts(), -77);
  EXPECT_EQ(elbow_drive().object(0x6061, 0), 8u);
  EXPECT_EQ(elbow_drive().controlwords, (std::vector<std::uint16_t>{0x06, 0x07, 0x0F, 0x1F, 0x07, 0x06, 0x00}));
  ASSERT_TRUE(enable(elbow()));
  bus.step(5);
  EXPECT_EQ(elbow().target_counts(), -77);
}

TEST_F(AxisTest, AHomedZeroSurvivesABootThatTheMasterCauses) {
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().homed(); }, Duration::from_ms(1400)));
  ASSERT_TRUE(bus.boot());
  EXPECT_TRUE(elbow().homed());
}

// A drive that lost its power lost its zero, whenever that happened.
TEST_F(AxisTest, AHomedZeroDoesNotSurviveAPowerCycleAfterAFailedBoot) {
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().homed(); }, Duration::from_ms(1400)));
  bus.nodes[0].dead = true;
  ASSERT_FALSE(bus.boot());
  elbow_drive().reboot();
  bus.step(20);
  bus.nodes[0].dead = false;
  ASSERT_TRUE(bus.boot());
  EXPECT_FALSE(elbow().homed());
}

TEST_F(AxisTest, ADriveThatWasSilentMayHaveBeenWithoutPower) {
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().homed(); }, Duration::from_ms(1400)));
  elbow_drive().dead = true;
  bus.step(120);
  elbow_drive().dead = false;
  ASSERT_TRUE(bus.boot());
  EXPECT_FALSE(elbow().homed());
}

TEST_F(AxisTest, StatusBitsOfAnEarlierHomingAreNotTakenForThisOne) {
  elbow_drive().homing_cycles = 100;  // the script shows "attained" until the start bit arrives
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return (elbow().controlword() & 0x10) != 0; }, Duration::from_ms(500)));
  bus.step(50);
  EXPECT_FALSE(elbow().homed());
  EXPECT_EQ(elbow().state(), AxisState::homing);
  ASSERT_TRUE(bus.run_until([&] { return elbow().homed(); }, Duration::from_ms(800)));
}

TEST_F(AxisTest, AHomingErrorIsAFault) {
  elbow_drive().homing_fails = true;
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().fault() != AxisFault::none; }, Duration::from_ms(1000)));
  EXPECT_EQ(elbow().fault(), AxisFault::homing_error);
  EXPECT_FALSE(elbow().homed());
}

TEST_F(AxisTest, AHomingWithoutEndTimesOut) {
  elbow_drive().homing_cycles = 1'000'000;
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().fault() != AxisFault::none; }, Duration::from_ms(1600)));
  EXPECT_EQ(elbow().fault(), AxisFault::homing_timeout);
}

TEST_F(AxisTest, AHomingThatIsInterruptedReturnsToCyclicModeBeforeMoving) {
  elbow_drive().homing_cycles = 1'000'000;
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return (elbow().controlword() & 0x10) != 0; }, Duration::from_ms(500)));
  elbow().request(AxisRequest::quick_stop);
  bus.step(20);
  EXPECT_EQ(elbow().state(), AxisState::stopped);
  elbow_drive().targets_while_enabled.clear();
  ASSERT_TRUE(enable(elbow()));
  EXPECT_EQ(elbow_drive().object(0x6061, 0), 8u);
  EXPECT_FALSE(elbow().homed());
  ASSERT_FALSE(elbow_drive().targets_while_enabled.empty());
  for (const std::int32_t target : elbow_drive().targets_while_enabled) EXPECT_EQ(target, 1000);
}

TEST_F(AxisTest, AModeThatIsRefusedOrDoesNotFollowIsAFault) {
  elbow_drive().trick = ScriptedNode::Trick{ScriptedNode::Trick::What::abort, -1, 0x6060, 0x08000022, 1};
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().fault() != AxisFault::none; }, Duration::from_ms(500)));
  EXPECT_EQ(elbow().fault(), AxisFault::mode_refused);

  elbow().request(AxisRequest::reset_fault);
  bus.step(10);
  elbow_drive().ignores_mode = true;
  elbow().request(AxisRequest::home);
  ASSERT_TRUE(bus.run_until([&] { return elbow().fault() != AxisFault::none; }, Duration::from_ms(1000)));
  EXPECT_EQ(elbow().fault(), AxisFault::mode_refused);
}

}  // namespace
}  // namespace lf::canopen
