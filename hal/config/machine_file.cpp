#include "hal/config/machine_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hal/config/joined.hpp"
#include "hal/config/key_listing.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/park_pose.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t version = 1;
const std::vector<std::string> group_names{"version", "arm", "safety", "camera", "laser", "vehicle", "drives", "outputs"};
constexpr const char* what_it_has =
    "a machine's file has version, arm, safety, camera, laser, vehicle, drives and outputs; what is done, and before what, a scenario says";

// A name without an ending is a shipped one's.
bool is_a_file(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".yaml") || name.ends_with(".yml"); }

// What is not there is told here, and `usual` is taken for it, so that nobody tells it again.
void settle_name(const fs::path& file, const fs::path& teller, const std::string& key, std::string& name, const std::string& usual,
                 std::vector<std::string>& problems) {
  try {
    if (name.empty()) throw InputError(file.string() + ": '" + key + "' is empty: it names a file");
    const fs::path found = named_file(file.string(), key.c_str(), name);
    // A shipped file keeps its name where whoever named the machine finds the same one by it.
    std::error_code none;
    const bool same = is_shipped(found) && fs::equivalent(find_file(name, teller), found, none);
    if (!same) name = fs::absolute(found).lexically_normal().string();
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
    name = usual;
  }
}

void settle_names(const fs::path& file, Machine& machine, std::vector<std::string>& problems) {
  const Machine usual;
  const fs::path teller = fs::path(machine.file).parent_path();
  settle_name(file, teller, "arm.urdf", machine.arm_urdf, usual.arm_urdf, problems);
  settle_name(file, teller, "safety.limits", machine.safety_limits, usual.safety_limits, problems);
  if (is_a_file(machine.drives.profile))
    settle_name(file, teller, "drives.profile", machine.drives.profile, usual.drives.profile, problems);
  for (std::size_t i = 0; i < machine.joints.size(); ++i) {
    std::string& profile = machine.drives.joints[i].profile;
    if (is_a_file(profile)) settle_name(file, teller, "drives." + machine.joints[i] + ".profile", profile, "", problems);
  }
}

// Groups that it has not: most are a scenario's.
void refuse_groups(YAML::Node& root, const Source& source, std::vector<std::string>& problems) {
  std::vector<std::string> foreign;
  for (const auto& entry : root) {
    const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
    const std::string group = name.substr(0, name.find('.'));
    if (std::find(group_names.begin(), group_names.end(), group) != group_names.end()) continue;
    try {
      const std::string near = suggestion(group, group_names);
      source.refuse(entry.first.Mark(), "unknown key '" + name + "'" + (near.empty() ? std::string(": ") + what_it_has : near));
    } catch (const InputError& problem) {
      problems.emplace_back(problem.what());
      foreign.push_back(name);
    }
  }
  for (const std::string& name : foreign) root.remove(name);
}

// As with names: what is told here is not told again.
void check_counts(const fs::path& file, Machine& machine, std::vector<std::string>& problems) {
  if (const std::string problem = park_problem(machine); !problem.empty()) {
    problems.push_back(file.string() + ": " + problem);
    machine.park_rad = Machine().park_rad;
  }
  if (machine.camera.distortion.size() != Machine().camera.distortion.size()) {
    problems.push_back(file.string() + ": 'camera.distortion' takes 5 numbers: k1, k2, p1, p2, k3");
    machine.camera.distortion = Machine().camera.distortion;
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
  add_drives(all, machine.drives, machine.joints);
  return all;
}

void read_machine_file(const fs::path& file, Machine& machine, std::vector<std::string>& problems) {
  const Source source = Source::of_file(file.string(), problems);
  try {
    YAML::Node root = parse_yaml(read_text_file(file), source);
    if (!root.IsMap()) source.refuse(root.Mark(), what_it_has);
    std::int64_t given = 0;
    const bool own = machine.arm_urdf == Machine().arm_urdf;
    const std::size_t before = problems.size();
    machine.joints = joints_or_why(root, file, machine.joints, problems);
    machine.arm_told = problems.size() > before;
    Keys table = machine_keys(machine);
    table.push_back(key("version", "", version, version, &given, ""));
    if (!root["version"]) problems.push_back(file.string() + ":1: has no version: this program reads 'version: 1'");
    refuse_groups(root, source, problems);
    read_map(root, "", "", table, source);
    check_counts(file, machine, problems);
    if (own && machine.joints != JointNames() && machine.park_rad == Machine().park_rad)
      problems.push_back(file.string() +
                         ": 'arm.park_rad' is missing: the folded pose of an arm of other joints than the default's has to be stated");
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
    return;
  }
  const bool own_arm = machine.arm_urdf != Machine().arm_urdf, own_limits = machine.safety_limits != Machine().safety_limits;
  const std::size_t told = problems.size();
  settle_names(file, machine, problems);
  if (own_arm && !own_limits && problems.size() == told)
    problems.push_back(file.string() +
                       ": 'arm.urdf' is an arm of your own: 'safety.limits' has to name its limits, the shipped ones are the ARM 5E's");
}

std::string machine_file_of(const std::string& name) { return is_a_file(name) || name.empty() ? name : "machines/" + name + ".yaml"; }

std::string no_machine(const std::string& name) {
  if (is_a_file(name)) return "there is no " + name + " here, nor beside the scenario, nor among the shipped files";
  const std::vector<std::string> shipped = shipped_in("machines");
  const std::string near = suggestion(name, shipped);
  return "no shipped machine '" + name + "'" + (near.empty() ? "; there are " + joined(shipped, ", ") + ", or give a file" : near);
}

fs::path named_machine(const std::string& told_in, const std::string& name) {
  const std::string file = machine_file_of(name);
  std::error_code none;
  const bool known = fs::exists(find_file(file, fs::path(told_in).parent_path()), none);
  if (!known && !is_a_file(name)) throw InputError(told_in + ": 'machine': " + no_machine(name));
  return named_file(told_in, "machine", file);
}

std::string machine_named_in(const YAML::Node& root) {
  if (!root.IsMap()) return "";
  const YAML::Node name = root["machine"];
  return name && name.IsScalar() ? name.Scalar() : "";
}

JointNames joints_named_in(const YAML::Node& root, const fs::path& file, const JointNames& usual) {
  if (!root.IsMap()) return usual;
  const YAML::Node group = root["arm"];
  const YAML::Node named = group && group.IsMap() ? group["urdf"] : root["arm.urdf"];
  if (!named || !named.IsScalar() || named.Scalar().empty()) return usual;
  return load_arm_urdf(named_file(file.string(), "arm.urdf", named.Scalar())).names();
}

void forget_joints(YAML::Node& root) {
  root.remove("drives");
  if (YAML::Node arm = root["arm"]; arm && arm.IsMap()) arm.remove("park_rad");
}

JointNames joints_or_why(YAML::Node& root, const fs::path& file, const JointNames& usual, std::vector<std::string>& problems) {
  try {
    return joints_named_in(root, file, usual);
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
    forget_joints(root);
    return usual;
  }
}

std::vector<std::string> keys_left_out(const fs::path& file) {
  const YAML::Node root = parse_yaml(read_text_file(file), Source::of_file(file.string()));
  Machine machine;
  machine.joints = joints_named_in(root, file, machine.joints);
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
