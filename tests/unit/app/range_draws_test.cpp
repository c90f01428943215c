#include "host_sim/app/range_draws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "host_sim/scenario/instance.hpp"

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

// A panel at the end of its range may be out of reach or view, and is refused by name.
TEST(RangeDraws, TheEndsAreAcceptedByTheDefaultScenario) {
  constexpr std::array<const char*, 4> groups{"panel.button_", "buttons.", "latency.", "jaw."};
  for (const RangeRow& row : range_rows(1, 0)) {
    if (!is_of_an_end(row.name) || row.key.starts_with("drives.") || row.key == "outputs.node") continue;
    const bool whole = std::any_of(groups.begin(), groups.end(), [&](const char* group) { return row.key.starts_with(group); });
    if (!whole) continue;
    EXPECT_NO_THROW(scenario::check_runnable(scenario::load_scenario("default", row.set))) << row.name;
  }
}

}  // namespace
}  // namespace lf::app
