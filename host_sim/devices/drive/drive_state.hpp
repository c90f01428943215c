// The CiA 402 state machine of a drive's power stage: what a controlword does in each state.
//
//   not ready -> switch on disabled <-> ready to switch on <-> switched on <-> operation enabled -> quick stop active
//   any -> fault reaction active -> fault -> (reset) switch on disabled
#pragma once

#include <cstdint>

namespace lf::devices {

enum class DriveState : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

// What bits 0 to 3 of a controlword ask for (CiA 402-2, table 27). Bit 7 is an edge, and comes beside it.
enum class Command : std::uint8_t { disable_voltage, quick_stop, shutdown, switch_on, enable_operation };
Command command_of(std::uint16_t controlword);

// Quick stop option code 605A: 5 and 6 stay in quick stop active, from where operation can be enabled again.
constexpr bool stays_after_quick_stop(std::int64_t option) { return option == 5 || option == 6; }

// The state after `command`, with the automatic pass through switched on when operation is enabled from ready to switch on (transitions 3 and 4).
// Faults, and the end of a ramp, are not commands.
DriveState after(DriveState state, Command command, std::int64_t quick_stop_option);

// Bits 0 to 3, 5 and 6 of the statusword; bit 5 is 0 only while a quick stop is active.
std::uint16_t status_bits(DriveState state);

}  // namespace lf::devices
