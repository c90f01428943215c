#include "host_sim/campaign/campaign.hpp"

#include "host_sim/campaign/figures.hpp"

namespace lf::campaign {

RunSummary run_of(const record::RunResult& result, const std::string& folder, bool has_report) {
  RunSummary run;
  run.seed = result.seed;
  run.success = result.success;
  run.false_success = result.false_success;
  run.calibration_doubted = result.calibration && !result.calibration->doubt.empty();
  run.failure = result.failure;
  if (result.expected_failure) run.as_expected = result.expected_failure->reason;
  run.figures = figures_of(result);
  run.wall_s = result.time.wall_s;
  run.digest = result.digest;
  run.folder = folder;
  run.has_report = has_report;
  return run;
}

std::string verdict_of(const RunSummary& run) {
  const std::string doubted = run.calibration_doubted ? ", doubtful calibration" : "";
  if (run.success) return (run.as_expected.empty() ? "ok" : "ok, it failed as expected: " + run.as_expected) + doubted;
  const std::string failed = run.false_success ? "FALSE SUCCESS" : "failed";
  return run.failure ? failed + " in " + run.failure->phase + ": " + run.failure->reason : failed;
}

}  // namespace lf::campaign
