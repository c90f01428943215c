// Power off reaches a drive in every state of CiA 402. The test reads the drive's own state and the controlwords that it was sent.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/canopen/codec.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen {
namespace {

using test::Bus;
using test::ScriptedNode;

constexpr std::uint8_t switch_on_disabled = 0x40, operation_enabled = 0x27, quick_stop_active = 0x07, fault_state = 0x08;

class PowerOff : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bus.boot()); }
  Axis& axis() { return bus.network.axis(arm5e_joint::slew); }
  ScriptedNode& drive() { return bus.nodes[0]; }
  bool enable() {
    axis().request(AxisRequest::hold_enabled);
    return bus.run_until([this] { return axis().enabled(); }, Duration::from_ms(500));
  }
  std::uint16_t word_sent() {
    for (const CanFrame& f : bus.sent) {
      if (f.id == 0x201) return get<std::uint16_t>(f, 0);
    }
    ADD_FAILURE() << "no RPDO";
    return 0xFFFF;
  }

  Bus bus{test::plain_config()};
};

TEST_F(PowerOff, OfAnEnabledDriveIsOnTheBusInTheSameCycle) {
  ASSERT_TRUE(enable());
  axis().request(AxisRequest::remove_power);
  bus.step();
  EXPECT_EQ(word_sent(), 0x00);
  bus.step(2);
  EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
  bus.step(3);
  EXPECT_FALSE(axis().powered());
  EXPECT_TRUE(axis().confirmed_unpowered(bus.now));
}

TEST_F(PowerOff, OfADriveThatHoldsInQuickStop) {
  ASSERT_TRUE(enable());
  axis().request(AxisRequest::quick_stop);
  bus.step(5);
  ASSERT_EQ(drive().drive_state_bits(), quick_stop_active) << "605A is 6: it stays";
  ASSERT_TRUE(axis().powered());
  axis().request(AxisRequest::remove_power);
  bus.step(5);
  EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
  EXPECT_FALSE(axis().powered());
}

// A latched fault keeps an axis in quick stop, but not against an order to go down: neither at once nor step by step.
TEST_F(PowerOff, IsNotKeptOffByALatchedFault) {
  for (const AxisRequest way : {AxisRequest::remove_power, AxisRequest::disable}) {
    ASSERT_TRUE(enable());
    drive().extra_status = 0x2000;  // bit 13: following error
    bus.step(6);
    ASSERT_EQ(axis().fault(), AxisFault::following_error);
    ASSERT_EQ(drive().drive_state_bits(), quick_stop_active);
    drive().extra_status = 0;
    axis().request(way);
    bus.step(20);
    EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
    EXPECT_EQ(axis().fault(), AxisFault::following_error) << "it stays known";
    axis().request(AxisRequest::reset_fault);
    bus.step(10);
  }
}

TEST_F(PowerOff, OfADriveInFaultNeverResetsTheFault) {
  ASSERT_TRUE(enable());
  drive().enter_fault(0x2310);
  bus.step(5);
  ASSERT_EQ(drive().drive_state_bits(), fault_state);
  drive().controlwords.clear();
  axis().request(AxisRequest::remove_power);
  bus.step(50);
  EXPECT_EQ(drive().drive_state_bits(), fault_state);
  EXPECT_FALSE(axis().powered()) << "a drive in fault has no current in its motor";
  for (const std::uint16_t word : drive().controlwords) EXPECT_EQ(word & 0x8F, 0x00);
}

// Its frames are lost, but it hears: what it said last must not decide what it is told.
TEST_F(PowerOff, OfADriveThatIsNotHeard) {
  for (const AxisRequest way : {AxisRequest::remove_power, AxisRequest::disable}) {
    ASSERT_TRUE(enable());
    drive().mute_tpdo = true;
    bus.step(6);
    ASSERT_EQ(axis().fault(), AxisFault::stale);
    axis().request(way);
    bus.step(5);
    EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
    EXPECT_FALSE(axis().confirmed_unpowered(bus.now)) << "nobody has said so";
    drive().mute_tpdo = false;
    bus.step(3);
    EXPECT_TRUE(axis().confirmed_unpowered(bus.now));
    axis().request(AxisRequest::reset_fault);
    bus.step(10);
  }
}

TEST_F(PowerOff, IsSaidAgainAndAgainToADriveThatComesBack) {
  ASSERT_TRUE(enable());
  drive().ignores_controlword = true;
  axis().request(AxisRequest::remove_power);
  bus.step(100);
  EXPECT_EQ(drive().drive_state_bits(), operation_enabled);
  EXPECT_TRUE(axis().powered());
  EXPECT_EQ(word_sent(), 0x00);
  drive().ignores_controlword = false;
  bus.step(2);
  EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
}

TEST_F(PowerOff, ComesBeforeTheNodesAreStopped) {
  ASSERT_TRUE(enable());
  bus.network.shut_down();
  bus.step(10);
  EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled) << "a stopped node with power holds its current for ever";
  for (const ScriptedNode& node : bus.nodes) EXPECT_EQ(node.nmt(), 4);
}

// Found by fuzz_can_core: an order that came after it, and before the nodes were stopped, left a drive with power for ever.
TEST_F(PowerOff, OfAShutDownIsNotTurnedByALaterOrder) {
  ASSERT_TRUE(enable());
  bus.network.shut_down();
  for (int i = 0; i < 10; ++i) {
    axis().request(AxisRequest::hold_enabled);
    bus.step();
    EXPECT_FALSE(axis().enabled()) << "SYNC " << i;
  }
  EXPECT_EQ(drive().drive_state_bits(), switch_on_disabled);
}

}  // namespace
}  // namespace lf::canopen
