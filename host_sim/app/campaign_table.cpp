#include "host_sim/app/campaign_table.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/app/scoring.hpp"

namespace lf::app {

namespace {

struct Figure {
  const char* name;
  const char* unit;
  double (*of)(const record::RunResult&);
  bool more_is_better = false;
};

double valve_error(const record::RunResult& result) {
  double worst = record::unknown;
  for (const record::TaskRecord& task : result.tasks) {
    if (task.task == "turn_valve" && task.done) worst = std::fmax(worst, std::abs(task.reached_deg - task.target_deg));
  }
  return worst;
}

const std::array<Figure, 13> figures{
    {{"plane_normal_deg", "deg", [](const record::RunResult& r) { return r.errors.plane_normal_deg; }},
     {"plane_offset_mm", "mm", [](const record::RunResult& r) { return r.errors.plane_offset_mm; }},
     {"valve_base_mm", "mm", [](const record::RunResult& r) { return r.errors.valve_base_mm; }},
     {"handle_angle_deg", "deg", [](const record::RunResult& r) { return r.errors.handle_angle_deg; }},
     {"valve_final_deg", "deg", valve_error},
     {"cloud_truth_median_mm", "mm", [](const record::RunResult& r) { return r.errors.cloud_truth_median_mm; }},
     {"cloud_truth_p95_mm", "mm", [](const record::RunResult& r) { return r.errors.cloud_truth_p95_mm; }},
     {"peak_rms_px", "px", [](const record::RunResult& r) { return r.errors.peak_rms_px; }},
     {"peak_rms_smooth_px", "px", [](const record::RunResult& r) { return r.errors.peak_rms_smooth_px; }},
     {"peak_recall", "", [](const record::RunResult& r) { return r.errors.peak_recall; }, true},
     {"peaks_false", "", [](const record::RunResult& r) { return r.errors.peaks_false; }},
     {"simulated_s", "s", [](const record::RunResult& r) { return r.time.simulated_s; }},
     {"real_time_factor", "x", [](const record::RunResult& r) { return r.time.real_time_factor; }, true}}};

Spread3 spread_of(std::vector<double> values, bool more_is_better) {
  if (!more_is_better) return {percentile(values, 0.5), percentile(values, 0.95), percentile(values, 1.0)};
  for (double& value : values) value = -value;
  return {-percentile(values, 0.5), -percentile(values, 0.95), -percentile(values, 1.0)};
}

}  // namespace

CampaignTable tabulate(const std::vector<record::RunResult>& results) {
  CampaignTable table;
  table.runs = results.size();
  for (const record::RunResult& result : results) {
    table.false_successes += result.false_success ? 1 : 0;
    if (result.success)
      ++table.successes;
    else
      table.failures.push_back(result);
  }
  for (const Figure& figure : figures) {
    std::vector<double> values;
    for (const record::RunResult& result : results) {
      if (const double value = figure.of(result); std::isfinite(value)) values.push_back(value);
    }
    if (values.empty()) continue;
    table.errors.push_back({figure.name, figure.unit, spread_of(std::move(values), figure.more_is_better)});
  }
  return table;
}

void tell(const CampaignTable& table) {
  print("\n%zu of %zu succeeded, %zu false successes\n", table.successes, table.runs, table.false_successes);
  if (!table.errors.empty()) print("%-20s %10s %10s %10s\n", "", "median", "p95", "worst");
  for (const ErrorColumn& error : table.errors) {
    print("%-20s %10.3f %10.3f %10.3f %s\n", error.name.c_str(), error.values.median, error.values.p95, error.values.worst,
          error.unit.c_str());
  }
  for (const record::RunResult& result : table.failures) {
    const record::FailureRecord failure = result.failure.value_or(record::FailureRecord{"?", "?"});
    print("failed: seed %llu in %s: %s\n", static_cast<unsigned long long>(result.seed), failure.phase.c_str(), failure.reason.c_str());
  }
}

Json json_of(const CampaignTable& table) {
  Json errors = Json::object(), failures = Json::array();
  for (const ErrorColumn& error : table.errors) {
    errors[error.name] = {{"median", error.values.median}, {"p95", error.values.p95}, {"worst", error.values.worst}};
  }
  for (const record::RunResult& result : table.failures) {
    const record::FailureRecord failure = result.failure.value_or(record::FailureRecord{"?", "?"});
    failures.push_back({{"seed", result.seed}, {"phase", failure.phase}, {"reason", failure.reason}});
  }
  return {{"runs", table.runs},
          {"successes", table.successes},
          {"false_successes", table.false_successes},
          {"errors", errors},
          {"failures", failures}};
}

}  // namespace lf::app
