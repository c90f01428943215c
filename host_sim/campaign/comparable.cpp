#include <algorithm>
#include <map>
#include <set>

#include "host_sim/campaign/comparison.hpp"
#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

using Keys = std::map<std::string, std::string>;

Keys scenario_of(const record::Experiment& experiment) {
  const auto found = experiment.find("scenario");
  return found == experiment.end() ? Keys{} : record::scenario_keys(found->second);
}

std::string list_of(const std::vector<std::string>& texts, const std::string& between) {
  constexpr std::size_t most = 6;
  std::string list;
  for (std::size_t i = 0; i < std::min(texts.size(), most); ++i) list += (i == 0 ? "" : between) + texts[i];
  return texts.size() > most ? list + between + "and " + std::to_string(texts.size() - most) + " more" : list;
}

struct Difference {
  std::vector<std::string> values;    // "valve.friction_nm was 2, is 3"
  std::vector<std::string> keys;      // of these
  std::vector<std::string> new_keys;  // that one of the two does not have: programs of different versions
  std::vector<std::string> crossed;   // values that may differ
};

Difference difference_of(const Keys& before, const Keys& now, const std::vector<std::string>& across) {
  Difference difference;
  std::set<std::string> names;
  for (const auto& [name, value] : before) names.insert(name);
  for (const auto& [name, value] : now) names.insert(name);
  for (const std::string& name : names) {
    const auto was = before.find(name), is = now.find(name);
    if (was == before.end() || is == now.end()) {
      difference.new_keys.push_back(name);
    } else if (was->second != is->second) {
      const std::string clause = name + " was " + was->second + ", is " + is->second;
      const bool may = std::find(across.begin(), across.end(), name) != across.end();
      (may ? difference.crossed : difference.values).push_back(clause);
      if (!may) difference.keys.push_back(name);
    }
  }
  return difference;
}

void add_once(std::vector<std::string>& notes, const std::string& note) {
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
}

void compare_files(const record::Experiment& before, const record::Experiment& now, std::vector<std::string>& notes) {
  for (const auto& [name, hash] : now) {
    const auto was = before.find(name);
    if (name == "program" && was != before.end() && was->second != hash) add_once(notes, "the program is another");
    if (name.starts_with("file ") && was != before.end() && was->second != hash) add_once(notes, name.substr(5) + " is another");
    if (name.starts_with("file ") && was == before.end()) add_once(notes, name.substr(5) + " is used now");
  }
  for (const auto& [name, hash] : before) {
    if (name.starts_with("file ") && !now.contains(name)) add_once(notes, name.substr(5) + " was used before");
  }
}

std::string labels_of(const Campaign& campaign) {
  std::vector<std::string> labels;
  labels.reserve(campaign.cells.size());
  for (const Cell& cell : campaign.cells) labels.push_back(cell.choice.empty() ? "no grid" : label_of(cell.choice));
  return list_of(labels, "; ");
}

}  // namespace

std::vector<std::string> check_comparable(const Campaign& earlier, const Campaign& later, const std::vector<std::string>& across) {
  std::vector<std::string> notes;
  std::size_t common = 0;
  std::set<std::string> known;
  for (const Cell& now : later.cells) {
    const auto same = [&](const Cell& cell) { return label_of(cell.choice) == label_of(now.choice); };
    const auto before = std::find_if(earlier.cells.begin(), earlier.cells.end(), same);
    for (const auto& [name, value] : scenario_of(now.experiment)) known.insert(name);
    if (before == earlier.cells.end()) {
      notes.push_back("not in the earlier campaign: " + label_of(now.choice));
      continue;
    }
    ++common;
    const Keys was = scenario_of(before->experiment), is = scenario_of(now.experiment);
    for (const auto& [name, value] : was) known.insert(name);
    const Difference difference = difference_of(was, is, across);
    const std::string in = now.choice.empty() ? "" : " with " + label_of(now.choice);
    if (!difference.values.empty()) {
      throw InputError("the campaigns are not comparable: the scenario is another one" + in + ": " + list_of(difference.values, "; ") +
                       ". If that is what is compared, add --across " + list_of(difference.keys, ","));
    }
    for (const std::string& crossed : difference.crossed) add_once(notes, crossed);
    if (!difference.new_keys.empty()) add_once(notes, "only one of the two programs has the keys " + list_of(difference.new_keys, ", "));
    compare_files(before->experiment, now.experiment, notes);
  }
  if (common == 0)
    throw InputError("the campaigns are not comparable: they have no cell in common: " + labels_of(earlier) + " before; " +
                     labels_of(later) + " now");
  for (const std::string& key : across) {
    if (!known.contains(key)) throw InputError("--across: the scenarios have no key '" + key + "'");
  }
  for (const Cell& before : earlier.cells) {
    const auto same = [&](const Cell& cell) { return label_of(cell.choice) == label_of(before.choice); };
    if (std::none_of(later.cells.begin(), later.cells.end(), same))
      notes.push_back("only in the earlier campaign: " + label_of(before.choice));
  }
  if (earlier.scenario != later.scenario) notes.push_back("the scenario was named " + earlier.scenario + ", is " + later.scenario);
  return notes;
}

}  // namespace lf::campaign
