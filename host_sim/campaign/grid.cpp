#include "host_sim/campaign/grid.hpp"

#include <algorithm>
#include <cctype>

#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

constexpr std::size_t most_cells = 1000;

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(' ');
  return from == std::string::npos ? "" : text.substr(from, text.find_last_not_of(' ') - from + 1);
}

// At the commas that stand outside of YAML's brackets and quotes. A quote in the middle of a word is an apostrophe.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0, before = ',';
  for (const char c : text) {
    const bool at_start = before == ',' || before == '[' || before == '{' || before == ':';
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if ((c == '"' || c == '\'') && at_start) {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      before = c;
      continue;
    }
    parts.back() += c;
    if (c != ' ') before = c;
  }
  // What is never closed is the scenario's reader to refuse, whole.
  if (quote != 0 || depth != 0) return {text};
  return parts;
}

std::vector<std::string> values_of(const std::string& set, std::size_t equals) {
  std::vector<std::string> values = split(set.substr(equals + 1));
  if (values.size() == 1) return values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = trimmed(values[i]);
    if (values[i].empty()) throw InputError("--set " + set + ": value " + std::to_string(i + 1) + " of the list is empty");
    if (std::find(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i), values[i]) !=
        values.begin() + static_cast<std::ptrdiff_t>(i))
      throw InputError("--set " + set + ": " + values[i] + " is given twice");
  }
  return values;
}

std::string key_of(const std::string& set) { return trimmed(set.substr(0, set.find('='))); }

}  // namespace

std::string label_of(const Choice& choice) {
  std::string label;
  for (const auto& [key, value] : choice) label += (label.empty() ? "" : ", ") + key + "=" + value;
  return label;
}

std::string folder_of(const Choice& choice, const std::string& hash) {
  constexpr std::size_t most = 60, digits = 8;
  std::string name = label_of(choice);
  std::erase(name, ' ');
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && std::string("._-=,+").find(c) == std::string::npos) c = '_';
  }
  return name.substr(0, most) + "-" + hash.substr(0, digits);
}

std::vector<std::string> Grid::set_of(const Choice& choice) const {
  std::vector<std::string> set = fixed;
  for (const auto& [key, value] : choice) set.push_back(std::string(key).append("=").append(value));
  return set;
}

Grid grid_of(const std::vector<std::string>& set) {
  Grid grid;
  grid.cells.emplace_back();
  for (const std::string& each : set) {
    const std::size_t equals = each.find('=');
    const std::vector<std::string> values = equals == std::string::npos ? std::vector<std::string>{each} : values_of(each, equals);
    if (values.size() == 1) {
      grid.fixed.push_back(each);
      continue;
    }
    const std::string key = key_of(each);
    grid.keys.push_back(key);
    if (grid.cells.size() * values.size() > most_cells) throw InputError("--set " + each + ": more than a thousand combinations");
    std::vector<Choice> cells;
    for (const Choice& cell : grid.cells) {
      for (const std::string& value : values) {
        cells.push_back(cell);
        cells.back().emplace_back(key, value);
      }
    }
    grid.cells = std::move(cells);
  }
  for (const std::string& key : grid.keys) {
    const auto sets = [&](const std::string& each) { return key_of(each) == key; };
    if (std::count_if(set.begin(), set.end(), sets) > 1) throw InputError("--set " + key + ": it has several values, and is set twice");
  }
  return grid;
}

}  // namespace lf::campaign
