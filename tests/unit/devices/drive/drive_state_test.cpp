// CiA 402-2, figure 10 and table 26, written out by hand: every state against every command.
#include "host_sim/devices/drive/drive_state.hpp"

#include <gtest/gtest.h>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

using S = DriveState;

struct Row {
  S from;
  // disable voltage, quick stop, shutdown, switch on, enable operation
  S to[5];
};

constexpr Row table_605a_2[] = {
    {S::not_ready, {S::not_ready, S::not_ready, S::not_ready, S::not_ready, S::not_ready}},
    {S::switch_on_disabled,
     {S::switch_on_disabled, S::switch_on_disabled, S::ready_to_switch_on, S::switch_on_disabled, S::switch_on_disabled}},
    {S::ready_to_switch_on, {S::switch_on_disabled, S::switch_on_disabled, S::ready_to_switch_on, S::switched_on, S::operation_enabled}},
    {S::switched_on, {S::switch_on_disabled, S::switch_on_disabled, S::ready_to_switch_on, S::switched_on, S::operation_enabled}},
    {S::operation_enabled, {S::switch_on_disabled, S::quick_stop_active, S::ready_to_switch_on, S::switched_on, S::operation_enabled}},
    {S::quick_stop_active, {S::switch_on_disabled, S::quick_stop_active, S::quick_stop_active, S::quick_stop_active, S::quick_stop_active}},
    {S::fault_reaction_active,
     {S::fault_reaction_active, S::fault_reaction_active, S::fault_reaction_active, S::fault_reaction_active, S::fault_reaction_active}},
    {S::fault, {S::fault, S::fault, S::fault, S::fault, S::fault}},
};
constexpr std::uint16_t controlwords[5] = {0x00, 0x02, 0x06, 0x07, 0x0F};

TEST(DriveState, every_state_answers_every_command_as_cia_402_says) {
  for (const Row& row : table_605a_2) {
    for (int c = 0; c < 5; ++c) {
      EXPECT_EQ(after(row.from, command_of(controlwords[c]), 2), row.to[c]) << static_cast<int>(row.from) << " command " << c;
    }
  }
}

TEST(DriveState, quick_stop_can_be_left_to_operation_only_with_options_5_and_6) {
  for (int option = 0; option <= 6; ++option) {
    const S expected = option == 5 || option == 6 ? S::operation_enabled : S::quick_stop_active;
    EXPECT_EQ(after(S::quick_stop_active, Command::enable_operation, option), expected) << option;
  }
}

TEST(DriveState, dont_care_bits_do_not_matter) {
  for (std::uint16_t other = 0; other < 0x200; other = static_cast<std::uint16_t>(other + 0x10)) {
    EXPECT_EQ(command_of(static_cast<std::uint16_t>(0x00 | other)), Command::disable_voltage);
    EXPECT_EQ(command_of(static_cast<std::uint16_t>(0x0D | other)), Command::disable_voltage);  // bit 1 is 0
    EXPECT_EQ(command_of(static_cast<std::uint16_t>(0x0B | other)), Command::quick_stop);       // bit 2 is 0
    EXPECT_EQ(command_of(static_cast<std::uint16_t>(0x0E | other)), Command::shutdown);         // bit 0 is 0
  }
}

TEST(DriveState, statuswords_are_those_of_table_30) {
  EXPECT_EQ(status_bits(S::not_ready) & 0x4F, 0x00);
  EXPECT_EQ(status_bits(S::switch_on_disabled) & 0x4F, 0x40);
  EXPECT_EQ(status_bits(S::ready_to_switch_on) & 0x6F, 0x21);
  EXPECT_EQ(status_bits(S::switched_on) & 0x6F, 0x23);
  EXPECT_EQ(status_bits(S::operation_enabled) & 0x6F, 0x27);
  EXPECT_EQ(status_bits(S::quick_stop_active) & 0x6F, 0x07);
  EXPECT_EQ(status_bits(S::fault_reaction_active) & 0x4F, 0x0F);
  EXPECT_EQ(status_bits(S::fault) & 0x4F, 0x08);
}

// The same table against the drive itself, over frames.
void bring_to(DriveRig& rig, S state) {
  rig.configure();
  rig.client.write(0x6060, 0, 8, 1);
  rig.client.write(0x605A, 0, state == S::quick_stop_active ? 6 : 2, 2);
  rig.target = rig.actual();
  std::vector<int> words;
  if (state == S::ready_to_switch_on) words = {0x06};
  if (state == S::switched_on) words = {0x06, 0x07};
  if (state == S::operation_enabled || state == S::fault) words = {0x06, 0x07, 0x0F};
  if (state == S::quick_stop_active) words = {0x06, 0x07, 0x0F, 0x02};
  for (const int word : words) {
    rig.controlword = static_cast<std::uint16_t>(word);
    rig.run_ms(8);
  }
  if (state != S::fault) return;
  rig.drive.faults().overcurrent = true;
  rig.run_ms(10);
  rig.drive.faults().overcurrent = false;
}

TEST(DriveState, the_drive_walks_the_same_table_over_pdos) {
  for (const Row& row : table_605a_2) {
    if (row.from == S::not_ready || row.from == S::fault_reaction_active) continue;  // pass on their own
    for (int c = 0; c < 5; ++c) {
      DriveRig rig;
      bring_to(rig, row.from);
      ASSERT_EQ(rig.drive.state(), row.from);
      rig.controlword = controlwords[c];
      rig.run_ms(12);
      S expected = row.to[c];
      if (row.from == S::quick_stop_active && c == 4) expected = S::operation_enabled;   // 605A is 6 here
      if (row.from == S::operation_enabled && c == 1) expected = S::switch_on_disabled;  // 605A is 2: at standstill it is over at once
      EXPECT_EQ(rig.drive.state(), expected) << static_cast<int>(row.from) << " command " << c;
    }
  }
}

TEST(DriveState, a_fault_is_reset_by_the_rising_edge_alone) {
  DriveRig rig;
  bring_to(rig, S::fault);
  rig.controlword = 0x80;
  rig.run_ms(12);
  EXPECT_EQ(rig.drive.state(), S::switch_on_disabled);
  rig.drive.faults().overcurrent = true;
  rig.run_ms(12);
  rig.drive.faults().overcurrent = false;
  rig.run_ms(12);
  EXPECT_EQ(rig.drive.state(), S::fault) << "bit 7 was high all the time";
  rig.controlword = 0x00;
  rig.run_ms(8);
  rig.controlword = 0x80;
  rig.run_ms(8);
  EXPECT_EQ(rig.drive.state(), S::switch_on_disabled);
}

TEST(DriveState, a_fault_whose_cause_lasts_is_not_reset) {
  DriveRig rig;
  bring_to(rig, S::fault);
  rig.drive.faults().overcurrent = true;
  rig.controlword = 0x80;
  rig.run_ms(12);
  EXPECT_EQ(rig.drive.state(), S::fault);
}

}  // namespace
}  // namespace lf::devices::test
