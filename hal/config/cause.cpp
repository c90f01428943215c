#include "hal/config/cause.hpp"

namespace lf::config {

namespace {

using safety::Fault;

// What to do about each fault but for those that a StepFailure explains.
const char* remedy_of(Fault fault) {
  switch (fault) {
    case Fault::limits_refused: return "Take the shipped file of limits, or the checksum that the refusal names.";
    case Fault::boot_failed: return "Check the node's power, cable, node number and profile; `lanternfishd doctor` asks each drive.";
    case Fault::estop: return "Find who opened the emergency-stop chain and why, see that nobody is in reach, close it, then reset.";
    case Fault::node_lost: return "Check the node's power and cable, and the bus's termination.";
    case Fault::node_rebooted: return "Its power dipped: check the supply under load and the connector.";
    case Fault::drive_fault:
      return "Look up the drive's error; let a hot motor cool down. Free a jammed joint with the emergency stop pressed: a load may hang "
             "on it. Then reset.";
    case Fault::following_error:
      return "Press the emergency stop, then look for what blocks the joint or leans on the arm, and whether its encoder counts.";
    case Fault::stale_position: return "The drive sends no position: check the bus's load and errors, and the drive's TPDO.";
    case Fault::joint_limit:
      return "Hold the joint's zero against where the joint really stands before anything moves; then `jog` it back within its limits.";
    case Fault::overspeed: return "Check counts_per_rev and the joint's zero, then the drive's own speed limit.";
    case Fault::overload: return "Press the emergency stop, then look for what the joint presses against, and at its brake.";
    case Fault::workspace: return "Bring the tool back into its box by `jog`; check safety.limits.";
    case Fault::unexpected_contact: return "Press the emergency stop, then look at what the arm touches before it is moved again.";
    case Fault::io_lost: return "Check the output node's power and cable: laser, lamps and the emergency-stop chain hang on it.";
    case Fault::interlock: return "Close the laser's interlock.";
    case Fault::image_lost:
    case Fault::camera_lost: return "Check the camera's cable, power and trigger.";
    case Fault::vision_late: return "The computer is too busy or panel vision hangs: look at its load and at the log.";
    case Fault::grip_lost: return "Clean the pads and the bar; the valve may take more torque than the grip holds.";
    case Fault::step_timeout: return "Look at which joint did not arrive: its drive may be slow or held.";
    case Fault::port_error: return "A call of this computer's failed: look at the counters and at the kernel's log.";
    case Fault::bus_off: return "Check the CAN cable, termination and bit rate, then `restart-bus`.";
    case Fault::second_master: return "Take the other master off the bus.";
    case Fault::clock_lost: return "The computer's clock failed: look at the kernel's log.";
    case Fault::aborted:
    case Fault::vision_poor:
    case Fault::step_failed:
    case Fault::count: break;
  }
  return "";
}

}  // namespace

Cause cause_of(Fault fault, std::int32_t code, const mission::Sight& sight) {
  if (fault != Fault::step_failed && fault != Fault::vision_poor) return {"", remedy_of(fault)};
  const auto failure = static_cast<StepFailure>(code);
  const Cause seen = sight_cause(failure, sight);
  if (seen.name.empty()) return {lf::name(failure), lf::remedy(failure)};
  return {std::string(lf::name(failure)) + ": " + seen.name, seen.remedy};
}

}  // namespace lf::config
