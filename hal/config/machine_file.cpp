#include "hal/config/machine_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hal/config/homing_file.hpp"
#include "hal/config/key_listing.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t version = 1;

// A profile's name without an ending is a shipped one's.
bool is_a_profile_file(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".yaml") || name.ends_with(".yml");
}

void settle_name(const fs::path& file, const char* key, std::string& name, std::vector<std::string>& problems) {
  try {
    const fs::path found = named_file(file.string(), key, name);
    if (!is_shipped(found)) name = fs::absolute(found).lexically_normal().string();
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
  }
}

void settle_names(const fs::path& file, Machine& machine, std::vector<std::string>& problems) {
  settle_name(file, "arm.urdf", machine.arm_urdf, problems);
  settle_name(file, "safety.limits", machine.safety_limits, problems);
  if (is_a_profile_file(machine.drives.profile)) settle_name(file, "drives.profile", machine.drives.profile, problems);
  for (std::size_t i = 0; i < joint_count; ++i) {
    std::string& profile = machine.drives.joints[i].profile;
    const std::string key = std::string("drives.") + joint_name(i) + ".profile";
    if (is_a_profile_file(profile)) settle_name(file, key.c_str(), profile, problems);
  }
}

}  // namespace

Keys machine_keys(Machine& machine) {
  Keys all;
  add_arm(all, machine.arm_urdf, machine.park_rad);
  all.push_back(key("safety.limits", "", 0, 0, &machine.safety_limits, "the checksummed file of limits; found as arm.urdf is"));
  add_camera(all, machine.camera);
  add_laser(all, machine.laser);
  add_vehicle(all, machine.vehicle);
  add_drives(all, machine.drives);
  return all;
}

void read_machine_file(const fs::path& file, Machine& machine, std::vector<std::string>& problems) {
  const Source source = Source::of_file(file.string(), problems);
  try {
    const YAML::Node root = parse_yaml(read_text_file(file), source);
    if (!root.IsMap())
      source.refuse(root.Mark(), "a machine is a group of keys: version, arm, safety, camera, laser, vehicle, drives, outputs");
    std::int64_t given = 0;
    Keys table = machine_keys(machine);
    table.push_back(key("version", "", version, version, &given, ""));
    if (!root["version"]) problems.push_back(file.string() + ": has no version: this program reads 'version: 1'");
    read_map(root, "", "", table, source);
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
    return;
  }
  settle_names(file, machine, problems);
}

std::string machine_named_in(const YAML::Node& root) {
  if (!root.IsMap()) return "";
  const YAML::Node name = root["machine"];
  return name && name.IsScalar() ? name.Scalar() : "";
}

std::vector<std::string> keys_left_out(const fs::path& file) {
  const YAML::Node root = parse_yaml(read_text_file(file), Source::of_file(file.string()));
  Machine machine;
  std::vector<std::string> left_out;
  for (const Key& one : machine_keys(machine)) {
    if (std::count(one.path.begin(), one.path.end(), '.') > 1) continue;
    const std::size_t dot = one.path.find('.');
    const YAML::Node group = root[one.path.substr(0, dot)];
    const bool given = (group && group.IsMap() && group[one.path.substr(dot + 1)]) || root[one.path];
    if (!given) left_out.push_back(one.path);
  }
  return left_out;
}

std::string machine_schema() {
  using Json = nlohmann::ordered_json;
  Machine machine;
  Json schema = Json::parse(key_schema(machine_keys(machine), "Lanternfish machine"));
  schema["properties"]["version"] = {{"const", version}};
  schema["required"] = {"version"};
  return schema.dump(2) + "\n";
}

std::string machine_listing() {
  Machine machine, defaults;
  std::string text = key_listing(machine_keys(machine), machine_keys(defaults));
  // Nobody has stated it, and the simulator's drives have one of their own.
  const std::string current = "\n  rated_current_a:";
  if (const std::size_t at = text.find(current); at != std::string::npos) text.insert(at + 1, "#");
  return text;
}

}  // namespace lf::config
