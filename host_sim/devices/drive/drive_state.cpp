#include "host_sim/devices/drive/drive_state.hpp"

namespace lf::devices {

Command command_of(std::uint16_t controlword) {
  if ((controlword & 0x02) == 0) return Command::disable_voltage;
  if ((controlword & 0x04) == 0) return Command::quick_stop;
  if ((controlword & 0x01) == 0) return Command::shutdown;
  return (controlword & 0x08) == 0 ? Command::switch_on : Command::enable_operation;
}

DriveState after(DriveState state, Command command, std::int64_t quick_stop_option) {
  const bool off = command == Command::disable_voltage || command == Command::quick_stop;
  switch (state) {
    case DriveState::switch_on_disabled: return command == Command::shutdown ? DriveState::ready_to_switch_on : state;
    case DriveState::ready_to_switch_on:
      if (off) return DriveState::switch_on_disabled;
      if (command == Command::switch_on) return DriveState::switched_on;
      return command == Command::enable_operation ? DriveState::operation_enabled : state;
    case DriveState::switched_on:
      if (off) return DriveState::switch_on_disabled;
      if (command == Command::shutdown) return DriveState::ready_to_switch_on;
      return command == Command::enable_operation ? DriveState::operation_enabled : state;
    case DriveState::operation_enabled:
      if (command == Command::disable_voltage) return DriveState::switch_on_disabled;
      if (command == Command::quick_stop) return DriveState::quick_stop_active;
      if (command == Command::shutdown) return DriveState::ready_to_switch_on;
      return command == Command::switch_on ? DriveState::switched_on : state;
    case DriveState::quick_stop_active:
      if (command == Command::disable_voltage) return DriveState::switch_on_disabled;
      return command == Command::enable_operation && stays_after_quick_stop(quick_stop_option) ? DriveState::operation_enabled : state;
    case DriveState::not_ready:
    case DriveState::fault_reaction_active:
    case DriveState::fault: break;
  }
  return state;
}

std::uint16_t status_bits(DriveState state) {
  switch (state) {
    case DriveState::not_ready: return 0x00;
    case DriveState::switch_on_disabled: return 0x60;  // bit 5 is free in this state; a drive that asks for no quick stop shows 1
    case DriveState::ready_to_switch_on: return 0x21;
    case DriveState::switched_on: return 0x23;
    case DriveState::operation_enabled: return 0x27;
    case DriveState::quick_stop_active: return 0x07;
    case DriveState::fault_reaction_active: return 0x2F;
    case DriveState::fault: return 0x28;
  }
  return 0;
}

}  // namespace lf::devices
