#include "host_sim/serve/serve_result.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host_sim/record/provenance_json.hpp"
#include "shared/can/can_map.hpp"

namespace lf::serve {

namespace {

using Json = nlohmann::ordered_json;

constexpr double valve_accuracy_deg = 3.0;  // as a run's success has it

// A valve's last target counts: the tasks are done one after the other, and nobody says when.
std::vector<record::TaskRecord> score(const world::World& world, const mission::MissionConfig& mission, const PanelNames& names) {
  std::vector<record::TaskRecord> records;
  std::vector<std::uint32_t> wanted(world.button_count());
  std::vector<double> last_target_deg(world.valve_count(), record::unknown);
  for (const mission::Task& task : mission.tasks) {
    if (task.kind == mission::Task::Kind::turn_valve) last_target_deg.at(task.valve) = deg_from_rad(task.to_rad);
  }
  for (const mission::Task& task : mission.tasks) {
    record::TaskRecord record;
    if (task.kind == mission::Task::Kind::turn_valve) {
      record.task = "turn_valve";
      if (names.valves.size() > 1) record.valve = names.valves.at(task.valve);
      record.target_deg = deg_from_rad(task.to_rad);
      record.reached_deg = deg_from_rad(world.valve_angle_rad(task.valve));
      record.done = std::abs(record.reached_deg - last_target_deg.at(task.valve)) <= valve_accuracy_deg;
    } else {
      record.task = "press_button";
      record.button = names.buttons.at(task.button);
      record.presses = static_cast<int>(world.button(task.button).presses);
      record.done = world.button(task.button).presses >= ++wanted.at(task.button);
    }
    records.push_back(record);
  }
  return records;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json times(const record::TimesRecord& t) {
  return {{"p50", number(t.p50)}, {"p99", number(t.p99)}, {"p999", number(t.p999)}, {"max", number(t.max)}};
}

Json tasks_json(const std::vector<record::TaskRecord>& tasks) {
  Json list = Json::array();
  for (const record::TaskRecord& task : tasks) {
    if (task.task == "turn_valve") {
      Json json{{"task", task.task}};
      if (!task.valve.empty()) json["valve"] = task.valve;
      json.update({{"target_deg", task.target_deg}, {"reached_deg", number(task.reached_deg)}, {"done", task.done}});
      list.push_back(json);
    } else {
      list.push_back({{"task", task.task}, {"button", task.button}, {"presses", task.presses}, {"done", task.done}});
    }
  }
  return list;
}

Json camera_json(const ServedCamera::Stats& camera) {
  return {{"exposures", camera.exposures},
          {"frames", camera.frames},
          {"not_rendered", camera.not_rendered},
          {"not_delivered", camera.not_delivered},
          {"troubled", camera.troubled},
          {"late", camera.late},
          {"latency_ms", times(record::times_record(camera.latency_ms))}};
}

}  // namespace

ServeResult make_result(const ServeLoop& loop, const ServedCamera* camera, const mission::MissionConfig& mission, const PanelNames& names) {
  ServeResult result;
  result.tasks = score(loop.world(), mission, names);
  result.success = !result.tasks.empty();
  for (const record::TaskRecord& task : result.tasks) result.success = result.success && task.done;
  const world::ContactReport contacts = loop.world().contacts();
  result.contact = {contacts.peak_force_n, contacts.unintended.size()};
  const ServedBus::Stats& bus = loop.bus().stats();
  result.frames_received = bus.received;
  result.frames_sent = bus.sent;
  result.send_failures = bus.send_failures;
  result.error_frames = bus.error_frames;
  result.simulated_s = loop.simulated().s();
  if (result.simulated_s > 0) result.load_percent = 100.0 * static_cast<double>(bus.bits) / (result.simulated_s * can_map::bitrate);
  result.answer_us = record::times_record(bus.answer_us);
  if (camera != nullptr) result.camera = camera->stats();
  result.pace = loop.pace().stats();
  return result;
}

std::string serve_result_json(const ServeResult& r) {
  const Json bus{{"received", r.frames_received},          {"sent", r.frames_sent},
                 {"send_failures", r.send_failures},       {"error_frames", r.error_frames},
                 {"load_percent", number(r.load_percent)}, {"sync_answered_us", times(r.answer_us)}};
  const Json real_time{{"held", r.pace.held()},
                       {"steps", r.pace.steps},
                       {"over_1_ms_late", r.pace.late_1_ms},
                       {"over_4_ms_late", r.pace.late_4_ms},
                       {"worst_late_ms", 1e3 * r.pace.worst.s()},
                       {"lost_ms", 1e3 * r.pace.lost.s()},
                       {"seconds", r.pace.seconds},
                       {"seconds_not_held", r.pace.seconds_not_held}};
  Json json{{"scenario", r.scenario},
            {"seed", r.seed},
            {"version", r.version},
            {"provenance", record::provenance_json(r.provenance)},
            {"nodes", r.nodes},
            {"success", r.success},
            {"tasks", tasks_json(r.tasks)},
            {"contact", {{"peak_force_n", number(r.contact.peak_force_n)}, {"unintended_contacts", r.contact.unintended_contacts}}}};
  json["bus"] = bus;
  json["camera"] = r.camera ? camera_json(*r.camera) : Json(nullptr);
  json["real_time"] = real_time;
  json["time"] = {{"simulated_s", r.simulated_s}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace lf::serve
