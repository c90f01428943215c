// The table of faults: what can go wrong, and what each does in every phase.
//
// What is safe depends on the phase. With a turned handle in the jaw, letting go lets a sprung valve run back and holding on may break it;
// before contact, stopping where it stands is always safe; at boot nothing moves yet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lf::safety {

enum class Fault : std::uint8_t {
  limits_refused,      // the limits are not those that the checksum was made of, or a mission widens them
  boot_failed,         // a node did not answer, or holds another value than was written
  estop,               // the emergency-stop chain is open, or a stop was commanded
  node_lost,           // heartbeat missing
  node_rebooted,       // boot-up message in operation: its configuration is gone
  drive_fault,         // CiA 402 fault state or an EMCY of a drive
  following_error,     // a joint does not follow its target
  stale_position,      // no position for three SYNC cycles
  joint_limit,         // a measured joint outside its limits
  overspeed,           // a measured joint faster than its limit
  overload,            // a joint's torque over its limit
  workspace,           // the tool outside its box
  unexpected_contact,  // torque or following error where nothing may touch
  io_lost,             // the output node is silent: the emergency-stop chain cannot be read, and laser and lamps are not ours
  interlock,           // the laser's interlock is open
  image_lost,          // an exposure without its image
  camera_lost,         // no image comes any more, or always the same
  vision_late,         // no answer of panel vision in time
  vision_poor,         // an answer that cannot be used
  grip_lost,           // the handle slipped out of the jaw
  step_timeout,        // a step took longer than it may
  step_failed,         // a step ended without its aim: no contact, no click, unreachable
  aborted,             // the operator ended the mission
  port_error,          // a call of the platform failed
  bus_off,  // the CAN controller went off the bus, or cannot be read or written for three ticks: nothing that is sent arrives, or nothing is heard
  second_master,  // somebody else sends what only the master may: set points, SYNC, NMT, SDO requests, or its heartbeat
  clock_lost,     // three ticks in a row without the platform's clock: nothing is known to be fresh
  count
};
inline constexpr std::size_t fault_count = static_cast<std::size_t>(Fault::count);

// The phases in which a fault can mean different things. Every step of the mission belongs to one.
enum class Phase : std::uint8_t {
  boot,      // nothing has power: the nodes are being configured
  free,      // the drives are being enabled and homed; the arm moves or waits clear of the panel
  scan,      // the arm sweeps, the laser is on
  contact,   // a guarded approach or a press: touching is meant to happen, nothing is held
  gripping,  // the handle is in the closed jaw
  stow,      // on the way to the park position, after success or failure
  ended,     // parked or stopped for good: the power is off or on its way down
  count
};
inline constexpr std::size_t phase_count = static_cast<std::size_t>(Phase::count);

// From the mildest to the most severe; of several faults in one tick the most severe reaction is taken (fault_arbiter.hpp).
enum class Reaction : std::uint8_t {
  count_only,  // counted and reported
  retry,       // the step is taken again by its own rule; out of tries, `retreat`
  retreat,     // end the task: let go if gripping, straight back, and stow with a failure
  hold,        // stop smoothly and stay enabled where it is, jaw as it is; the mission fails here
  quick_stop,  // stop category 1: the drives' own quick stop, then the power off (power.hpp); the mission fails here
  power_off,   // stop category 0: the power off at once; the self-locking gears hold the arm; the mission fails here
};

Reaction reaction(Fault fault, Phase phase);
const char* name(Fault fault);
const char* name(Phase phase);
const char* name(Reaction reaction);

}  // namespace lf::safety
