#include "host_sim/judge/fault_rules.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>

#include "hal/config/fault_kinds.hpp"
#include "shared/can/can_map.hpp"

namespace lf::judge {

namespace {

constexpr std::uint32_t first_rpdo = 0x200, sdo_request = 0x600;

// A frame's function code, by its sort in a rule.
std::uint32_t function_of(const std::string& sort) {
  constexpr std::uint32_t first_tpdo = 0x180, heartbeat = 0x700, emcy = 0x080;
  return sort == "tpdo" ? first_tpdo : sort == "rpdo" ? first_rpdo : sort == "heartbeat" ? heartbeat : emcy;
}

const std::vector<FaultRule>& rules() {
  using enum Demand;
  // What a drive does that gets wrong readings or does not obey.
  static const std::vector<std::string> misbehaves{
      "drive fault",        "following error",       "stale position",         "joint limit",          "overspeed", "overload",
      "unexpected contact", "the jaw does not open", "the jaw does not close", "the jaw holds nothing"};
  // An arm that stands elsewhere than it believes touches what lies there, and grips beside the bar: the joint that feels it most is
  // not the one that reads wrongly.
  static const std::vector<std::string> led_astray{"unexpected contact", "touched something", "the jaw holds nothing"};
  // Close to a button's face what stands there is not told from a button that does not go in.
  static const std::vector<std::string> stands_before{"unexpected contact", "touched something", "the jaw holds nothing",
                                                      "the button is stuck"};
  // A torque that stands still is felt nowhere, one that is too high everywhere: the core sees a press that meets nothing, or something too early, or a
  // button that gives way too little. The advice for that names the torques.
  static const std::vector<std::string> feels_nothing{"no button there", "touched something"},
      feels_much{"touched something", "the button is stuck"};
  static const std::vector<std::string> link{"node lost", "node rebooted", "stale position", "drive fault", "boot failed"};
  static const std::vector<std::string> bus_off_of_the_master{"CAN bus off"};
  static const std::vector<std::string> sight{"image", "camera", "panel vision", "platform call", "no panel seen", "too few points"};
  static const std::vector<std::string> other_master{"another master"};
  static const std::vector<std::string> process_data{"tpdo", "rpdo"};
  static const std::vector<FaultRule> all{
      {"overcurrent", stop, Report::frame, 0, {"drive fault"}, {}},
      {"hot", stop, Report::frame, 0, {"drive fault"}, {}},
      {"following", safe_end, Report::none, 0, misbehaves, {}},
      {"stuck_encoder", safe_end, Report::none, 0, misbehaves, led_astray},
      {"encoder_jump", safe_end, Report::none, 0, misbehaves, led_astray},
      {"torque_frozen", safe_end, Report::none, 0, misbehaves, feels_nothing},
      {"torque_high", safe_end, Report::none, 0, misbehaves, feels_much},
      {"runaway", safe_end, Report::none, 0, misbehaves, {}},
      {"silent", stop, Report::silence, 0, link, {}},
      {"reboot", stop, Report::silence, 0, link, {}},
      {"wrong_identity", safe_end, Report::none, 0, {"boot failed"}, {}},
      {"bus_off", stop, Report::silence, 0, link, bus_off_of_the_master},
      {"drop_frames",
       safe_end,
       Report::none,
       0,
       {"stale position", "following error", "drive fault", "boot failed", "output node lost"},
       {},
       "",
       {"rpdo"}},
      {"drop_frames", go_on, Report::none, 0.004, {}, {}, "one frame", process_data},
      {"estop", stop, Report::frame, 0, {"emergency stop"}, {}},
      {"interlock_open", safe_end, Report::none, 0, {"interlock"}, {}},
      {"error_frames", go_on, Report::none, 0, {}, {}},
      {"foreign_rpdo", stop, Report::second_master, 0, other_master, {}},
      {"foreign_sdo", stop, Report::second_master, 0, other_master, {}},
      {"foreign_sync", stop, Report::second_master, 0, other_master, {}},
      {"foreign_nmt", stop, Report::second_master, 0, other_master, {}},
      {"foreign_reset", stop, Report::second_master, 0, other_master, {}},
      {"foreign_heartbeat", stop, Report::second_master, 0, other_master, {}},
      {"foreign_master", stop, Report::second_master, 0, other_master, {}},
      {"clock_lost", stop, Report::at_once, 0, {"clock lost"}, {}},
      {"can_receive_fails", stop, Report::silence, 0, {"CAN bus off: receiving fails", "boot failed"}, {}},
      {"can_send_fails", stop, Report::unheard, 0, {"CAN bus off: sending fails", "boot failed"}, {}},
      {"camera_fails", safe_end, Report::none, 0, sight, {}},
      {"panel_submit_fails", safe_end, Report::none, 0, sight, {}},
      {"panel_receive_fails", safe_end, Report::none, 0, sight, {}},
      {"telemetry_fails", go_on, Report::none, 0, {}, {}},
      {"vision_stalled", safe_end, Report::none, 0, sight, {}},
      {"image_lost", go_on, Report::none, 0, {}, {}},
      {"camera_silent", safe_end, Report::none, 0, sight, {}},
      {"camera_silent", go_on, Report::none, 0.6, {}, {}, "0.6 s"},
      {"camera_frozen", safe_end, Report::none, 0, sight, {}},
      {"sensor_frozen", safe_end, Report::none, 0, sight, {}},
      {"vision_late", go_on, Report::none, 0, {}, {}},
      {"vision_silent", safe_end, Report::none, 0, sight, {}},
      {"vision_poor", safe_end, Report::none, 0, sight, {}},
      {"handle_breaks", safe_end, Report::none, 0, {"grip lost", "holds nothing", "nothing to touch", "contact", "handle"}, {}},
      {"obstacle", safe_end, Report::none, 0, misbehaves, stands_before},
      {"abort_ordered", safe_end, Report::none, 0, {"aborted"}, {}},
      {"estop_ordered", stop, Report::at_once, 0, {"emergency stop"}, {}},
      {"shut_down_ordered", stop, Report::halt, 0, {"shut down"}, {}},
      {"limits_refused", safe_end, Report::none, 0, {"limits refused"}, {}},
      // Since pairs were first flown; a rule's place in this table says what is drawn for its pairs.
      {"drop_frames", safe_end, Report::none, 0, {"node lost", "boot failed"}, {}, "", {"heartbeat"}},
      {"drop_frames", go_on, Report::none, 0.1, {}, {}, "one frame", {"heartbeat"}},
      {"drop_frames", go_on, Report::none, 0, {}, {}, "", {"emcy"}},
      // What a node sends is all that is known of it: without its process data it is silent.
      {"drop_frames", stop, Report::silence, 0, {"stale position", "boot failed", "output node lost"}, {}, "", {"tpdo"}},
  };
  return all;
}

// "elbow" of "tpdo elbow"; nothing where a cause has no node.
std::string node_name(const std::string& node) { return node.substr(node.find_last_of(' ') + 1); }

bool has_any(const std::string& reason, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return reason.find(word) != std::string::npos; });
}

// The node as a reason says it: ": elbow", "output node", or in the identifier of a frame for it.
bool names_node(const std::string& reason, const Cause& cause) {
  const std::string node = node_name(cause.node);
  if (cause.number == 0) return false;
  if (cause.output_node && reason.find("output node") != std::string::npos) return true;
  for (const std::uint32_t function : {first_rpdo, sdo_request}) {
    char identifier[8];
    std::snprintf(identifier, sizeof identifier, "0x%04X", function + cause.number);
    if (reason.find(identifier) != std::string::npos) return true;
  }
  if (node == "jaw" && reason.find("the jaw ") != std::string::npos) return true;
  for (std::size_t at = reason.find(": " + node); at != std::string::npos; at = reason.find(": " + node, at + 1)) {
    const std::size_t end = at + 2 + node.size();
    if (end == reason.size() || reason[end] == ',' || reason[end] == ' ') return true;
  }
  return false;
}

}  // namespace

bool Cause::named_in(const std::string& told) const {
  const std::string reason = told.substr(0, told.find(" ("));  // without the advice
  // The arm feels nothing by the jaw's torque.
  const bool of_the_jaw = node_name(node) == "jaw" && rule->kind.starts_with("torque_");
  if (!of_the_jaw && has_any(reason, rule->named_without_node)) return true;
  // The output node triggers the camera, too.
  if (node_name(node) == "io" && reason.find("output node lost") != std::string::npos) return true;
  if (node_name(node) == "io" && rule->kind == "drop_frames" && reason.find("camera silent") != std::string::npos) return true;
  const bool named = has_any(reason, rule->named_by);
  return named && (node.empty() || names_node(reason, *this));
}

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
  fault.can_id = lost_id;
  if (lost_id == 0) fault.node = node;
  return fault;
}

std::vector<std::uint8_t> BusNodes::default_numbers() {
  std::vector<std::uint8_t> numbers(can_map::drive_nodes.begin(), can_map::drive_nodes.end());
  numbers.push_back(can_map::io_node);
  return numbers;
}

std::vector<Cause> all_causes(const BusNodes& bus) {
  std::vector<Cause> causes;
  const auto at = [&](const FaultRule& rule, std::size_t node) {
    return Cause{&rule, bus.names.node(node), bus.numbers.at(node), node == bus.names.size(), 0};
  };
  for (const FaultRule& rule : fault_rules()) {
    const config::FaultPlace place = config::find_fault_kind(rule.kind)->place;
    if (place != config::FaultPlace::frames) {
      for (const std::string& node : config::fault_nodes(place, bus.names)) {
        const std::optional<std::size_t> index = bus.names.find_node(node);
        causes.push_back(index ? at(rule, *index) : Cause{&rule, node});
      }
      continue;
    }
    for (std::size_t i = 0; i < bus.names.node_count(); ++i) {
      for (const std::string& sort : rule.frames) {
        Cause cause = at(rule, i);
        cause.node = sort + " " + cause.node;
        cause.lost_id = function_of(sort) + cause.number;
        causes.push_back(cause);
      }
    }
  }
  return causes;
}

}  // namespace lf::judge
