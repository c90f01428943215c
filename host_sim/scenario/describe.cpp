#include "host_sim/scenario/describe.hpp"

#include "hal/config/key_listing.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/key_text.hpp"
#include "host_sim/scenario/keys.hpp"

namespace lf::scenario {

std::string json_schema() {
  Scenario scenario;
  scenario.survey.names.buttons.clear();  // a file's panel has its own
  return config::key_schema(keys(scenario), "Lanternfish scenario");
}

std::string keys_markdown() {
  Scenario scenario;
  Task task;
  Fault fault;
  std::string out = config::markdown_head;
  for (const Key& key : keys(scenario)) out += config::markdown_row(key);
  for (const Key& key : keys(task, {})) out += config::markdown_row(key, "tasks[].", false);
  for (const Key& key : keys(fault)) out += config::markdown_row(key, "faults[].", false);
  return out;
}

std::string scenario_yaml(const Scenario& of) {
  Scenario scenario = of, defaults;
  return config::key_listing(keys(scenario), keys(defaults));
}

}  // namespace lf::scenario
