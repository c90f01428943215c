#include "firmware/canopen/cia402.hpp"

#include <array>

namespace lf::canopen {

const char* name(DriveState state) {
  switch (state) {
    case DriveState::not_ready: return "not ready to switch on";
    case DriveState::switch_on_disabled: return "switch on disabled";
    case DriveState::ready_to_switch_on: return "ready to switch on";
    case DriveState::switched_on: return "switched on";
    case DriveState::operation_enabled: return "operation enabled";
    case DriveState::quick_stop_active: return "quick stop active";
    case DriveState::fault_reaction: return "fault reaction active";
    case DriveState::fault: return "fault";
    case DriveState::unknown: return "unknown";
  }
  return "unknown";
}

DriveState decode_statusword(std::uint16_t statusword) {
  switch (statusword & 0x4Fu) {  // bit 5, quick stop, does not matter in these
    case 0x00: return DriveState::not_ready;
    case 0x40: return DriveState::switch_on_disabled;
    case 0x0F: return DriveState::fault_reaction;
    case 0x08: return DriveState::fault;
    default: break;
  }
  switch (statusword & 0x6Fu) {
    case 0x21: return DriveState::ready_to_switch_on;
    case 0x23: return DriveState::switched_on;
    case 0x27: return DriveState::operation_enabled;
    case 0x07: return DriveState::quick_stop_active;
    default: return DriveState::unknown;
  }
}

namespace {

constexpr Command off = Command::disable_voltage;
constexpr Command stop = Command::quick_stop;
constexpr Command down = Command::shutdown;
constexpr Command on = Command::switch_on;
constexpr Command run = Command::enable_operation;
constexpr Command clear = Command::fault_reset;

// Rows: where the drive is. Columns: disabled, enabled, resumed, quick_stop, fault_reset.
constexpr std::array<std::array<Command, drive_goal_count>, drive_state_count> commands{{
    {off, off, off, off, off},     // not ready: leaves by itself
    {off, down, down, stop, off},  // switch on disabled
    {off, on, on, stop, off},      // ready to switch on
    {down, run, run, stop, off},   // switched on
    {on, run, run, stop, off},     // operation enabled; `on` is "disable operation" here
    {off, off, run, stop, off},    // quick stop active: `run` is transition 16
    {off, off, off, off, off},     // fault reaction: leaves by itself
    {off, off, off, off, clear},   // fault
    {off, off, off, stop, off},    // unknown
}};

}  // namespace

Command command_for(DriveState state, DriveGoal goal) { return commands[static_cast<std::size_t>(state)][static_cast<std::size_t>(goal)]; }

}  // namespace lf::canopen
