#include "hal/vehicle/status_json.hpp"

#include <array>
#include <cstdio>
#include <string>

#include "firmware/canopen/emcy.hpp"
#include "firmware/canopen/sdo_abort.hpp"
#include "hal/config/boot_sentence.hpp"
#include "hal/config/event_json.hpp"
#include "hal/config/fault_text.hpp"
#include "hal/config/homing_file.hpp"

namespace lf::hal {

const char* name(Port port) {
  constexpr std::array<const char*, port_count> names{"clock",        "can receive",   "can send",  "camera",
                                                      "panel submit", "panel receive", "telemetry", "scan ring"};
  const auto i = static_cast<std::size_t>(port);
  return i < names.size() ? names[i] : "unknown";
}

namespace {

void count(Json& json, const char* what, std::uint64_t n) {
  if (n > 0) json[what] = n;
}

Json can_counters(const SocketCan::Stats& s) {
  Json json = Json::object();
  count(json, "receive queue overflowed", s.overflowed);
  count(json, "not sent in time", s.expired);
  count(json, "not sent", s.refused);
  count(json, "transmit queue full", s.full);
  count(json, "transmit queue stuck", s.stuck);
  count(json, "malformed", s.malformed);
  count(json, "receive times missed", s.stamps_missed);
  count(json, "interface down", s.downs);
  count(json, "interface gone", s.losses);
  count(json, "interface back", s.reopened);
  count(json, "error frames", s.errors.frames);
  count(json, "bus off", s.errors.bus_off);
  count(json, "controller restarted", s.errors.restarted);
  count(json, "error passive", s.errors.passive);
  count(json, "error warning", s.errors.warning);
  count(json, "controller overrun", s.errors.overrun);
  count(json, "protocol violations", s.errors.protocol);
  count(json, "no acknowledge", s.errors.no_acknowledge);
  count(json, "arbitration lost", s.errors.lost_arbitration);
  count(json, "transmit time-outs", s.errors.transmit_timeout);
  count(json, "transceiver", s.errors.transceiver);
  count(json, "other errors", s.errors.other);
  return json;
}

Json camera_counters(const CameraReport& c) {
  Json json = Json::object();
  count(json, "frames skipped", c.skipped);
  count(json, "frames broken", c.broken);
  count(json, "frames repeated", c.repeated);
  count(json, "frames overwritten", c.missed);
  count(json, "time stamps missed", c.stamps_missed);
  count(json, "controls refused", c.controls_refused);
  count(json, "camera gone", c.losses);
  count(json, "camera back", c.reopened);
  count(json, "writer restarted", c.restarts);
  return json;
}

Json scan_counters(const ScanStats& s) {
  Json json = Json::object();
  count(json, "images", s.images);
  count(json, "unexpected", s.images_unexpected);
  count(json, "repeated", s.images_repeated);
  count(json, "refused", s.images_refused);
  count(json, "missing", s.images_missing);
  count(json, "peaks without a stripe's shape", s.peaks_unfitted + s.peaks_misfit);
  count(json, "peaks of no line", s.peaks_apart);
  count(json, "points", s.points);
  count(json, "points without joints", s.points_no_joints);
  return json;
}

Json node_json(const canopen::NodeBoot& boot) {
  Json json;
  constexpr std::array<const char*, 4> states{"idle", "running", "done", "failed"};
  json["node"] = boot.node;
  json["boot"] = states[static_cast<std::size_t>(boot.state)];
  if (boot.device_name[0] != '\0') json["name"] = std::string(boot.device_name.data());
  if (boot.failure != canopen::BootFailure::none) {
    json["failure"] = canopen::name(boot.failure);
    char object[16];
    std::snprintf(object, sizeof object, "%04X:%02X", boot.index, boot.sub);
    json["object"] = object;
    if (boot.abort_code != 0) json["abort"] = canopen::sdo_abort::name(boot.abort_code);
  }
  return json;
}

Json tasks_json(const ControlReport& control, const PanelNames& names) {
  Json all = Json::array();
  for (const mission::TaskResult& result : control.tasks) {
    Json json;
    if (result.task.kind == mission::Task::Kind::turn_valve) {
      json["task"] = "turn_valve";
      if (names.valves.size() > 1 && result.task.valve < names.valves.size()) json["valve"] = names.valves[result.task.valve];
      json["target_deg"] = deg_from_rad(result.task.to_rad);
      if (result.done) json["reached_deg"] = deg_from_rad(result.reached_rad);
    } else {
      json["task"] = "press_button";
      json["button"] = result.task.button < names.buttons.size() ? names.buttons[result.task.button] : "?";
      json["presses"] = result.presses;
      if (result.attempted) json["travel_mm"] = 1e3 * result.travel_m;
      if (result.attempted) json["click_felt"] = result.click_felt;
      if (result.face_felt) json["face_off_mm"] = 1e3 * result.face_off_m;
      if (result.failure != StepFailure::none) json["failure"] = lf::name(result.failure);
    }
    json["done"] = result.done;
    all.push_back(json);
  }
  return all;
}

}  // namespace

Json histogram_json(const LatencyHistogram& histogram) {
  return {{"count", histogram.count()},
          {"p50", histogram.percentile_us(0.5)},
          {"p99", histogram.percentile_us(0.99)},
          {"p999", histogram.percentile_us(0.999)},
          {"max", histogram.max_us()}};
}

Json counters_json(const ControlReport& control, const CameraReport& camera, const Telemetry& telemetry) {
  Json json = Json::object();
  Json ports = Json::object(), refused = Json::object();
  for (std::size_t i = 0; i < port_count; ++i) count(ports, name(static_cast<Port>(i)), control.port_errors[i]);
  for (std::size_t i = 0; i < canopen::refusal_count; ++i)
    count(refused, canopen::name(static_cast<canopen::Refusal>(i)), control.network.refused[i]);
  json["faults"] = config::fault_counts_json(telemetry.faults);
  json["platform calls failed"] = ports;
  json["frames refused"] = refused;
  json["can"] = can_counters(control.can);
  json["camera"] = camera_counters(camera);
  json["images"] = scan_counters(control.scan);
  count(json, "ticks missed", control.missed_ticks);
  count(json, "orders refused", control.orders_refused);
  count(json, "inputs rejected", control.rejected_inputs);
  count(json, "emergency messages", control.network.emcys);
  count(json, "frames not logged", control.frames_unlogged);
  return json;
}

Json status_json(const ControlReport& control, const Telemetry& telemetry, const config::ErrorTexts& texts, const PanelNames& names) {
  Json json;
  json["t_s"] = control.t.s();
  json["standing"] = mission::name(control.standing);
  json["step"] = mission::row(control.step).name;
  json["stage"] = mission::row(control.step).stage;
  if (control.outcome.ended) {
    json["success"] = control.outcome.success;
    if (!control.outcome.success) {
      json["failure"] = {
          {"phase", control.outcome.stage},
          {"step", mission::row(control.outcome.step).name},
          {"reason", safety::name(control.outcome.fault)},
          {"text", config::fault_text(control.outcome.fault, control.outcome.code, control.outcome.emcy, texts, telemetry.sight)},
          {"code", control.outcome.code}};
      json["failure"].update(config::cause_json(control.outcome.fault, control.outcome.code, telemetry.sight));
    }
    const Json later = config::fault_counts_json(control.faults_after_end);
    if (!later.empty()) json["faults since the end"] = later;
  }
  json["tasks"] = tasks_json(control, names);
  if (const Json fit = config::fit_json(telemetry.sight.fit, control.tasks); !fit.empty()) json["fit"] = fit;
  const JointNames& joints = texts.names();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Json joint{{"joint", joints[i]},
               {"state", canopen::name(control.axes[i])},
               {"actual_rad", telemetry.actual_rad[i]},
               {"target_rad", telemetry.target_rad[i]},
               {"torque_nm", telemetry.torque_nm[i]}};
    if (control.axis_faults[i] != canopen::AxisFault::none) joint["fault"] = canopen::name(control.axis_faults[i]);
    json["joints"].push_back(joint);
  }
  for (std::size_t i = 0; i < control.boot.nodes.size(); ++i) {
    Json node = node_json(control.boot.nodes[i]);
    if (const std::string why = config::boot_sentence(control.boot.nodes[i], i < joints.size() ? joints[i] : "outputs"); !why.empty())
      node["why"] = why;
    json["nodes"].push_back(node);
  }
  json["inputs_fresh"] = control.inputs_fresh;
  // What the node said last means nothing once it is no longer heard.
  json["estop_closed"] = control.inputs_fresh && (control.inputs & can_map::input_estop_closed) != 0;
  json["interlock_closed"] = control.inputs_fresh && (control.inputs & can_map::input_interlock_closed) != 0;
  json["laser"] = (control.outputs & can_map::output_laser) != 0;
  json["lamps"] = (control.outputs & can_map::output_lamps) != 0;
  return json;
}

}  // namespace lf::hal
