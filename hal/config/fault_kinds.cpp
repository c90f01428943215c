#include "hal/config/fault_kinds.hpp"

#include <array>

namespace lf::config {

namespace {

using enum FaultPlace;

constexpr std::array kinds{
    FaultKind{"overcurrent", drive, "the drive reports EMCY 2310 and cannot be reset while it lasts"},
    FaultKind{"hot", drive, "the winding is at 95 degrees: EMCY 4210"},
    FaultKind{"following", drive, "the motor is jammed: EMCY 8611 when the target moves on"},
    FaultKind{"stuck_encoder", drive, "the position reading stays where it is while the joint moves"},
    FaultKind{"encoder_jump", drive, "the position reads 0.25 rad too much"},
    FaultKind{"torque_frozen", drive, "the torque reading stays where it is"},
    FaultKind{"torque_high", drive, "the torque reads 1.2 times the drive's peak torque too much"},
    FaultKind{"runaway", drive, "while enabled the joint runs off at its top speed, and the drive's own watch of it fails, too"},
    FaultKind{"silent", node, "the node's cable is cut: nothing in, nothing out"},
    FaultKind{"reboot", node, "a power dip: the node comes back with its stored values"},
    FaultKind{"wrong_identity", node, "object 1018 names another product: the wrong device hangs there"},
    FaultKind{"bus_off", node_or_master, "the CAN controller goes off the bus"},
    FaultKind{"drop_frames", frames, "frames with this identifier are lost on their way to every receiver"},
    FaultKind{"estop", bus, "the emergency-stop chain is open"},
    FaultKind{"interlock_open", bus, "the laser's interlock is open"},
    FaultKind{"error_frames", bus, "one frame in sixteen is destroyed by an error frame and sent again"},
    FaultKind{"foreign_rpdo", node, "a second master sends the node's RPDO every 50 ms"},
    FaultKind{"foreign_sdo", node, "a second master reads an object of the node every 50 ms"},
    FaultKind{"foreign_sync", bus, "a second master sends SYNC every 50 ms"},
    FaultKind{"foreign_nmt", bus, "a second master sends NMT enter pre-operational to all, every 50 ms"},
    FaultKind{"foreign_reset", bus, "a second master sends NMT reset communication to all, every 50 ms"},
    FaultKind{"foreign_heartbeat", bus, "a second master's heartbeat, with the master's own node number, every 50 ms"},
    FaultKind{"foreign_master", bus, "a second master runs the arm: every 4 ms SYNC, an RPDO for each drive, and its heartbeat"},
    FaultKind{"clock_lost", port, "the platform's clock fails"},
    FaultKind{"can_receive_fails", port, "the call that receives CAN frames fails"},
    FaultKind{"can_send_fails", port, "the call that sends CAN frames fails: nothing that the core sends arrives"},
    FaultKind{"camera_fails", port, "the call that takes an image fails"},
    FaultKind{"panel_submit_fails", port, "the call that asks panel vision fails"},
    FaultKind{"panel_receive_fails", port, "the call that takes panel vision's answer fails"},
    FaultKind{"telemetry_fails", port, "the call that leaves the telemetry fails"},
    FaultKind{"vision_stalled", port, "the vision thread hangs: the ring to it fills up"},
    FaultKind{"image_lost", sight, "one image is lost"},
    FaultKind{"camera_silent", sight, "no image comes"},
    FaultKind{"camera_frozen", sight, "the camera hands out the same image with its old stamp"},
    FaultKind{"sensor_frozen", sight, "the camera hands out the same picture with new stamps"},
    FaultKind{"vision_late", sight, "panel vision answers 1.5 s later than it does"},
    FaultKind{"vision_silent", sight, "panel vision does not answer"},
    FaultKind{"vision_poor", sight, "panel vision finds neither marker nor handle"},
    FaultKind{"handle_breaks", world, "the handle breaks off and is gone"},
    FaultKind{"obstacle", world, "something is pushed against the wrist from its left, with 80 N"},
    FaultKind{"abort_ordered", order, "the operator aborts the mission"},
    FaultKind{"estop_ordered", order, "the operator orders an emergency stop"},
    FaultKind{"shut_down_ordered", order, "the operator orders shut down"},
    FaultKind{"limits_refused", told, "the checksum of the safety limits is wrong"},
};

const char* place_text(FaultPlace place) {
  switch (place) {
    case drive: return "a drive";
    case node: return "a node";
    case node_or_master: return "a node or the master";
    case frames: return "a `can_id`";
    case bus: return "the bus";
    case port: return "a port";
    case sight: return "sight";
    case world: return "the world";
    case order: return "the operator";
    case told: return "what the core is told";
  }
  return "";
}

}  // namespace

std::span<const FaultKind> fault_kinds() { return kinds; }

const FaultKind* find_fault_kind(std::string_view name) {
  for (const FaultKind& kind : kinds) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

std::vector<std::string> fault_kind_names() {
  std::vector<std::string> names;
  names.reserve(std::size(kinds));
  for (const FaultKind& kind : kinds) names.emplace_back(kind.name);
  return names;
}

std::vector<std::string> fault_nodes(FaultPlace place, const JointNames& names) {
  std::vector<std::string> nodes(names.begin(), names.end());
  if (place == node || place == node_or_master) nodes.emplace_back("io");
  if (place == node_or_master) nodes.emplace_back("master");
  if (place != drive && place != node && place != node_or_master) return {""};
  return nodes;
}

std::string fault_kinds_markdown() {
  std::string text = "| kind | happens to | what happens |\n|---|---|---|\n";
  for (const FaultKind& kind : kinds) text += std::string("| `") + kind.name + "` | " + place_text(kind.place) + " | " + kind.does + " |\n";
  return text;
}

}  // namespace lf::config
