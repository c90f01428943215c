// Every key that a range campaign draws, at both ends of its documented range, also where the default scenario's other keys do not let it be drawn so far. What is
// refused is refused by name.
#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/app/range_draws.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "host_sim/judge/range_rules.hpp"
#include "host_sim/optics/config_check.hpp"
#include "host_sim/scenario/draw.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/world/config_check.hpp"
#include "shared/input_error.hpp"

namespace lf::app {
namespace {

using config::Key;

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

std::string list_of(std::size_t count, const std::string& value) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + value;
  return "[" + text + "]";
}

// A value of a key all of whose numbers are this one.
struct Filled {
  const Key& key;
  std::string number;

  template <class Number>
  std::string operator()(Number*) const {
    return number;
  }
  std::string operator()(std::array<double, 3>*) const { return list_of(3, number); }
  std::string operator()(Vec2*) const { return list_of(2, number); }
  std::string operator()(std::array<Vec2, 3>*) const { return list_of(3, list_of(2, number)); }
  std::string operator()(std::vector<double>*) const { return list_of(5, number); }
  std::string operator()(std::vector<std::array<double, 6>>*) const { return list_of(1, list_of(6, number)); }
  std::string operator()(std::vector<std::array<double, 7>>*) const { return list_of(1, list_of(7, number)); }
  std::string operator()(std::vector<config::Task>*) const { return "[{turn_valve: {to_deg: " + number + "}}]"; }
};

bool has_numbers(const Key& key) { return key.max > key.min; }

std::vector<std::string> values_of(const Key& key) {
  std::vector<std::string> values;
  if (key.path == "tasks") return {"[{turn_valve: {to_deg: -180}}]", "[{turn_valve: {to_deg: 180}}]"};
  if (has_numbers(key)) {
    for (const double end : {key.min, key.max}) values.push_back(std::visit(Filled{key, text_of(end)}, key.value));
  }
  const bool list = std::holds_alternative<std::vector<std::string>*>(key.value);
  for (const std::string& word : key.words) values.push_back(list ? "[" + word + "]" : word);
  // What has several numbers is refused for other reasons where they differ.
  for (std::uint64_t draw = 1; draw <= 3; ++draw) values.push_back(drawn_value(key.path, draw));
  return values;
}

// Throws InputError for what would end the run only when it has begun: a world, optics or devices that the simulator does not take.
void make_world(const scenario::Scenario& scenario) {
  const scenario::Nominal nominal = scenario::make_nominal(scenario, true);
  for (const std::uint64_t seed : {1, 2}) {
    const hal::SimConfig truth = scenario::make_truth(scenario, scenario::draw(scenario, seed), nominal, 1);
    world::check(truth.world);
    optics::check(truth.optics);
    devices::check(truth.devices);
  }
}

TEST(RangeRefusals, EachKeyAtTheEndsOfItsRangeIsTakenOrRefusedByName) {
  scenario::Scenario table;
  const std::vector<std::string> drawn = drawn_keys();
  std::size_t refused = 0, tried = 0;
  for (const Key& key : scenario::keys(table)) {
    if (std::find(drawn.begin(), drawn.end(), key.path) == drawn.end()) continue;
    for (const std::string& value : values_of(key)) {
      ++tried;
      try {
        const scenario::Scenario scenario = scenario::load_scenario("default", {key.path + "=" + value});
        scenario::check_runnable(scenario);
        EXPECT_NO_THROW(make_world(scenario)) << key.path << "=" << value;
      } catch (const InputError& refusal) {
        ++refused;
        std::string text = refusal.what();
        EXPECT_TRUE(judge::refusal_names_a_key({key.path}, text)) << key.path << "=" << value << "\n" << text;
      }
    }
  }
  EXPECT_GT(tried, 600u);
  EXPECT_GT(refused, 100u);
}

// Of eight keys at once most combinations are refused: by one of these keys.
TEST(RangeRefusals, EightKeysAtOnceAreRefusedByNameOfOne) {
  std::size_t refused = 0;
  for (std::uint64_t index = 1; index <= 250; ++index) {
    const RangeRow row = many_row(index, 1);
    std::vector<std::string> keys;
    for (const std::string& set : row.set) keys.push_back(set.substr(0, set.find('=')));
    try {
      const scenario::Scenario scenario = scenario::load_scenario("default", row.set);
      scenario::check_runnable(scenario);
      EXPECT_NO_THROW(make_world(scenario)) << testing::PrintToString(row.set);
    } catch (const InputError& refusal) {
      ++refused;
      EXPECT_TRUE(judge::refusal_names_a_key(keys, refusal.what())) << testing::PrintToString(row.set) << "\n" << refusal.what();
    }
  }
  EXPECT_GT(refused, 60u);
}

}  // namespace
}  // namespace lf::app
