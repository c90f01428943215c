#include "host_sim/judge/fault_rules.hpp"

#include <algorithm>
#include <array>

#include "hal/config/fault_kinds.hpp"
#include "shared/can/can_map.hpp"

namespace lf::judge {

namespace {

constexpr std::array<const char*, joint_count + 1> node_names{"slew", "shoulder", "elbow", "roll", "jaw", "io"};
constexpr std::uint32_t first_tpdo = 0x180, first_rpdo = 0x200;

const std::vector<FaultRule>& rules() {
  using enum Demand;
  // A drive that misbehaves shows itself in one of these ways.
  static const std::vector<std::string> misbehaves{"drive fault", "following error", "stale position", "joint limit", "overspeed",
                                                   "overload",    "workspace",       "contact",        "grip lost",   "step",
                                                   "torque"};
  static const std::vector<std::string> link{"step timed out", "node", "stale position", "chain",
                                             "emergency stop", "bus",  "drive fault",    "boot"};
  static const std::vector<std::string> sight{"image", "camera", "vision", "step", "platform call"};
  static const std::vector<std::string> other_master{"another master"};
  static const std::vector<FaultRule> all{
      {"overcurrent", stop, Report::frame, 0, {"drive fault", "step timed out"}},
      {"hot", stop, Report::frame, 0, {"drive fault"}},
      {"following", safe_end, Report::none, 0, misbehaves},
      {"stuck_encoder", safe_end, Report::none, 0, misbehaves},
      {"encoder_jump", safe_end, Report::none, 0, misbehaves},
      {"torque_frozen", safe_end, Report::none, 0, misbehaves},
      {"torque_high", safe_end, Report::none, 0, misbehaves},
      {"runaway", safe_end, Report::none, 0, misbehaves},
      {"silent", stop, Report::silence, 0, link},
      {"reboot", stop, Report::silence, 0, link},
      {"wrong_identity", safe_end, Report::none, 0, {"boot", "identity"}},
      {"bus_off", stop, Report::silence, 0, link},
      {"drop_frames",
       safe_end,
       Report::none,
       0,
       {"node", "stale position", "chain", "emergency stop", "drive fault", "following error", "step", "contact", "boot failed", "camera"}},
      {"drop_frames", go_on, Report::none, 0.004, {}, "one frame"},
      {"estop", stop, Report::frame, 0, {"emergency stop"}},
      {"interlock_open", safe_end, Report::none, 0, {"interlock", "step"}},
      {"error_frames", go_on, Report::none, 0, {}},
      {"foreign_rpdo", stop, Report::second_master, 0, other_master},
      {"foreign_sdo", stop, Report::second_master, 0, other_master},
      {"foreign_sync", stop, Report::second_master, 0, other_master},
      {"foreign_nmt", stop, Report::second_master, 0, other_master},
      {"foreign_heartbeat", stop, Report::second_master, 0, other_master},
      {"clock_lost", stop, Report::at_once, 0, {"clock"}},
      {"can_receive_fails",
       stop,
       Report::silence,
       0,
       {"platform call", "stale position", "node", "chain", "emergency stop", "bus", "CAN", "boot"}},
      {"can_send_fails",
       stop,
       Report::unheard,
       0,
       {"platform call", "stale position", "node", "chain", "drive fault", "bus", "CAN", "boot"}},
      {"camera_fails", safe_end, Report::none, 0, sight},
      {"panel_submit_fails", safe_end, Report::none, 0, sight},
      {"panel_receive_fails", safe_end, Report::none, 0, sight},
      {"telemetry_fails", go_on, Report::none, 0, {}},
      {"vision_stalled", safe_end, Report::none, 0, sight},
      {"image_lost", go_on, Report::none, 0, {}},
      {"camera_silent", safe_end, Report::none, 0, sight},
      {"camera_silent", go_on, Report::none, 0.6, {}, "0.6 s"},
      {"camera_frozen", safe_end, Report::none, 0, sight},
      {"sensor_frozen", safe_end, Report::none, 0, sight},
      {"vision_late", go_on, Report::none, 0, {}},
      {"vision_silent", safe_end, Report::none, 0, sight},
      {"vision_poor", safe_end, Report::none, 0, sight},
      {"handle_breaks", safe_end, Report::none, 0, {"grip", "step", "contact", "held", "handle"}},
      {"obstacle", safe_end, Report::none, 0, misbehaves},
      {"abort_ordered", safe_end, Report::none, 0, {"aborted"}},
      {"estop_ordered", stop, Report::at_once, 0, {"emergency stop"}},
      {"shut_down_ordered", stop, Report::halt, 0, {"aborted", "shut down"}},
      {"limits_refused", safe_end, Report::none, 0, {"limits"}},
  };
  return all;
}

// A lost frame's identifier from "tpdo slew".
std::int64_t frame_of(const std::string& node) {
  for (std::size_t i = 0; i < node_names.size(); ++i) {
    if (!node.ends_with(std::string(" ") + node_names[i])) continue;
    const std::uint32_t id = i < joint_count ? can_map::drive_nodes[i] : can_map::io_node;
    return (node.starts_with("tpdo") ? first_tpdo : first_rpdo) + id;
  }
  return 0;
}

}  // namespace

std::span<const FaultRule> fault_rules() { return rules(); }

std::string Cause::name() const {
  std::string text = rule->kind;
  if (rule->variant[0] != '\0') text += std::string(" (") + rule->variant + ")";
  return node.empty() ? text : text + " " + node;
}

config::Fault Cause::fault() const {
  config::Fault fault;
  fault.kind = rule->kind;
  fault.duration_s = rule->duration_s;
  fault.can_id = frame_of(node);
  if (fault.can_id == 0) fault.node = node;
  return fault;
}

std::vector<Cause> all_causes() {
  std::vector<Cause> causes;
  for (const FaultRule& rule : fault_rules()) {
    const config::FaultPlace place = config::find_fault_kind(rule.kind)->place;
    if (place != config::FaultPlace::frames) {
      for (const std::string& node : config::fault_nodes(place)) causes.push_back({&rule, node});
      continue;
    }
    for (const char* node : node_names) {
      for (const char* pdo : {"tpdo ", "rpdo "}) causes.push_back({&rule, std::string(pdo) + node});
    }
  }
  return causes;
}

}  // namespace lf::judge
