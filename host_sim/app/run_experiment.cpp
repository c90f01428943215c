#include "host_sim/app/run_experiment.hpp"

#include <fstream>
#include <iterator>

#include "hal/config/drive_kind.hpp"
#include "hal/config/share.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scene_file.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace fs = std::filesystem;

namespace {

struct UsedFile {
  std::string name;  // as experiment.json has it
  fs::path path;
};

std::vector<UsedFile> used_files(const scenario::Scenario& scenario) {
  const fs::path folder = fs::path(scenario.file).parent_path();
  std::vector<UsedFile> files;
  for (const std::string& file : {scenario.arm.urdf, scenario.safety.limits, std::string(scenario::homing_file)})
    files.push_back({file, config::find_file(file, folder)});
  files.push_back({scenario::drive_objects_file, config::share_folder() / scenario::drive_objects_file});
  if (!scenario.scene.empty()) {
    const fs::path scene = config::find_file(scenario.scene, folder);
    files.push_back({scenario.scene, scene});
    for (const fs::path& mesh : scenario::scene_of(scenario).meshes)
      files.push_back({mesh.lexically_relative(scene.parent_path()).string() + " of " + scenario.scene, mesh});
  }
  const std::string& tighter = scenario.safety.mission_limits;
  if (!tighter.empty()) files.push_back({tighter, config::find_file(tighter, folder)});
  for (std::size_t joint = 0; joint < joint_count; ++joint) {
    const config::DriveKind kind = config::find_drive_kind(config::drive_of(scenario.drives, joint).profile, folder);
    files.push_back({kind.name + ".yaml", kind.file});
    for (const std::string& base : kind.like) files.push_back({fs::path(base).filename().string(), base});
  }
  return files;
}

std::string whole_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad() || !file.is_open()) throw InputError(path.string() + ": cannot be read");
  return bytes;
}

bool climbs(const fs::path& relative) { return relative.empty() || relative.is_absolute() || *relative.begin() == ".."; }

// A file that lies beside the scenario or below it, as the path from there; empty for a shipped one, and for one anywhere else.
fs::path beside(const fs::path& file, const fs::path& folder) {
  const auto from = [&file](const fs::path& place) { return fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(place)); };
  const fs::path relative = from(folder.empty() ? fs::path(".") : folder);
  return climbs(relative) || !climbs(from(config::share_folder())) ? fs::path() : relative;
}

// What lies above the scenario's folder is named by its whole path: from the run's folder it would be elsewhere.
void name_whole(std::string& name, const fs::path& folder) {
  if (!name.empty() && climbs(fs::path(name).lexically_normal())) name = fs::absolute(config::find_file(name, folder)).lexically_normal();
}

}  // namespace

record::Experiment experiment_of(const scenario::Scenario& scenario) {
  record::Experiment experiment{{"scenario", scenario::scenario_yaml(scenario)}, {"program", record::file_hash("/proc/self/exe")}};
  for (const UsedFile& file : used_files(scenario)) experiment["file " + file.name] = record::file_hash(file.path);
  return experiment;
}

record::Experiment experiment_of(const scenario::Scenario& scenario, std::uint64_t seed) {
  record::Experiment experiment = experiment_of(scenario);
  experiment["seed"] = std::to_string(seed);
  return experiment;
}

void keep_scenario(const scenario::Scenario& scenario, const record::RunFolder& run) {
  const fs::path folder = fs::path(scenario.file).parent_path();
  for (const UsedFile& file : used_files(scenario)) {
    const fs::path relative = beside(file.path, folder);
    if (!relative.empty()) run.write(relative.string(), whole_file(file.path));
  }
  scenario::Scenario kept = scenario;
  name_whole(kept.arm.urdf, folder);
  name_whole(kept.scene, folder);
  name_whole(kept.safety.limits, folder);
  name_whole(kept.safety.mission_limits, folder);
  if (kept.drives.profile.find('/') != std::string::npos) name_whole(kept.drives.profile, folder);
  for (auto& drive : kept.drives.joints) {
    if (drive.profile.find('/') != std::string::npos) name_whole(drive.profile, folder);
  }
  run.write(scenario_file, scenario::scenario_yaml(kept));
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
