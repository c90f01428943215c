#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "firmware/arm/chain/ik.hpp"
#include "hal/config/arm_chain.hpp"
#include "hal/config/nearest.hpp"
#include "host_sim/app/check_machine.hpp"
#include "host_sim/app/check_panel.hpp"
#include "host_sim/app/check_scene.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "shared/input_error.hpp"
#include "shared/urdf/read_urdf.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string kind, file;
  config::ArmEnds ends{.base_link = "", .tool_link = "", .approach = "", .opening = ""};  // empty: not given
  std::vector<std::string> package_folders;
  std::string picture;
  int postures = 200;
  bool ignore_missing = false, json = false;
};

// What random postures of an arm say about it.
struct Trial {
  chain::IkTask task;  // what was asked of the tool, its pose not set
  int found = 0, by_closed_form = 0;
  double farthest_m = 0;                                                         // the tool from the first joint
  Vec3 lower_m = Vec3::Constant(INFINITY), upper_m = Vec3::Constant(-INFINITY);  // the tool, base frame
};

// What so many joints can hold: four a bar's direction, five an axis to approach along.
chain::IkTask most_of(std::size_t joints) {
  chain::IkTask task;
  task.axis = joints >= 5;
  task.roll = joints == 4 || joints >= 6;
  return task;
}

const char* text_of(const chain::IkTask& task) {
  if (task.axis) return task.roll ? "position, approach axis and roll" : "position and approach axis";
  return task.roll ? "position and roll" : "position";
}

// Whatever the solver says of itself.
bool is_there(const chain::Chain& arm, const chain::IkTask& task, const chain::JointValues& q) {
  constexpr double near = 1e-6;  // rad, and of the arm's length
  for (std::size_t i = 0; i < arm.size(); ++i) {
    if (std::abs(arm.excess(i, q[Eigen::Index(i)])) > 1e-9) return false;
  }
  const Pose tool = arm.base_from_tool(q);
  const chain::TaskError error = chain::task_error(task, tool.linear(), tool.translation());
  return error.position_m <= near * arm.length_m() && error.orientation_rad <= near;
}

// The tool is put where random postures have it, from the middle of the joints' ranges.
Trial try_postures(const chain::Chain& arm, int postures) {
  Trial trial;
  trial.task = most_of(arm.size());
  chain::Ik ik(arm);
  const Vec3 first_joint_m = arm.joint(0).parent_from_joint.translation();
  std::uint64_t state = 1;
  for (int i = 0; i < postures; ++i) {
    chain::IkTask task = trial.task;
    task.base_from_tool = arm.base_from_tool(config::random_posture(arm, state));
    const Vec3 tool_m = task.base_from_tool.translation();
    trial.lower_m = trial.lower_m.cwiseMin(tool_m), trial.upper_m = trial.upper_m.cwiseMax(tool_m);
    trial.farthest_m = std::max(trial.farthest_m, (tool_m - first_joint_m).norm());
    const chain::IkResult& result = ik.solve(task, arm.middle());
    if (!result.ok() || !is_there(arm, task, result.q)) continue;
    ++trial.found;
    if (result.closed_form) ++trial.by_closed_form;
  }
  return trial;
}

Json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

template <typename Number>
Json or_null(const std::optional<Number>& value) {
  return value ? Json(*value) : Json(nullptr);
}

const char* kind_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::JointType::revolute: return "revolute";
    case urdf::JointType::continuous: return "continuous";
    case urdf::JointType::prismatic: return "prismatic";
    case urdf::JointType::fixed: break;
  }
  return "fixed";
}

// Axes at joint values 0.
chain::ChainState at_zero(const chain::Chain& arm) {
  chain::ChainState state;
  arm.evaluate(chain::JointValues::Zero(), state);
  return state;
}

void answer(const urdf::Reading& reading, const config::ArmChain& arm, const chain::Ik& ik, const Trial& trial, int postures) {
  const urdf::Mechanism& mechanism = reading.mechanism;
  const chain::ChainState state = at_zero(arm.chain);
  Json json{{"file", mechanism.file}, {"name", mechanism.name}, {"base_link", arm.base_link}, {"tool_link", arm.tool_link}};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const urdf::Joint& joint = mechanism.joints[arm.joints[i]];
    json["joints"].push_back({{"name", joint.name},
                              {"kind", kind_of(joint)},
                              {"lower", joint.range ? Json(joint.range->lower) : Json(nullptr)},
                              {"upper", joint.range ? Json(joint.range->upper) : Json(nullptr)},
                              {"velocity", or_null(joint.velocity)},
                              {"effort", or_null(joint.effort)},
                              {"axis", numbers(state.axis[i])}});
  }
  json["tool"] = {{"position_m", numbers(state.tool_m)}, {"approach", numbers(state.tool.col(2))}, {"opening", numbers(state.tool.col(0))}};
  json["inverse_kinematics"] = {{"family", chain::name(ik.family())},
                                {"reason", ik.reason()},
                                {"task", text_of(trial.task)},
                                {"postures", postures},
                                {"found", trial.found},
                                {"by_closed_form", trial.by_closed_form}};
  if (postures > 0)
    json["tool_seen"] = {{"farthest_m", trial.farthest_m}, {"lower_m", numbers(trial.lower_m)}, {"upper_m", numbers(trial.upper_m)}};
  json["notes"] = Json::array();
  for (const urdf::Note& note : reading.notes) json["notes"].push_back({{"line", note.line}, {"text", note.text}});
  print_json(json);
}

// For people: "0.000", never "-0.000".
Vec3 shown(const Vec3& v) {
  return v.unaryExpr([](double x) { return std::abs(x) < 5e-5 ? 0.0 : x; });
}

std::string cell(const std::optional<double>& value, const char* unknown) {
  if (!value) return unknown;
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.4g", *value);
  return text;
}

void tell(const urdf::Reading& reading, const config::ArmChain& arm, const chain::Ik& ik, const Trial& trial, int postures) {
  const urdf::Mechanism& mechanism = reading.mechanism;
  const chain::ChainState state = at_zero(arm.chain);
  const Vec3 tool_m = shown(state.tool_m), approach = shown(state.tool.col(2)), opening = shown(state.tool.col(0));
  print("%s: %s from %s to %s, %s\n", mechanism.file.c_str(), mechanism.name.c_str(), arm.base_link.c_str(), arm.tool_link.c_str(),
        count_of(arm.joints.size(), "joint").c_str());
  print("%-24s %-10s %9s %9s %7s %7s   axis at 0, base frame\n", "joint", "kind", "lower", "upper", "speed", "effort");
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const urdf::Joint& joint = mechanism.joints[arm.joints[i]];
    const Vec3 axis = shown(state.axis[i]);
    const std::optional<double> lower = joint.range ? std::optional(joint.range->lower) : std::nullopt,
                                upper = joint.range ? std::optional(joint.range->upper) : std::nullopt;
    print("%-24s %-10s %9s %9s %7s %7s   %6.3f %6.3f %6.3f\n", joint.name.c_str(), kind_of(joint), cell(lower, "none").c_str(),
          cell(upper, "none").c_str(), cell(joint.velocity, "?").c_str(), cell(joint.effort, "?").c_str(), axis.x(), axis.y(), axis.z());
  }
  print("angles in rad, rad/s and N m; slides in m, m/s and N; ? where the file does not say\n");
  print("tool at 0: %.4f %.4f %.4f m; approaches along %.3f %.3f %.3f, opens along %.3f %.3f %.3f\n", tool_m.x(), tool_m.y(), tool_m.z(),
        approach.x(), approach.y(), approach.z(), opening.x(), opening.y(), opening.z());
  print("inverse kinematics: %s. %s\n", chain::name(ik.family()), ik.reason());
  if (postures > 0) {
    print("%d random postures: the tool within %.3f m of the first joint, x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f m\n", postures,
          trial.farthest_m, trial.lower_m.x(), trial.upper_m.x(), trial.lower_m.y(), trial.upper_m.y(), trial.lower_m.z(),
          trial.upper_m.z());
    print("%d of them are found again from the middle of the ranges, by %s; %d in closed form\n", trial.found, text_of(trial.task),
          trial.by_closed_form);
  }
  if (!reading.notes.empty()) print("what was assumed, changed or is of no use here:\n");
  for (const urdf::Note& note : reading.notes) print("  %s\n", reading.told(note).c_str());
}

// The ends with what is assumed where the user says nothing: the tool approaches along its z, and opens square to that.
config::ArmEnds assumed_ends(config::ArmEnds given) {
  if (given.approach.empty()) given.approach = "z";
  if (given.opening.empty()) given.opening = given.approach.ends_with('x') ? "y" : "x";
  return given;
}

// Each of these, as a note at its link.
void note_assumptions(const config::ArmEnds& given, const config::ArmEnds& used, const config::ArmChain& arm, urdf::Reading& reading) {
  const int base_line = reading.mechanism.links[reading.mechanism.link(arm.base_link)].line;
  const int tool_line = reading.mechanism.links[reading.mechanism.link(arm.tool_link)].line;
  const std::string tool = "link '" + arm.tool_link + "'";
  if (given.base_link.empty())
    reading.notes.push_back({base_line, "the arm is taken to begin at the root '" + arm.base_link + "' (--base)"});
  if (given.tool_link.empty())
    reading.notes.push_back({tool_line, tool + " is taken to carry the tool: the arm ends there alone (--tool)"});
  if (given.approach.empty())
    reading.notes.push_back({tool_line, tool + " is taken to approach along its " + used.approach + " (--approach)"});
  if (given.opening.empty())
    reading.notes.push_back({tool_line, tool + " is taken to have fingers that open along its " + used.opening + " (--opening)"});
  std::stable_sort(reading.notes.begin(), reading.notes.end(), [](const urdf::Note& a, const urdf::Note& b) { return a.line < b.line; });
}

int check_arm(const Options& options) {
  urdf::ReadOptions how;
  how.package_folders.assign(options.package_folders.begin(), options.package_folders.end());
  how.ignore_missing_meshes = options.ignore_missing;
  urdf::Reading reading = urdf::read_urdf(options.file, how);
  const config::ArmEnds ends = assumed_ends(options.ends);
  const config::ArmChain arm = config::arm_chain(reading.mechanism, ends);
  note_assumptions(options.ends, ends, arm, reading);
  const chain::Ik ik(arm.chain);
  const Trial trial = try_postures(arm.chain, options.postures);
  (options.json ? answer : tell)(reading, arm, ik, trial, options.postures);
  if (trial.found == options.postures) return done;
  tell_doubts(options.file, {std::to_string(options.postures - trial.found) + " of " + std::to_string(options.postures) +
                             " random postures are not found again"});
  return failed;
}

// An option that the kind does not take.
void refuse_other_options(const CLI::App& command, const std::string& kind, const std::vector<std::string>& options) {
  for (const std::string& option : options) {
    if (command.count(option) > 0) throw InputError("check " + kind + " takes no " + option);
  }
}

int check(const CLI::App& command, const Options& options) {
  config::check_names({options.kind}, {"arm", "machine", "panel", "scene"}, "check");
  if (options.kind != "arm") {
    refuse_other_options(command, options.kind,
                         {"--base", "--tool", "--approach", "--opening", "--packages", "--ignore-missing", "--postures"});
    const auto check_one = options.kind == "scene" ? check_scene : options.kind == "machine" ? check_machine : check_panel;
    return check_one(options.file, options.picture, options.json);
  }
  refuse_other_options(command, options.kind, {"--picture"});
  return check_arm(options);
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "check",
      "Read a file strictly and tell what is in it and all that was assumed: an arm's URDF, with its "
      "joints, its inverse kinematics and where its tool comes; a machine, with its joints, drives and sight; a panel, with "
      "what of it the robot can work; or a scene");
  auto options = std::make_shared<Options>();
  command->add_option("KIND", options->kind, "What FILE describes: arm, machine, panel or scene")->required();
  command
      ->add_option("FILE", options->file, "An arm's URDF file, a machine's or a scene's YAML file, or a panel's or a shipped panel's name")
      ->required();
  command->add_option("--base", options->ends.base_link, "The link that the arm begins at; the root where it is not given")
      ->check(check_filled);
  command->add_option("--tool", options->ends.tool_link, "The link that carries the tool; needed where the arm ends at several")
      ->check(check_filled);
  command
      ->add_option("--approach", options->ends.approach,
                   "The tool link's axis along which it approaches: x, -x, y, -y, z or -z; z where it is not given")
      ->check(check_filled);
  command
      ->add_option("--opening", options->ends.opening,
                   "The tool link's axis along which its fingers open; x where it is not given, y where x approaches")
      ->check(check_filled);
  command
      ->add_option("--packages", options->package_folders,
                   "A folder that holds the folders of packages, for package:// meshes; can be given again")
      ->allow_extra_args(false)
      ->check(check_folder);
  command->add_flag("--ignore-missing", options->ignore_missing, "Leave out collision shapes whose mesh is missing, and say so");
  command->add_option("--postures", options->postures, "Random postures to try; 200 where it is not given")->check(within(0, 100000));
  command->add_option("--picture", options->picture, "machine, panel, scene: draw it, a .png file")->check(check_png);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, command, &action] { action = [options, command] { return check(*command, *options); }; });
}

}  // namespace lf::app
