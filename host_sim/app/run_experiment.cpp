#include "host_sim/app/run_experiment.hpp"

#include "hal/config/drive_kind.hpp"
#include "hal/config/share.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::app {

namespace fs = std::filesystem;

record::Experiment experiment_of(const scenario::Scenario& scenario) {
  const fs::path folder = fs::path(scenario.file).parent_path();
  record::Experiment experiment{{"scenario", scenario::scenario_yaml(scenario)}, {"program", record::file_hash("/proc/self/exe")}};
  for (const std::string& file : {scenario.arm.urdf, scenario.safety.limits})
    experiment["file " + file] = record::file_hash(config::find_file(file, folder));
  experiment[std::string("file ") + scenario::homing_file] = record::file_hash(config::find_file(scenario::homing_file, folder));
  experiment[std::string("file ") + scenario::drive_objects_file] =
      record::file_hash(config::share_folder() / scenario::drive_objects_file);
  const std::string& tighter = scenario.safety.mission_limits;
  if (!tighter.empty()) experiment["file " + tighter] = record::file_hash(config::find_file(tighter, folder));
  for (std::size_t joint = 0; joint < joint_count; ++joint) {
    const config::DriveKind kind = config::find_drive_kind(config::drive_of(scenario.drives, joint).profile, folder);
    experiment["file " + kind.name + ".yaml"] = record::file_hash(kind.file);
    for (const std::string& base : kind.like) experiment["file " + fs::path(base).filename().string()] = record::file_hash(base);
  }
  return experiment;
}

record::Experiment experiment_of(const scenario::Scenario& scenario, std::uint64_t seed) {
  record::Experiment experiment = experiment_of(scenario);
  experiment["seed"] = std::to_string(seed);
  return experiment;
}

fs::path default_folder(const std::string& base, bool has_overrides, const record::Experiment& experiment) {
  constexpr std::size_t hash_digits = 8;
  fs::path plain = fs::path("runs") / base;
  std::error_code ignored;
  const bool free = !fs::exists(plain, ignored) || fs::is_empty(plain, ignored);
  const std::optional<record::Experiment> there = free ? experiment : record::read_experiment(plain);
  if (!has_overrides && there && record::difference(*there, experiment).empty()) return plain;
  return fs::path("runs") / (base + "-" + record::hash_of(experiment).substr(0, hash_digits));
}

}  // namespace lf::app
