// The CiA 402 state machine as the master sees it: what a statusword says, and which controlword leads where.
//
// CiA 402-2, figures "power drive system finite state automaton" and tables of status- and controlword.
// docs/canopen.md has the table; a test holds code and docs together.
#pragma once

#include <cstdint>

namespace lf::canopen {

enum class DriveState : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction,
  fault,
  unknown,  // a pattern the standard does not have
};
inline constexpr std::size_t drive_state_count = 9;
const char* name(DriveState state);

// Where the master wants the drive.
enum class DriveGoal : std::uint8_t {
  disabled,     // without power, the way down through every state, so that 605B and 605C can act
  enabled,      // operation enabled; a quick stop is left through switch-on disabled
  resumed,      // the same, but a quick stop that holds (605A 5..8) is left under power (transition 16)
  quick_stop,   // stopped
  fault_reset,  // out of the fault state
};
inline constexpr std::size_t drive_goal_count = 5;

// Controlwords, bits 0-3 and 7.
enum class Command : std::uint16_t {
  disable_voltage = 0x00,
  quick_stop = 0x02,
  shutdown = 0x06,
  switch_on = 0x07,  // also "disable operation"
  enable_operation = 0x0F,
  fault_reset = 0x80,  // acts on its rising edge
};

inline constexpr std::uint16_t control_homing_start = 0x10;     // bit 4, homing mode
inline constexpr std::uint16_t status_target_reached = 0x0400;  // bit 10
inline constexpr std::uint16_t status_bit12 = 0x1000;           // cyclic modes: the drive follows the target; homing: attained
inline constexpr std::uint16_t status_bit13 = 0x2000;           // cyclic modes: following error; homing: error

enum class OperationMode : std::int8_t { profile_position = 1, homing = 6, cyclic_position = 8 };

// The state in a statusword (6041): bits 0-3, 5 and 6.
DriveState decode_statusword(std::uint16_t statusword);

// The controlword that takes a drive in `state` one step toward `goal`.
Command command_for(DriveState state, DriveGoal goal);

}  // namespace lf::canopen
