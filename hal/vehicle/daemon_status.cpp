// How things stand, for operators and for the end of the program.
#include <cstdio>
#include <cstring>

#include "hal/vehicle/daemon.hpp"

namespace lf::hal {

Json Daemon::latencies() const {
  return {{"wake_up_us", histogram_json(platform_.clock().lateness())},
          {"tick_us", histogram_json(control_.probe().took())},
          {"tick_cpu_us", histogram_json(control_.probe().worked())},
          {"image_us", histogram_json(vision_.probe().took())}};
}

Json Daemon::status() const {
  const StatusBoard::Newest now = board_.newest();
  Json json = status_json(now.control, now.telemetry, config_.core.error_texts, config_.machine.survey.names);
  json["interface"] = config_.interface;
  if (now.control.commissioning) {
    json["standing"] = "commissioning";
    json["commissioning"] = {{"state", name(now.control.commissioning_state)}};
    const JointNames& joints = config_.core.error_texts.names();
    if (now.control.commissioning_joint < joints.size()) json["commissioning"]["joint"] = joints[now.control.commissioning_joint];
  } else if (const Json last = commissioner_.last(); !last.is_null()) {
    json["commissioning"] = last;
  }
  if (estop_.present()) json["estop_input_closed"] = estop_line_.closed(monotonic_now());
  if (const std::string unknown = commissioner_.unknown_joints(); !unknown.empty()) json["without a zero"] = unknown;
  json["latency"] = latencies();
  json["ticks"] = now.control.ticks;
  json["core"] = {{"heap_calls", now.control.heap_calls}, {"page_faults", now.control.page_faults}, {"realtime", now.control.realtime}};
  json["lost"] = lost_;
  json["camera"] = {{"images", now.camera.images}, {"status", now.camera.status > 0 ? std::strerror(now.camera.status) : "ok"}};
  json["frames"] = {{"received", now.control.can.received}, {"sent", now.control.can.sent}};
  json["counters"] = counters_json(now.control, now.camera, now.telemetry);
  if (const std::string trouble = writer_.trouble(); !trouble.empty()) json["log"] = trouble;
  return json;
}

std::string Daemon::summary() const {
  const StatusBoard::Newest now = board_.newest();
  std::string text;
  const auto add = [&text](const char* what, const LatencyHistogram& h) {
    char line[160];
    std::snprintf(line, sizeof line, "%-18s p50 %7.1f us, p99 %7.1f us, p99.9 %7.1f us, max %8.1f us of %llu\n", what, h.percentile_us(0.5),
                  h.percentile_us(0.99), h.percentile_us(0.999), h.max_us(), static_cast<unsigned long long>(h.count()));
    text += line;
  };
  add("wake-up lateness", platform_.clock().lateness());
  add("control tick", control_.probe().took());
  add("tick, processor", control_.probe().worked());
  add("image", vision_.probe().took());
  text += "ticks " + std::to_string(now.control.ticks) + ", missed " + std::to_string(now.control.missed_ticks) + ", page faults " +
          std::to_string(now.control.page_faults) + ", heap calls " + std::to_string(now.control.heap_calls) + "\n";
  text += "counted: " + counters_json(now.control, now.camera, now.telemetry).dump() + "\n";
  return text;
}

}  // namespace lf::hal
