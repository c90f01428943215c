#include "host_sim/judge/report_deadline.hpp"

#include <algorithm>

namespace lf::judge {

namespace {

bool loses_for_good(const Cause& cause, const char* frames) {
  return cause.rule->kind == "drop_frames" && cause.rule->duration_s == 0 && cause.node.starts_with(frames);
}

}  // namespace

std::size_t node_index(const std::string& node, const JointNames& names) {
  const std::string name = node.substr(node.find_last_of(' ') + 1);  // "slew" of "tpdo slew"
  return names.find_node(name).value_or(names.node_count());
}

bool cut_off(const Cause& cause) { return cause.rule->kind == "silent" || cause.rule->kind == "bus_off"; }

bool loses_process_data(const Cause& cause) { return loses_for_good(cause, "rpdo "); }

bool is_unheard(const Cause& cause) { return loses_for_good(cause, "tpdo "); }

bool misleads(const Cause& cause) {
  const std::string& kind = cause.rule->kind;
  return kind == "stuck_encoder" || kind == "encoder_jump" || kind == "runaway" || kind == "following";
}

bool misleads_its_joint(const Cause& cause) { return cause.rule->kind == "runaway" || cause.rule->kind == "stuck_encoder"; }

bool is_a_drives_fault(const Cause& cause) { return cause.rule->kind == "overcurrent" || cause.rule->kind == "hot"; }

bool cuts_off_the_master(const Cause& cause) { return cause.rule->report == Report::unheard || cause.node == "master"; }

bool deafens_the_master(const Cause& cause) { return cause.rule->kind == "can_receive_fails" || cause.node == "master"; }

std::optional<double> told_by_a_frame_s(const Seen& seen, const Cause& cause, double begins_s) {
  if (cause.rule->report == Report::second_master) return seen.second_master_s;
  if (cause.rule->report != Report::frame) return std::nullopt;
  const std::optional<double> said_s = cause.rule->kind == "estop" ? seen.chain_open_s : seen.fault_reported_s;
  return said_s ? std::optional(std::max(begins_s, *said_s)) : std::nullopt;
}

bool told_by_a_frame(const Cause& cause) { return cause.rule->report == Report::frame || cause.rule->report == Report::second_master; }

Deadline report_of(const Seen& seen, const Cause& cause, double begins_s, const JointNames& names, const SafetyFigures& figures) {
  const double stop_s = figures.stop_ms * ms, unread_s = figures.unread_ms * ms, self_stop_s = figures.self_stop_s;
  switch (cause.rule->report) {
    case Report::frame:
    case Report::second_master: return {&cause, told_by_a_frame_s(seen, cause, begins_s).value_or(begins_s), stop_s};
    case Report::silence: {
      const std::size_t node = node_index(cause.node, names);
      const bool known = (cut_off(cause) || is_unheard(cause)) && node < names.node_count();
      const double heard_s = known ? seen.last_heard_s[node] : begins_s;
      return {&cause, std::max(heard_s, begins_s - sync_s), cuts_off_the_master(cause) ? self_stop_s : unread_s};
    }
    case Report::unheard: return {&cause, begins_s, self_stop_s};
    // The arm halts on its own path first, then each drive goes down through every state.
    case Report::halt: return {&cause, begins_s + sync_s, figures.halt_s};
    // Three ticks without a time are a lost clock; an order is read with the next tick.
    case Report::at_once: return {&cause, begins_s + (cause.rule->kind == "clock_lost" ? 3 : 1) * sync_s, stop_s};
    case Report::none: break;
  }
  return {&cause, begins_s, stop_s};
}

}  // namespace lf::judge
