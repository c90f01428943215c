#include "host_sim/devices/canopen/node.hpp"

#include <gtest/gtest.h>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

std::vector<int> heartbeats(const std::vector<CanFrame>& frames) {
  std::vector<int> states;
  for (const CanFrame& f : frames) {
    if (f.id == 0x703) states.push_back(f.length == 1 ? f.data[0] : -1);
  }
  return states;
}

TEST(Node, boot_up_comes_once_after_the_boot_time) {
  DriveConfig config = elbow();
  Drive402 drive(config, Duration::from_ms(5), 1);
  Client client(drive.node());
  drive.power_on(client.now, {});
  for (int ms = 1; ms <= 20; ++ms) {
    client.now = Time::from_ns(ms * 1'000'000);
    drive.tick(client.now, {});
    EXPECT_EQ(heartbeats(client.take()), ms == 5 ? std::vector<int>{0} : std::vector<int>{}) << ms;
  }
  EXPECT_EQ(drive.node().state(), NmtState::pre_operational);
}

TEST(Node, a_booting_node_is_deaf) {
  DriveRig rig;
  rig.client.nmt(129);
  EXPECT_EQ(rig.client.sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).length, 0);
  rig.client.nmt(1);
  EXPECT_EQ(rig.drive.node().state(), NmtState::booting);
}

struct NmtRow {
  NmtState from;
  std::uint8_t command;
  NmtState to;
};

TEST(Node, every_nmt_command_does_in_every_state_what_cia_301_says) {
  const NmtState pre = NmtState::pre_operational, op = NmtState::operational, stop = NmtState::stopped, boot = NmtState::booting;
  const NmtRow table[] = {{pre, 1, op},     {pre, 2, stop},    {pre, 128, pre},   {pre, 129, boot}, {pre, 130, boot}, {op, 1, op},
                          {op, 2, stop},    {op, 128, pre},    {op, 129, boot},   {op, 130, boot},  {stop, 1, op},    {stop, 2, stop},
                          {stop, 128, pre}, {stop, 129, boot}, {stop, 130, boot}, {pre, 77, pre},   {op, 77, op},     {stop, 77, stop}};
  for (const NmtRow& row : table) {
    DriveRig rig;
    if (row.from == op) rig.client.nmt(1);
    if (row.from == stop) rig.client.nmt(2);
    ASSERT_EQ(rig.drive.node().state(), row.from);
    rig.client.nmt(row.command);
    EXPECT_EQ(rig.drive.node().state(), row.to) << static_cast<int>(row.from) << " command " << static_cast<int>(row.command);
    if (row.to != boot) continue;
    rig.run_ms(25);
    EXPECT_EQ(rig.drive.node().state(), pre);
  }
}

TEST(Node, commands_for_others_are_ignored_and_those_for_all_are_not) {
  DriveRig rig;
  rig.client.send(0, {1, 4});
  EXPECT_EQ(rig.drive.node().state(), NmtState::pre_operational);
  rig.client.send(0, {1});
  EXPECT_EQ(rig.drive.node().state(), NmtState::pre_operational) << "a short frame";
  rig.client.send(0, {1, 0});
  EXPECT_EQ(rig.drive.node().state(), NmtState::operational);
}

TEST(Node, a_stopped_node_answers_no_sdo_but_beats) {
  DriveRig rig;
  rig.client.write(0x1017, 0, 10, 2);
  rig.client.nmt(2);
  EXPECT_EQ(rig.client.sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).length, 0);
  rig.sent.clear();
  rig.run_ms(50);
  const std::vector<int> beats = heartbeats(rig.sent);
  EXPECT_NEAR(static_cast<double>(beats.size()), 5, 1);
  for (const int state : beats) EXPECT_EQ(state, 4);
}

TEST(Node, heartbeats_tell_the_state_at_their_period) {
  DriveRig rig;
  rig.client.write(0x1017, 0, 100, 2);
  rig.sent.clear();
  rig.run_ms(500);
  EXPECT_EQ(heartbeats(rig.sent), (std::vector<int>{127, 127, 127, 127, 127}));
  rig.client.nmt(1);
  rig.sent.clear();
  rig.run_ms(500);
  EXPECT_EQ(heartbeats(rig.sent), (std::vector<int>{5, 5, 5, 5, 5}));
}

TEST(Node, reset_communication_forgets_the_mapping_and_keeps_the_drives_settings) {
  DriveRig rig;
  rig.configure();
  rig.cyclic = false;
  rig.client.write(0x6066, 0, 55, 2);
  rig.client.nmt(130);
  rig.run_ms(25);
  EXPECT_EQ(rig.client.read(0x1600, 0), 1u);
  EXPECT_EQ(rig.client.read(0x6066, 0), 55u);
  rig.client.nmt(129);
  rig.run_ms(10);
  EXPECT_EQ(rig.client.read(0x6066, 0), 100u);
}

// Master heartbeat 100 ms, consumer 300 ms: the reaction comes between 300 and 302 ms after the last one.
class HeartbeatLoss : public testing::Test {
 protected:
  void lose(std::int64_t abort_option, std::int64_t behaviour = 0) {
    rig.client.write(0x1016, 1, (0x7F << 16) | 300, 4);
    rig.client.write(0x6007, 0, abort_option, 2);
    rig.client.write(0x1029, 1, behaviour, 1);
    rig.enable();
    for (int i = 0; i < 5; ++i) {
      rig.client.send(0x77F, {5});
      rig.run_ms(100);
    }
    rig.client.send(0x77F, {5});
    rig.sent.clear();
    rig.run_ms(299);
    ASSERT_EQ(emergency(rig.sent, 3), -1);
    ASSERT_EQ(rig.drive.state(), DriveState::operation_enabled);
    rig.run_ms(3);
    ASSERT_EQ(emergency(rig.sent, 3), 0x8130);
  }
  DriveRig rig;
};

TEST_F(HeartbeatLoss, makes_a_fault_with_6007_at_1_and_leaves_operational) {
  lose(1);
  EXPECT_EQ(rig.drive.node().state(), NmtState::pre_operational);
  rig.run_ms(5);
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
  EXPECT_EQ(rig.client.read(0x603F, 0), 0x8130u);
}

TEST_F(HeartbeatLoss, disables_the_voltage_with_6007_at_2) {
  lose(2);
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  rig.run_ms(1);
  EXPECT_TRUE(rig.output.released);
}

TEST_F(HeartbeatLoss, stops_quickly_with_6007_at_3) {
  rig.client.write(0x605A, 0, 6, 2);
  lose(3);
  EXPECT_EQ(rig.drive.state(), DriveState::quick_stop_active);
}

TEST_F(HeartbeatLoss, is_ignored_with_6007_at_0_and_1029_at_1) {
  lose(0, 1);
  EXPECT_EQ(rig.drive.state(), DriveState::operation_enabled);
  EXPECT_EQ(rig.drive.node().state(), NmtState::operational);
}

TEST_F(HeartbeatLoss, stops_the_node_with_1029_at_2) {
  lose(0, 2);
  EXPECT_EQ(rig.drive.node().state(), NmtState::stopped);
}

TEST_F(HeartbeatLoss, stays_an_error_until_the_communication_is_reset) {
  lose(1);
  rig.cyclic = false;
  rig.run_ms(5);
  rig.client.send(0x77F, {5});
  rig.client.write(0x6040, 0, 0x80, 2);
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
  rig.client.nmt(130);
  rig.run_ms(25);
  rig.client.write(0x6040, 0, 0x00, 2);
  rig.client.write(0x6040, 0, 0x80, 2);
  EXPECT_EQ(rig.drive.state(), DriveState::switch_on_disabled);
  EXPECT_EQ(rig.client.read(0x1001, 0), 0u);
}

TEST(Node, a_heartbeat_never_heard_is_not_missed) {
  DriveRig rig;
  rig.client.write(0x1016, 1, (0x7F << 16) | 300, 4);
  rig.sent.clear();
  rig.run_ms(1000);
  EXPECT_EQ(emergency(rig.sent, 3), -1);
}

TEST(Node, errors_stand_in_the_history_latest_first_and_can_be_emptied) {
  DriveRig rig;
  rig.drive.node().raise(emcy::hot, rig.client.now);
  rig.drive.node().raise(emcy::following, rig.client.now);
  EXPECT_EQ(rig.client.read(0x1003, 0), 2u);
  EXPECT_EQ(rig.client.read(0x1003, 1), 0x8611u);
  EXPECT_EQ(rig.client.read(0x1003, 2), 0x4210u);
  EXPECT_EQ(rig.client.read(0x1001, 0), 0x01u | 0x08u | 0x20u);
  std::uint32_t code = 0;
  rig.client.read(0x1003, 3, &code);
  EXPECT_EQ(code, 0x06090011u);
  EXPECT_EQ(rig.client.write(0x1003, 0, 0, 1), 0u);
  EXPECT_EQ(rig.client.read(0x1003, 0), 0u);
}

TEST(Node, an_error_that_goes_is_told_with_code_0_and_what_remains) {
  DriveRig rig;
  rig.drive.node().raise(emcy::hot, rig.client.now);
  rig.drive.node().raise(emcy::following, rig.client.now);
  rig.client.take();
  rig.drive.node().clear(emcy::hot, rig.client.now);
  const std::vector<CanFrame> sent = rig.client.take();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].data[0] | (sent[0].data[1] << 8), 0);
  EXPECT_EQ(sent[0].data[2], 0x21);
}

}  // namespace
}  // namespace lf::devices::test
