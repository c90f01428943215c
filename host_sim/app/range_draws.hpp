// Values of a scenario's keys, drawn over their documented ranges: what the range campaign sets.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/scenario/keys.hpp"

namespace lf::app {

struct RangeRow {
  std::string name;              // "valve.friction_nm 3", "many 17"
  std::string key;               // "many" where it is several
  std::vector<std::string> set;  // as --set takes them
  std::uint64_t seed = 1;        // of the run
  bool sees = false;             // the key is about seeing: the run renders, else sight is given
};

// Of several keys at once most combinations are refused. One that is, is drawn again, up to so many times.
inline constexpr std::uint64_t combinations = 40;

// The keys that have something to draw, by path. Not: free texts, files, the faults, and what only names, limits or expects a run.
std::vector<std::string> drawn_keys();

// Draw number `draw` (from 1) of a key as YAML. Even over the range, as far as the default scenario's other keys let it reach (scenario/bounds.hpp); where it
// spans more than a factor of a hundred above 0, even in the logarithm.
std::string drawn_value(const std::string& key, std::uint64_t draw);

// The ends of a number's range as YAML, lower end first, as far as the default scenario's other keys let them be; none for what is no single number.
std::vector<std::string> end_values(const std::string& key);

// What the name of a row ends with that sets a key to an end of its range.
inline constexpr const char *lower_end = " (lower end)", *upper_end = " (upper end)";
inline bool is_of_an_end(const std::string& row) { return row.ends_with(lower_end) || row.ends_with(upper_end); }

// Row `index` (from 1) of those with eight keys at once; `combination`: from 1.
RangeRow many_row(std::uint64_t index, std::uint64_t combination);

// `draws` rows a key, one key at a time, and where there are any one at each end of its range; then `many` rows with eight keys at once.
std::vector<RangeRow> range_rows(std::size_t draws, std::size_t many);

}  // namespace lf::app
