// The one table of what a scenario may say: each key's path, unit, range, words and meaning, bound to its member. The reader, the JSON Schema, the
// commented listing and the documentation all come from it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "host_sim/scenario/scenario.hpp"

namespace lf::scenario {

using KeyValue =
    std::variant<double*, std::int64_t*, std::int32_t*, std::uint32_t*, bool*, std::string*, Spread*, Chance*, std::array<double, 3>*,
                 Vec2*, std::array<Vec2, 3>*, std::vector<double>*, std::vector<std::string>*, std::vector<Task>*, std::vector<Fault>*>;

struct Key {
  std::string path;  // "valve.start_deg"
  std::string doc;   // one line
  std::string unit;  // "" where there is none
  double min = 0;    // of every number in the value, both ends of a spread included
  double max = 0;
  KeyValue value;                    // where it is kept
  std::vector<std::string> words{};  // what a text, or each text of a list, may be; empty: anything
};

// In the order of the documentation. The pointers are into the argument.
std::vector<Key> keys(Scenario& scenario);
std::vector<Key> keys(Task& task);  // paths "turn_valve.to_deg", "press_buttons.order"
std::vector<Key> keys(Fault& fault);

// "a number", "a number or {min: , max: }", "true or false" ...: what the key takes, in words.
std::string type_name(const Key& key);

}  // namespace lf::scenario
