#include "host_sim/app/range_draws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace lf::app {
namespace {

TEST(RangeDraws, NoRowHasAKeyTwice) {
  for (std::uint64_t index = 1; index <= 100; ++index) {
    for (const std::uint64_t combination : {1, 2, 40}) {
      std::set<std::string> keys;
      for (const std::string& set : many_row(index, combination).set) keys.insert(set.substr(0, set.find('=')));
      EXPECT_EQ(keys.size(), 8u) << "many " << index;
    }
  }
}

TEST(RangeDraws, WordsAreDrawnAndFreeTextsAreNot) {
  const std::vector<std::string> keys = drawn_keys();
  const auto drawn = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  for (const char* key :
       {"drives.slew.polarity", "drives.profile", "drives.jaw.profile", "buttons.stuck", "buttons.missing", "panel.pointer"})
    EXPECT_TRUE(drawn(key)) << key;
  for (const char* key : {"description", "arm.urdf", "safety.limits", "faults", "time_limit_s", "expect.failure"})
    EXPECT_FALSE(drawn(key)) << key;
}

TEST(RangeDraws, EveryWordComesUp) {
  const auto values = [](const char* key) {
    std::set<std::string> seen;
    for (std::uint64_t draw = 1; draw <= 400; ++draw) seen.insert(drawn_value(key, draw));
    return seen;
  };
  EXPECT_EQ(values("drives.elbow.polarity"), (std::set<std::string>{"forward", "reversed"}));
  EXPECT_EQ(values("buttons.stuck").size(), 8u) << "each of three buttons is stuck or not";
  const std::set<std::string> profiles = values("drives.profile");
  for (const char* make : {"lanternfish", "cia402", "epos4", "copley", "ipos"}) EXPECT_TRUE(profiles.contains(make)) << make;
}

TEST(RangeDraws, BothEndsOfANumbersRangeAreFlown) {
  std::set<std::string> names;
  for (const RangeRow& row : range_rows(1, 0)) names.insert(row.name);
  EXPECT_TRUE(names.contains("docking.x_m -0.03 (lower end)"));
  EXPECT_TRUE(names.contains("docking.x_m 0.03 (upper end)"));
  EXPECT_TRUE(names.contains("mission.tries 1 (lower end)"));
  EXPECT_TRUE(names.contains("mission.tries 20 (upper end)"));
  EXPECT_TRUE(end_values("drives.profile").empty()) << "no number";
  for (const RangeRow& row : range_rows(0, 3)) EXPECT_FALSE(is_of_an_end(row.name)) << "without draws there are no ends";
}

TEST(RangeDraws, TheEndsAreAcceptedByTheDefaultScenario) {
  for (const RangeRow& row : range_rows(1, 0)) {
    if (!is_of_an_end(row.name) || row.key.starts_with("drives.") || row.key == "outputs.node") continue;
    if (!row.key.starts_with("panel.button_") && !row.key.starts_with("buttons.") && !row.key.starts_with("latency.")) continue;
    EXPECT_NO_THROW((void)scenario::load_scenario("default", row.set)) << row.name;
  }
}

}  // namespace
}  // namespace lf::app
