#include "host_sim/scenario/describe.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "hal/config/fault_kinds.hpp"
#include "hal/config/share.hpp"
#include "host_sim/scenario/keys.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace lf::scenario {

namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(std::string(LANTERNFISH_SOURCE_DIR) + "/" + path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST(Keys, EveryPathIsUniqueExplainedAndHoldsItsDefaultWithinItsRange) {
  Scenario scenario;
  std::set<std::string> paths;
  for (const Key& key : keys(scenario)) {
    EXPECT_TRUE(paths.insert(key.path).second) << key.path;
    EXPECT_GT(key.doc.size(), 5u) << key.path;
    EXPECT_LE(key.min, key.max) << key.path;
    if (const auto* number = std::get_if<double*>(&key.value)) {
      EXPECT_GE(**number, key.min) << key.path;
      EXPECT_LE(**number, key.max) << key.path;
    }
    if (const auto* spread = std::get_if<Spread*>(&key.value)) {
      EXPECT_GE((*spread)->min, key.min) << key.path;
      EXPECT_LE((*spread)->max, key.max) << key.path;
    }
  }
  for (const Key& key : keys(scenario)) {
    for (const std::string& other : paths) EXPECT_FALSE(other.starts_with(key.path + ".")) << key.path << " is a key and a section";
  }
}

// Regenerate with: lanternfish scenarios --schema > shared/scenarios/scenario.schema.json
TEST(Schema, TheShippedOneIsThatOfTheTable) { EXPECT_EQ(text_of("shared/scenarios/scenario.schema.json"), json_schema()); }

// Regenerate the table of docs/scenarios.md with: lanternfish scenarios --keys
TEST(Schema, TheUsersPageHoldsTheTable) { EXPECT_NE(text_of("docs/scenarios.md").find(keys_markdown()), std::string::npos); }

// The table of faults: lanternfish scenarios --faults
TEST(Schema, TheUsersPageHoldsTheTableOfFaults) {
  EXPECT_NE(text_of("docs/scenarios.md").find(config::fault_kinds_markdown()), std::string::npos);
}

TEST(Schema, NumbersAreAsShortAsAPersonWouldWriteThem) {
  const std::string table = keys_markdown();
  EXPECT_EQ(table.find("0000000"), std::string::npos) << table.substr(table.find("0000000") - 60, 100);
  EXPECT_EQ(table.find("9999999"), std::string::npos);
}

TEST(Schema, HasAPlaceForEveryKeyAndRefusesOthers) {
  const nlohmann::json schema = nlohmann::json::parse(json_schema());
  EXPECT_EQ(schema["additionalProperties"], false);
  Scenario scenario;
  for (const Key& key : keys(scenario)) {
    std::string pointer = "/properties/" + key.path;
    for (std::size_t dot = pointer.find('.'); dot != std::string::npos; dot = pointer.find('.')) pointer.replace(dot, 1, "/properties/");
    EXPECT_TRUE(schema.contains(nlohmann::json::json_pointer(pointer))) << key.path;
  }
}

TEST(Listing, ReadsBackToTheSameScenario) {
  for (const ShippedScenario& shipped : shipped_scenarios()) {
    const Scenario scenario = load_scenario(shipped.name);
    const std::string listing = scenario_yaml(scenario);
    const ScenarioFile file(listing);
    EXPECT_EQ(scenario_yaml(load_scenario(file.path())), listing) << shipped.name;
  }
}

}  // namespace lf::scenario
