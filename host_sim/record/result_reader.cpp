#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host_sim/record/result.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::record {
namespace {

using Json = nlohmann::json;

// Missing keys leave the default; null is unknown.
void read(const Json& object, const char* key, double& value) {
  if (const auto it = object.find(key); it != object.end()) value = it->is_null() ? unknown : it->get<double>();
}

template <class Value>
void read(const Json& object, const char* key, Value& value) {
  if (const auto it = object.find(key); it != object.end() && !it->is_null()) it->get_to(value);
}

const Json& section(const Json& document, const char* key) {
  static const Json nothing = Json::object();
  const auto it = document.find(key);
  return it == document.end() || it->is_null() ? nothing : *it;
}

TimesRecord times_from(const Json& json) {
  TimesRecord times;
  read(json, "p50", times.p50);
  read(json, "p99", times.p99);
  read(json, "p999", times.p999);
  read(json, "max", times.max);
  return times;
}

PhaseRecord phase_from(const Json& json) {
  PhaseRecord phase;
  json.at("name").get_to(phase.name);
  read(json, "start_s", phase.start_s);
  read(json, "end_s", phase.end_s);
  read(json, "outcome", phase.outcome);
  return phase;
}

FailureRecord failure_from(const Json& json) {
  FailureRecord failure;
  read(json, "phase", failure.phase);
  read(json, "reason", failure.reason);
  read(json, "cause", failure.cause);
  read(json, "remedy", failure.remedy);
  read(json, "seen", failure.seen);
  return failure;
}

FaultRecord fault_from(const Json& json) {
  FaultRecord fault;
  read(json, "t_s", fault.t_s);
  fault.last_s = fault.t_s;
  read(json, "last_s", fault.last_s);
  read(json, "times", fault.times);
  read(json, "step", fault.step);
  read(json, "fault", fault.fault);
  read(json, "text", fault.text);
  read(json, "reaction", fault.reaction);
  return fault;
}

ProvenanceRecord provenance_from(const Json& json) {
  ProvenanceRecord provenance;
  read(json, "date_utc", provenance.date_utc);
  read(json, "command", provenance.command);
  read(json, "set", provenance.set);
  read(json, "scenario_file", provenance.scenario_file);
  read(json, "experiment", provenance.experiment);
  return provenance;
}

TaskRecord task_from(const Json& json) {
  TaskRecord task;
  json.at("task").get_to(task.task);
  read(json, "valve", task.valve);
  read(json, "button", task.button);
  read(json, "presses", task.presses);
  read(json, "travel_mm", task.travel_mm);
  read(json, "click_felt", task.click_felt);
  read(json, "failure", task.failure);
  read(json, "target_deg", task.target_deg);
  read(json, "reached_deg", task.reached_deg);
  read(json, "done", task.done);
  return task;
}

ErrorRecord errors_from(const Json& json) {
  ErrorRecord errors;
  read(json, "plane_normal_deg", errors.plane_normal_deg);
  read(json, "plane_offset_mm", errors.plane_offset_mm);
  read(json, "panel_over_doubt", errors.panel_over_doubt);
  read(json, "valve_base_mm", errors.valve_base_mm);
  read(json, "handle_angle_deg", errors.handle_angle_deg);
  read(json, "cloud_truth_median_mm", errors.cloud_truth_median_mm);
  read(json, "cloud_truth_p95_mm", errors.cloud_truth_p95_mm);
  read(json, "peak_rms_px", errors.peak_rms_px);
  read(json, "peak_rms_smooth_px", errors.peak_rms_smooth_px);
  read(json, "peak_rms_clear_px", errors.peak_rms_clear_px);
  read(json, "peak_bound_px", errors.peak_bound_px);
  read(json, "peak_rms_at_marks_px", errors.peak_rms_at_marks_px);
  read(json, "peak_recall", errors.peak_recall);
  read(json, "peaks_false", errors.peaks_false);
  read(json, "peaks_elsewhere", errors.peaks_elsewhere);
  return errors;
}

CalibrationRecord calibration_from(const Json& json) {
  CalibrationRecord calibration;
  read(json, "marker_side_percent", calibration.marker_side_percent);
  read(json, "marker_corners_mm", calibration.marker_corners_mm);
  read(json, "plane_bend_mm", calibration.plane_bend_mm);
  read(json, "panel_shift_mm", calibration.panel_shift_mm);
  read(json, "faces_off_mm", calibration.faces_off_mm);
  read(json, "doubt", calibration.doubt);
  read(json, "remedy", calibration.remedy);
  return calibration;
}

DockingRecord docking_from(const Json& json) {
  DockingRecord docking;
  read(json, "attempts", docking.attempts);
  read(json, "offset_mm", docking.offset_mm);
  read(json, "angle_deg", docking.angle_deg);
  read(json, "peak_force_n", docking.peak_force_n);
  return docking;
}

CoreRecord core_from(const Json& json) {
  CoreRecord core;
  if (const auto it = json.find("heap_calls"); it != json.end() && !it->is_null()) core.heap_calls = it->get<std::uint64_t>();
  read(json, "controller_bytes", core.controller_bytes);
  core.tick_us = times_from(section(json, "tick_us"));
  core.frame_us = times_from(section(json, "frame_us"));
  for (const auto& [name, count] : section(json, "rejected_inputs").items()) core.rejected_inputs[name] = count.get<std::uint64_t>();
  return core;
}

void read_host(const Json& document, RunResult& result) {
  const Json& bus = section(document, "bus");
  read(bus, "load_percent", result.bus.load_percent);
  read(bus, "load_unstuffed_percent", result.bus.load_unstuffed_percent);
  read(bus, "load_worst_case_percent", result.bus.load_worst_case_percent);
  read(bus, "frames", result.bus.frames);
  read(bus, "errors", result.bus.errors);
  const Json& host = section(document, "host");
  read(host, "isa", result.host.isa);
  read(host, "threads", result.host.threads);
  read(host, "build", result.host.build);
  const Json& time = section(document, "time");
  read(time, "simulated_s", result.time.simulated_s);
  read(time, "wall_s", result.time.wall_s);
  read(time, "real_time_factor", result.time.real_time_factor);
}

DrawnRecord drawn_from(const Json& json) {
  const auto value_of = [](const Json& value) { return value.is_null() ? unknown : value.get<double>(); };
  DrawnRecord drawn;
  for (const auto& [name, value] : json.items()) {
    std::vector<double>& numbers = drawn[name];
    if (!value.is_array()) numbers.push_back(value_of(value));
    for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) numbers.push_back(value_of(value[i]));
  }
  return drawn;
}

RunResult result_from(const Json& document) {
  RunResult result;
  document.at("scenario").get_to(result.scenario);
  document.at("seed").get_to(result.seed);
  document.at("success").get_to(result.success);
  read(document, "version", result.version);
  result.provenance = provenance_from(section(document, "provenance"));
  if (const Json& failure = section(document, "failure"); !failure.empty()) result.failure = failure_from(failure);
  if (const Json& failure = section(document, "expected_failure"); !failure.empty()) result.expected_failure = failure_from(failure);
  read(document, "false_success", result.false_success);
  for (const Json& fault : section(document, "faults")) result.faults.push_back(fault_from(fault));
  read(document, "faults_left_out", result.faults_left_out);
  read(document, "faults_not_made", result.faults_not_made);
  result.drawn = drawn_from(section(document, "drawn"));
  for (const Json& phase : section(document, "phases")) result.phases.push_back(phase_from(phase));
  for (const Json& task : section(document, "tasks")) result.tasks.push_back(task_from(task));
  result.errors = errors_from(section(document, "errors"));
  if (const Json& calibration = section(document, "calibration"); !calibration.empty()) result.calibration = calibration_from(calibration);
  if (const Json& docking = section(document, "docking"); !docking.empty()) result.docking = docking_from(docking);
  read(section(document, "contact"), "peak_force_n", result.contact.peak_force_n);
  read(section(document, "contact"), "unintended_contacts", result.contact.unintended_contacts);
  result.core = core_from(section(document, "core"));
  read_host(document, result);
  read(document, "digest", result.digest);
  return result;
}

}  // namespace

RunResult parse_result_json(const std::string& text, const std::string& name_for_errors) {
  try {
    return result_from(Json::parse(text));
  } catch (const Json::exception& error) {
    throw InputError(name_for_errors, 0, std::string("is not a run's result: ").append(error.what()));
  }
}

RunResult read_result_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw unreadable(path);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return parse_result_json(text, path.string());
}

}  // namespace lf::record
