#include <memory>

#include "hal/config/fault_kinds.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/panel_file.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "host_sim/scenario/scene_file.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string name;
  std::vector<std::string> set;
  bool json = false;
  bool schema = false;
  bool keys = false;
  bool faults = false;
  bool scene_schema = false;
  bool scene_keys = false;
  bool machine_schema = false;
  bool panel_schema = false;
  bool panel_keys = false;
};

int list(bool json) {
  Json all = Json::array();
  for (const scenario::ShippedScenario& shipped : scenario::shipped_scenarios()) {
    if (json) {
      all.push_back({{"name", shipped.name}, {"description", shipped.description}, {"file", shipped.file}});
    } else {
      print("%-14s %s\n", shipped.name.c_str(), shipped.description.c_str());
    }
  }
  if (json) print_json(all);
  return done;
}

int scenarios(const Options& options) {
  if (options.schema) {
    print("%s", scenario::json_schema().c_str());
  } else if (options.keys) {
    print("%s", scenario::keys_markdown().c_str());
  } else if (options.scene_schema) {
    print("%s", scenario::scene_schema().c_str());
  } else if (options.scene_keys) {
    print("%s", scenario::scene_keys_markdown().c_str());
  } else if (options.machine_schema) {
    print("%s", config::machine_schema().c_str());
  } else if (options.panel_schema) {
    print("%s", config::panel_schema().c_str());
  } else if (options.panel_keys) {
    print("%s", config::panel_keys_markdown().c_str());
  } else if (options.faults) {
    print("%s", config::fault_kinds_markdown().c_str());
  } else if (options.name.empty()) {
    return list(options.json);
  } else {
    const scenario::Scenario shown = scenario::load_scenario(options.name, options.set);
    scenario::check_runnable(shown);
    if (options.json) {
      print_json(
          {{"name", shown.name}, {"description", shown.description}, {"file", shown.file}, {"yaml", scenario::scenario_yaml(shown)}});
    } else {
      print("%s", scenario::scenario_yaml(shown).c_str());
    }
  }
  return done;
}

}  // namespace

void add_scenarios(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("scenarios", "List the shipped scenarios, or print one with every key spelled out");
  auto options = std::make_shared<Options>();
  command->add_option("SCENARIO", options->name, "A file or a shipped name: checked, and printed with every key");
  command->add_option("--set", options->set, "path.to.key=value, as for run")->allow_extra_args(false);
  command->add_flag("--schema", options->schema, "Print the JSON Schema of scenario files");
  command->add_flag("--keys", options->keys, "Print the table of all keys (Markdown)");
  command->add_flag("--faults", options->faults, "Print the table of all kinds of faults (Markdown)");
  command->add_flag("--scene-schema", options->scene_schema, "Print the JSON Schema of a scene's file");
  command->add_flag("--scene-keys", options->scene_keys, "Print the table of the keys of a scene's object (Markdown)");
  command->add_flag("--machine-schema", options->machine_schema, "Print the JSON Schema of a machine's file");
  command->add_flag("--panel-schema", options->panel_schema, "Print the JSON Schema of a panel's file");
  command->add_flag("--panel-keys", options->panel_keys, "Print the table of the keys of a panel's file (Markdown)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return scenarios(*options); }; });
}

}  // namespace lf::app
