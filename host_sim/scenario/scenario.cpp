#include "host_sim/scenario/scenario.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>

#include "hal/config/fault_kinds.hpp"
#include "hal/config/handle_check.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/key_text.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/panel_file.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "hal/config/task_reach.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "hal/sim/sim_config.hpp"
#include "host_sim/scenario/bounds.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/keys.hpp"
#include "host_sim/scenario/scene_file.hpp"
#include "shared/input_error.hpp"

namespace lf::scenario {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> shipped_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(config::share_folder() / "scenarios")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool looks_like_a_file(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".yaml") || name.ends_with(".yml");
}

fs::path find_scenario(const std::string& file_or_name) {
  if (looks_like_a_file(file_or_name)) return file_or_name;
  const std::vector<std::string> names = shipped_names();
  if (std::find(names.begin(), names.end(), file_or_name) != names.end())
    return config::share_folder() / "scenarios" / (file_or_name + ".yaml");
  const std::string near = config::suggestion(file_or_name, names);
  throw InputError("no scenario '" + file_or_name + "'" +
                   (near.empty() ? "; there are " + config::joined(names, ", ") + ", or give a file" : near));
}

// A profile's name without an ending is a shipped one's.
bool names_a_file(const std::string& path, const std::string& value) {
  if (path.starts_with("drives.") && path.ends_with("profile")) return looks_like_a_file(value);
  return path == "arm.urdf" || (path == "machine" && looks_like_a_file(value)) || path == "scene" ||
         (path == "panel.file" && looks_like_a_file(value)) || path == "safety.limits" || path == "safety.mission_limits";
}

// Whoever types a name means the present folder; in the scenario's file a name means the file's own.
void take_from_here(const Key& key) {
  auto* const* name = std::get_if<std::string*>(&key.value);
  if (name == nullptr || !names_a_file(key.path, **name) || fs::path(**name).is_absolute()) return;
  std::error_code none;
  if (fs::is_regular_file(**name, none)) **name = fs::absolute(**name).lexically_normal();
}

// What the robot is, all of it. Keys that are read after it overrule it.
void read_machine(Scenario& s, const fs::path& file, std::vector<std::string>& problems) {
  config::Machine told;
  told.file = s.file;
  told.drives = simulated_drives();
  config::read_machine_file(file, told, problems);
  s.arm.urdf = told.arm_urdf;
  s.arm.park_rad = told.park_rad;
  s.safety.limits = told.safety_limits;
  static_cast<config::Camera&>(s.camera) = told.camera;
  static_cast<config::Laser&>(s.laser) = told.laser;
  s.vehicle = told.vehicle;
  s.drives = told.drives;
  s.joints = told.joints;
  s.arm_told = told.arm_told;
}

void read_named_machine(Scenario& s, const YAML::Node& root, std::vector<std::string>& problems) {
  const std::string name = config::machine_named_in(root);
  if (name.empty()) return;
  try {
    read_machine(s, config::named_machine(s.file, name), problems);
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
  }
}

// A machine of --set comes after the scenario's own keys, and before the overrides that follow it.
void take_machine(Scenario& s, const config::Source& source, std::vector<std::string>& problems) {
  const fs::path found = config::find_file(config::machine_file_of(s.machine), fs::path(s.file).parent_path());
  std::error_code none;
  if (fs::is_directory(s.machine, none)) source.refuse(YAML::Mark::null_mark(), "'machine': " + s.machine + " is a folder, not a file");
  if (!fs::is_regular_file(found, none)) source.refuse(YAML::Mark::null_mark(), "'machine': " + config::no_machine(s.machine));
  read_machine(s, found, problems);
}

void apply_override(Scenario& scenario, const std::string& text, std::vector<std::string>& problems) {
  const config::Source source = config::Source::of_override(text);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) source.refuse(YAML::Mark::null_mark(), "needs the form path.to.key=value");
  const std::string path = text.substr(0, equals);
  const std::vector<Key> table = keys(scenario);
  const auto found = std::find_if(table.begin(), table.end(), [&](const Key& key) { return key.path == path; });
  const auto within = std::find_if(table.begin(), table.end(), [&](const Key& key) { return key.path.starts_with(path + "."); });
  if (found == table.end() && within != table.end())
    source.refuse(YAML::Mark::null_mark(), "'" + path + "' is a group of keys: name one of them, as " + within->path + "=VALUE");
  if (found == table.end()) source.refuse(YAML::Mark::null_mark(), "unknown key '" + path + "'" + config::suggest_path(path, table));
  config::read_value(parse_yaml(text.substr(equals + 1), source), path, *found, source);
  take_from_here(*found);
  if (path == "arm.urdf") scenario.joints = config::arm_for_checks(scenario.file, scenario.arm.urdf).joints;
  if (path == "machine" && !scenario.machine.empty()) take_machine(scenario, source, problems);
}

double longest_stroke_m(const PanelLayout& panel) {
  double longest_m = 0;
  for (const PanelLayout::Button& button : panel.buttons) longest_m = std::max(longest_m, button.stroke_m);
  return longest_m;
}

void check_buttons(const Scenario& s, const std::function<void(const std::string&)>& refuse) {
  for (const std::string& name : s.buttons.stuck) {
    if (std::find(s.buttons.missing.begin(), s.buttons.missing.end(), name) != s.buttons.missing.end())
      refuse("'buttons.stuck' and 'buttons.missing' both name " + name + ": a button that broke off cannot be stuck");
  }
  for (const auto& [key, names] : {std::pair{"buttons.stuck", &s.buttons.stuck}, std::pair{"buttons.missing", &s.buttons.missing}}) {
    for (const std::string& name : *names) {
      if (!config::find_button(s.survey.names, name)) refuse(std::string("'") + key + "': the panel has no button '" + name + "'");
    }
  }
  if (!config::presses(s.tasks)) return;
  const double half_way_n = s.buttons.preload_n + s.buttons.spring_n_m * longest_stroke_m(s.panel) / 2;
  const double pressed_n = pressed_force_n(s);
  if (half_way_n > pressed_n * 1.001) {
    char text[256];
    std::snprintf(text, sizeof text,
                  "'buttons.preload_n' and 'buttons.spring_n_m' take %.3g N at half the stroke: with 'mission.press_torque_nm' at %.3g a "
                  "press ends at "
                  "%.3g N and would take the button for stuck. It takes %.3g N m",
                  half_way_n, s.mission.press_torque_nm, pressed_n, half_way_n / pressed_n * s.mission.press_torque_nm);
    refuse(text);
  }
}

std::string beyond_stops(const Scenario& s) {
  const config::Spread& start = s.valve.start_deg;
  char text[160], spread[64];
  std::snprintf(spread, sizeof spread, start.min == start.max ? "%.4g" : "%.4g to %.4g", start.min, start.max);
  std::snprintf(text, sizeof text, "'valve.start_deg' is %s, beyond the valve's stops at %.4g and %.4g", spread, s.valve.stop_min_deg,
                s.valve.stop_max_deg);
  return text;
}

// A file says what its valves are.
void refuse_docked_valve(const Scenario& s, const std::function<void(const std::string&)>& refuse) {
  Scenario given = s, usual;
  const std::vector<Key> told = keys(given), defaults = keys(usual);
  for (std::size_t i = 0; i < told.size(); ++i) {
    const bool of_valve = told[i].path.starts_with("valve.") && !told[i].path.starts_with("valve.stop_");  // these are told by settle_panel
    if (of_valve && config::value_text(told[i]) != config::value_text(defaults[i]))
      refuse("'" + told[i].path + "' is of the docked mission's panel: 'panel.file' says what the valves are on this one");
  }
}

// What no single key can tell.
void check_together(const Scenario& s, const std::string& where, std::vector<std::string>& problems) {
  const auto refuse = [&](const std::string& message) { problems.push_back(where + ": " + message); };
  const config::Machine work = work_of(s);
  for (const std::string& problem : config::handle_problems(work)) refuse(problem);
  for (const std::string& problem : config::panel_problems(s.panel, s.survey)) refuse(problem);
  for (const std::string& problem : config::low_button_problems(work)) refuse(problem);
  const bool docked = s.survey.file.empty();
  if (docked && (s.valve.start_deg.min < s.valve.stop_min_deg || s.valve.start_deg.max > s.valve.stop_max_deg)) refuse(beyond_stops(s));
  if (!docked) refuse_docked_valve(s, refuse);
  for (const Fault& fault : s.faults) {
    if (fault.kind == "handle_breaks" && s.panel.valves.empty()) refuse("'faults': handle_breaks: the panel has no valve");
  }
  check_buttons(s, refuse);
  if (s.buttons.release_depth_m >= s.buttons.click_depth_m) refuse("'buttons.release_depth_m' is not below 'buttons.click_depth_m'");
  if (s.buttons.click_drop_n >= returning_force_n(s)) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "'buttons.click_drop_n' is %.3g: the clicked cap would not return, the spring gives %.3g N at 'buttons.release_depth_m'",
                  s.buttons.click_drop_n, returning_force_n(s));
    refuse(text);
  }
  for (std::size_t i = 0; i < s.panel.buttons.size(); ++i) {
    if (s.buttons.click_depth_m <= s.panel.buttons[i].stroke_m) continue;
    refuse("'buttons.click_depth_m' is beyond " + config::button_key(s.survey, i, "stroke_m"));
    break;
  }
  if ((s.panel.plate_min_m.array() >= s.panel.plate_max_m.array()).any()) refuse("'panel.plate_min_m' is not below 'panel.plate_max_m'");
  for (std::size_t i = 0; i < s.panel.markers.size(); ++i) {
    const auto marker = [&](const char* field) { return config::marker_key(s.survey, i, field); };
    if (s.panel.markers[i].plate_m <= s.panel.markers[i].size_m) refuse(marker("plate_m") + " is not larger than " + marker("size_m"));
  }
  if (s.camera.distortion.size() != 5) refuse("'camera.distortion' takes 5 numbers: k1, k2, p1, p2, k3");
  std::size_t tasks = 0;
  for (const Task& task : s.tasks) tasks += task.kind == Task::Kind::turn_valve ? 1 : task.order.size();
  if (tasks > mission::MissionConfig::max_tasks) {
    refuse("'tasks' has " + std::to_string(tasks) + " turns and presses; the core holds " +
           std::to_string(mission::MissionConfig::max_tasks));
  }
}

bool names_a_panel(const YAML::Node& root, const std::vector<std::string>& overrides) {
  return !config::panel_named_in(root).empty() ||
         std::any_of(overrides.begin(), overrides.end(), [](const std::string& text) { return text.starts_with("panel.file="); });
}

void read_scene(Scenario& scenario, std::vector<std::string>& problems) {
  if (scenario.scene.empty()) return;
  try {
    auto objects = std::make_shared<const SceneFile>(read_scene_file(config::named_file(scenario.file, "scene", scenario.scene)));
    const scene::Scene own = scene::bare_scene(scenario.panel, scenario.survey.names);
    for (const SceneFile::Placed& object : objects->objects) {
      const bool taken = std::any_of(own.begin(), own.end(), [&](const scene::Body& body) { return body.name == object.body.name; });
      if (taken)
        problems.push_back(scenario.scene + ": '" + object.body.name + "' is on the panel of " + scenario.survey.file +
                           ", too: messages tell bodies by their names");
    }
    scenario.objects = std::move(objects);
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
  }
}

}  // namespace

config::Machine work_of(const Scenario& s) {
  config::Machine work;
  work.panel = s.panel;
  work.survey = s.survey;
  work.mission = s.mission;
  work.tasks = s.tasks;
  work.arm = s.told_arm;
  work.joints = s.joints;
  return work;
}

std::vector<config::ValveNature> valve_natures(const Scenario& s) {
  if (!s.survey.file.empty()) return s.survey.valves;
  config::ValveNature nature;
  nature.friction_nm = s.valve.friction_nm;
  nature.start_deg = s.valve.start_deg;
  nature.detents_deg = s.valve.detents_deg;
  nature.detent_nm = s.valve.detent_nm;
  nature.viscous_nm_s = s.valve.viscous_nm_s;
  return {nature};
}

Latency::Latency() {
  const hal::SimConfig defaults;
  image_ms = static_cast<double>(defaults.image_latency.ns()) / 1e6;  // 30, where seconds times 1e3 are 30.000000000000004
  panel_vision_ms = static_cast<double>(defaults.vision_latency.ns()) / 1e6;
}

Physics::Physics() {
  const world::WorldConfig world;
  restitution = world.restitution;
  joint_drag_nm_s = world.joint_drag_nm_s;
  drag_coefficient = world.drag_coefficient;
  const devices::DriveConfig drive;
  torque_noise_ratio = drive.torque_noise_ratio;
  water_celsius = drive.water_celsius;
}

Scenario load_scenario(const std::string& file_or_name, const std::vector<std::string>& overrides) {
  const fs::path path = find_scenario(file_or_name);
  Scenario scenario;
  scenario.name = path.stem();
  scenario.file = path;
  std::vector<std::string> problems;
  const config::Source source = config::Source::of_file(path, problems);
  const YAML::Node root = config::parse_yaml(config::read_text_file(path), source);
  // A file's names are not known yet: any is taken, and looked for later.
  read_named_machine(scenario, root, problems);
  // The core's own checks tell why an arm cannot be read.
  std::vector<std::string> told_later;
  YAML::Node readable = root;
  if (root.IsMap()) scenario.joints = config::joints_or_why(readable, path, scenario.joints, told_later);
  if (root.IsMap() && scenario.arm_told) config::forget_joints(readable);
  if (names_a_panel(root, overrides)) scenario.survey.names = {{}, {}, {}};
  if (!root.IsNull()) {
    if (!root.IsMap()) source.refuse(root.Mark(), "a scenario is a group of keys");
    config::read_map(root, "", "", keys(scenario), source);
  }
  for (const std::string& text : overrides) {
    try {
      apply_override(scenario, text, problems);
    } catch (const InputError& problem) {
      problems.emplace_back(problem.what());
    }
  }
  if (!config::settle_panel(path, scenario.panel_file, scenario.docked_panel, scenario.valve, scenario.panel, scenario.survey, problems))
    throw InputError(config::joined(problems));
  const config::NamedArm arm = config::arm_for_checks(scenario.file, scenario.arm.urdf);
  scenario.told_arm = arm.arm;
  scenario.joints = arm.joints;
  read_scene(scenario, problems);
  check_together(scenario, overrides.empty() ? source.name() : source.name() + " with --set", problems);
  if (problems.empty()) return scenario;
  if (scenario.tasks.empty() || config::names_known(scenario.tasks, scenario.survey.names)) add_job_problems(scenario, problems);
  throw InputError(config::joined(problems));
}

std::vector<ShippedScenario> shipped_scenarios() {
  std::vector<ShippedScenario> all;
  for (const std::string& name : shipped_names()) {
    const Scenario scenario = load_scenario(name);
    all.push_back({name, scenario.description, scenario.file});
  }
  return all;
}

}  // namespace lf::scenario
