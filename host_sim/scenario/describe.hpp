// What a scenario may say, told in three ways from the one table of keys: for an editor, for a reader, and filled in.
#pragma once

#include <string>

#include "host_sim/scenario/scenario.hpp"

namespace lf::scenario {

// JSON Schema (2020-12) of a scenario file; shared/scenarios/scenario.schema.json is its output.
std::string json_schema();

// A Markdown table of every key: name, what it takes, default, range, meaning; docs/scenarios.md holds it.
std::string keys_markdown();

// The scenario with every key spelled out and explained, as YAML that load_scenario reads back to the same.
std::string scenario_yaml(const Scenario& scenario);

}  // namespace lf::scenario
