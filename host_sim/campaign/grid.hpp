// A grid of scenarios: `--set key=a,b,c` is three values of a key, and several such keys are flown in all their combinations.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lf::campaign {

// What one cell of the grid sets of the grid's keys, in their order: {"valve.friction_nm", "2"}. Empty for a campaign without a grid.
using Choice = std::vector<std::pair<std::string, std::string>>;

// "valve.friction_nm=2, water.ambient=0"; "" for a campaign without a grid.
std::string label_of(const Choice& choice);

// A folder's name that says what the cell is: its label with other letters than those of numbers and keys as '_', cut to 60, and `hash`, which tells apart
// what looks alike then.
std::string folder_of(const Choice& choice, const std::string& hash);

struct Grid {
  std::vector<std::string> fixed;  // those of --set that have one value, as they were given
  std::vector<std::string> keys;   // those that have several
  std::vector<Choice> cells;       // all combinations, the last key's values changing fastest; one empty choice without a grid

  // What a cell sets, as `run --set` takes it. Of one key the last counts, so the order is that in which they were given.
  std::vector<std::string> set_of(const Choice& choice) const;
};

// Commas within [], {} and quotes belong to a value. Throws InputError for a value that is empty or given twice, for a key that has several values and is
// set again, and for more than a thousand cells.
Grid grid_of(const std::vector<std::string>& set);

}  // namespace lf::campaign
