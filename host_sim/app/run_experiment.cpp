#include "host_sim/app/run_experiment.hpp"

#include <algorithm>

#include "hal/config/drive_kind.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/panel_file.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scene_file.hpp"

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
  for (const std::string& file : {scenario.arm.urdf, scenario.safety.limits}) files.push_back({file, config::find_file(file, folder)});
  if (scenario.joints == JointNames()) files.push_back({scenario::homing_file, config::find_file(scenario::homing_file, folder)});
  files.push_back({scenario::drive_objects_file, config::share_folder() / scenario::drive_objects_file});
  if (!scenario.machine.empty()) files.push_back({scenario.machine, config::find_file(config::machine_file_of(scenario.machine), folder)});
  if (!scenario.survey.file.empty()) files.push_back({scenario.panel_file, scenario.survey.file});
  if (scenario.objects) {
    const fs::path scene = config::find_file(scenario.scene, folder);
    files.push_back({scenario.scene, scene});
    for (const scenario::SceneFile::Placed& object : scenario.objects->objects) {
      if (!object.mesh.empty()) files.push_back({object.said.file + " of " + scenario.scene, object.mesh});
    }
  }
  const std::string& tighter = scenario.safety.mission_limits;
  if (!tighter.empty()) files.push_back({tighter, config::find_file(tighter, folder)});
  for (std::size_t joint = 0; joint < scenario.joints.size(); ++joint) {
    const config::DriveKind kind = config::find_drive_kind(config::drive_of(scenario.drives, joint).profile, folder);
    files.push_back({kind.name + ".yaml", kind.file});
    for (const std::string& base : kind.like) files.push_back({fs::path(base).filename().string(), base});
  }
  return files;
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

bool is_of_scene(const fs::path& file, const scenario::Scenario& scenario) {
  if (!scenario.objects) return false;
  const auto& objects = scenario.objects->objects;
  return file == config::find_file(scenario.scene, fs::path(scenario.file).parent_path()) ||
         std::any_of(objects.begin(), objects.end(), [&](const auto& object) { return object.mesh == file; });
}

// With its meshes, which may lie anywhere, in a folder of its own. Returns its name.
std::string keep_scene(const scenario::SceneFile& scene, const record::RunFolder& run) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const fs::path& mesh = scene.objects[i].mesh;
    names.push_back(mesh.empty() ? "" : "mesh_" + std::to_string(i + 1) + mesh.extension().string());
    if (!mesh.empty()) run.write("scene/" + names.back(), record::bytes_of(mesh));
  }
  run.write("scene/scene.yaml", scenario::scene_yaml(scene, names));
  return "scene/scene.yaml";
}

// A panel's file that lies anywhere but beside the scenario. A shipped one is where it is.
void keep_panel(scenario::Scenario& kept, const record::RunFolder& run) {
  const std::string& file = kept.survey.file;
  if (file.empty() || config::is_shipped(file) || !beside(file, fs::path(kept.file).parent_path()).empty()) return;
  kept.panel_file = "panel.yaml";
  run.write(kept.panel_file, config::read_text_file(file));
}

// A file that a machine's file names by its whole path: one beside the scenario is in the run's folder as the scenario's own are, one that lies anywhere else in a
// folder of the machine's.
std::string keep_named(const fs::path& file, const fs::path& folder, const record::RunFolder& run) {
  const fs::path near = beside(file, folder);
  if (!near.empty()) return near.string();
  std::string name = "machine/" + file.filename().string();
  run.write(name, config::read_text_file(file));
  return name;
}

void keep_name(std::string& name, const fs::path& folder, const record::RunFolder& run) {
  const fs::path file = config::find_file(name, folder);
  if (!name.empty() && !config::is_shipped(file)) name = keep_named(file, folder, run);
}

// With the profiles that it begins with.
void keep_profile(std::string& name, const fs::path& folder, const record::RunFolder& run) {
  if (name.find('/') == std::string::npos) return;  // a shipped one's name
  for (const std::string& base : config::find_drive_kind(name, folder).like) {
    if (!config::is_shipped(base)) (void)keep_named(base, folder, run);
  }
  keep_name(name, folder, run);
}

// What the machine's file says stands in the scenario's keys, once they are all told. The file is kept beside what it names.
void keep_machine(scenario::Scenario& kept, const record::RunFolder& run) {
  if (kept.machine.empty()) return;
  const fs::path folder = fs::path(kept.file).parent_path();
  const fs::path file = config::find_file(config::machine_file_of(kept.machine), folder);
  if (!config::is_shipped(file)) (void)keep_named(file, folder, run);
  kept.machine.clear();
  keep_name(kept.arm.urdf, folder, run);
  keep_name(kept.safety.limits, folder, run);
  keep_profile(kept.drives.profile, folder, run);
  for (auto& drive : kept.drives.joints) keep_profile(drive.profile, folder, run);
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
    if (is_of_scene(file.path, scenario)) continue;  // keep_scene has it
    const fs::path relative = beside(file.path, folder);
    if (!relative.empty()) run.write(relative.string(), config::read_text_file(file.path));
  }
  scenario::Scenario kept = scenario;
  if (scenario.objects) kept.scene = keep_scene(*scenario.objects, run);
  keep_panel(kept, run);
  keep_machine(kept, run);
  name_whole(kept.arm.urdf, folder);
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
