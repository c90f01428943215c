#include "host_sim/record/result.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_sim/record/provenance_json.hpp"

namespace lf::record {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN and no infinity.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json to_json(const TimesRecord& times) {
  return {{"p50", number(times.p50)}, {"p99", number(times.p99)}, {"p999", number(times.p999)}, {"max", number(times.max)}};
}

Json to_json(const DrawnRecord& drawn) {
  Json json = Json::object();
  for (const auto& [name, numbers] : drawn) {
    Json values = Json::array();
    for (const double value : numbers) values.push_back(number(value));
    json[name] = values.size() == 1 ? values[0] : values;
  }
  return json;
}

Json to_json(const PhaseRecord& phase) {
  return {{"name", phase.name}, {"start_s", number(phase.start_s)}, {"end_s", number(phase.end_s)}, {"outcome", phase.outcome}};
}

Json to_json(const TaskRecord& task) {
  if (task.task == "press_button") {
    Json json{{"task", task.task}, {"button", task.button}, {"presses", task.presses}, {"done", task.done}};
    if (std::isfinite(task.travel_mm)) {
      json["travel_mm"] = task.travel_mm;
      json["click_felt"] = task.click_felt;
    }
    if (!task.failure.empty()) json["failure"] = task.failure;
    return json;
  }
  Json json{{"task", task.task}};
  if (!task.valve.empty()) json["valve"] = task.valve;
  json.update({{"target_deg", number(task.target_deg)}, {"reached_deg", number(task.reached_deg)}, {"done", task.done}});
  return json;
}

Json to_json(const ErrorRecord& errors) {
  return {{"plane_normal_deg", number(errors.plane_normal_deg)},
          {"plane_offset_mm", number(errors.plane_offset_mm)},
          {"panel_over_doubt", number(errors.panel_over_doubt)},
          {"valve_base_mm", number(errors.valve_base_mm)},
          {"handle_angle_deg", number(errors.handle_angle_deg)},
          {"cloud_truth_median_mm", number(errors.cloud_truth_median_mm)},
          {"cloud_truth_p95_mm", number(errors.cloud_truth_p95_mm)},
          {"peak_rms_px", number(errors.peak_rms_px)},
          {"peak_rms_smooth_px", number(errors.peak_rms_smooth_px)},
          {"peak_rms_clear_px", number(errors.peak_rms_clear_px)},
          {"peak_bound_px", number(errors.peak_bound_px)},
          {"peak_rms_at_marks_px", number(errors.peak_rms_at_marks_px)},
          {"peak_recall", number(errors.peak_recall)},
          {"peaks_false", number(errors.peaks_false)},
          {"peaks_elsewhere", number(errors.peaks_elsewhere)}};
}

Json to_json(const CalibrationRecord& calibration) {
  Json json{{"marker_side_percent", number(calibration.marker_side_percent)},
            {"marker_corners_mm", number(calibration.marker_corners_mm)},
            {"plane_bend_mm", number(calibration.plane_bend_mm)},
            {"panel_shift_mm", number(calibration.panel_shift_mm)},
            {"faces_off_mm", number(calibration.faces_off_mm)}};
  if (!calibration.doubt.empty()) json["doubt"] = calibration.doubt;
  if (!calibration.remedy.empty()) json["remedy"] = calibration.remedy;
  return json;
}

Json to_json(const DockingRecord& docking) {
  return {{"attempts", docking.attempts},
          {"offset_mm", number(docking.offset_mm)},
          {"angle_deg", number(docking.angle_deg)},
          {"peak_force_n", number(docking.peak_force_n)}};
}

Json to_json(const CoreRecord& core) {
  Json rejected = Json::object();
  for (const auto& [name, count] : core.rejected_inputs) rejected[name] = count;
  return {{"heap_calls", core.heap_calls ? Json(*core.heap_calls) : Json(nullptr)},
          {"controller_bytes", core.controller_bytes},
          {"tick_us", to_json(core.tick_us)},
          {"frame_us", to_json(core.frame_us)},
          {"rejected_inputs", std::move(rejected)}};
}

Json to_json(const FailureRecord& failure) {
  Json json{{"phase", failure.phase}, {"reason", failure.reason}};
  if (!failure.cause.empty()) json["cause"] = failure.cause;
  if (!failure.remedy.empty()) json["remedy"] = failure.remedy;
  if (!failure.seen.empty()) json["seen"] = failure.seen;
  return json;
}

Json to_json(const FaultRecord& fault) {
  Json json{{"t_s", number(fault.t_s)}, {"step", fault.step}, {"fault", fault.fault}, {"text", fault.text}};
  if (!fault.reaction.empty()) json["reaction"] = fault.reaction;
  if (fault.times > 1) {
    json["times"] = fault.times;
    json["last_s"] = number(fault.last_s);
  }
  return json;
}

template <class Record>
Json list(const std::vector<Record>& records) {
  Json array = Json::array();
  for (const Record& record : records) array.push_back(to_json(record));
  return array;
}

}  // namespace

Json provenance_json(const ProvenanceRecord& provenance) {
  return {{"date_utc", provenance.date_utc},
          {"command", provenance.command},
          {"set", provenance.set},
          {"scenario_file", provenance.scenario_file},
          {"experiment", provenance.experiment}};
}

TimesRecord times_record(std::vector<double> values_us) {
  if (values_us.empty()) return {};
  std::sort(values_us.begin(), values_us.end());
  const auto rank = [&](double share) {
    const auto nearest = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values_us.size())));
    return values_us[std::clamp<std::size_t>(nearest, 1, values_us.size()) - 1];
  };
  return {rank(0.5), rank(0.99), rank(0.999), values_us.back()};
}

std::string result_json(const RunResult& result) {
  Json document;
  document["scenario"] = result.scenario;
  document["seed"] = result.seed;
  document["version"] = result.version;
  document["provenance"] = provenance_json(result.provenance);
  document["success"] = result.success;
  document["failure"] = nullptr;
  if (result.failure) document["failure"] = to_json(*result.failure);
  if (result.expected_failure) document["expected_failure"] = to_json(*result.expected_failure);
  document["false_success"] = result.false_success;
  document["faults"] = list(result.faults);
  if (result.faults_left_out > 0) document["faults_left_out"] = result.faults_left_out;
  if (!result.faults_not_made.empty()) document["faults_not_made"] = result.faults_not_made;
  document["drawn"] = to_json(result.drawn);
  document["phases"] = list(result.phases);
  document["tasks"] = list(result.tasks);
  document["errors"] = to_json(result.errors);
  if (result.calibration) document["calibration"] = to_json(*result.calibration);
  if (result.docking) document["docking"] = to_json(*result.docking);
  document["contact"] = {{"peak_force_n", number(result.contact.peak_force_n)},
                         {"unintended_contacts", result.contact.unintended_contacts}};
  document["core"] = to_json(result.core);
  document["bus"] = {{"load_percent", number(result.bus.load_percent)},
                     {"load_unstuffed_percent", number(result.bus.load_unstuffed_percent)},
                     {"load_worst_case_percent", number(result.bus.load_worst_case_percent)},
                     {"frames", result.bus.frames},
                     {"errors", result.bus.errors}};
  document["host"] = {{"isa", result.host.isa}, {"threads", result.host.threads}, {"build", result.host.build}};
  document["time"] = {{"simulated_s", number(result.time.simulated_s)},
                      {"wall_s", number(result.time.wall_s)},
                      {"real_time_factor", number(result.time.real_time_factor)}};
  document["digest"] = result.digest;
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace lf::record
