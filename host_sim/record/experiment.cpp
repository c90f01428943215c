#include "host_sim/record/experiment.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

#include "host_sim/record/digest.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::record {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_clauses = 6;  // of a message

std::string changed(const std::string& name, const std::map<std::string, std::string>& before,
                    const std::map<std::string, std::string>& now) {
  const auto was = before.find(name), is = now.find(name);
  return name + " was " + (was == before.end() ? "not given" : was->second) + ", is " + (is == now.end() ? "not given" : is->second);
}

void add_scenario(const std::string& before, const std::string& now, std::vector<std::string>& clauses) {
  const std::map<std::string, std::string> was = scenario_keys(before), is = scenario_keys(now);
  std::set<std::string> names;
  for (const auto& [name, value] : was) names.insert(name);
  for (const auto& [name, value] : is) names.insert(name);
  for (const std::string& name : names) {
    const auto a = was.find(name), b = is.find(name);
    if (a == was.end() || b == is.end() || a->second != b->second) clauses.push_back(changed(name, was, is));
  }
}

}  // namespace

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::is_directory(path)) throw unreadable(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A line is "  key: value  # what it means", and a group is "group:" with its keys indented.
std::map<std::string, std::string> scenario_keys(const std::string& yaml) {
  std::map<std::string, std::string> keys;
  std::istringstream lines(yaml);
  std::string group;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line[start] == '#') continue;
    const std::size_t colon = line.find(':', start);
    if (colon == std::string::npos) continue;
    std::string value = line.substr(colon + 1, line.find(" # ", colon) - colon - 1);
    value.erase(0, std::min(value.find_first_not_of(' '), value.size()));
    value.erase(value.find_last_not_of(' ') + 1);
    const std::string name = line.substr(start, colon - start);
    if (start == 0) group = value.empty() ? name + "." : "";
    if (!value.empty()) keys[(start == 0 ? "" : group) + name] = value;
  }
  return keys;
}

std::string hash_of(const Experiment& experiment) { return sha256_hex(experiment_json(experiment)); }

std::string file_hash(const fs::path& path) { return sha256_hex(bytes_of(path)); }

std::string difference(const Experiment& theirs, const Experiment& ours) {
  std::vector<std::string> clauses;
  std::set<std::string> names;
  for (const auto& [name, value] : theirs) names.insert(name);
  for (const auto& [name, value] : ours) names.insert(name);
  for (const std::string& name : names) {
    const auto was = theirs.find(name), is = ours.find(name);
    if (was != theirs.end() && is != ours.end() && was->second == is->second) continue;
    const bool is_hash = name == "program" || name.starts_with("file ");
    if (name == "scenario" && was != theirs.end() && is != ours.end()) {
      add_scenario(was->second, is->second, clauses);
    } else if (is_hash && was != theirs.end() && is != ours.end()) {
      clauses.push_back(name + " is another");
    } else {
      clauses.push_back(changed(name, theirs, ours));
    }
  }
  std::string text;
  for (std::size_t i = 0; i < clauses.size() && i < most_clauses; ++i) text += (i == 0 ? "" : "; ") + clauses[i];
  if (clauses.size() > most_clauses) text += "; and " + std::to_string(clauses.size() - most_clauses) + " more";
  return text;
}

std::string experiment_json(const Experiment& experiment) {
  Json json = Json::object();
  for (const auto& [name, value] : experiment) json[name] = value;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<Experiment> read_experiment(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder / experiment_file, ignored)) return std::nullopt;
  const Json json = Json::parse(bytes_of(folder / experiment_file), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  Experiment experiment;
  for (const auto& [name, value] : json.items()) {
    if (value.is_string()) experiment[name] = value.get<std::string>();
  }
  return experiment;
}

void refuse_other(const fs::path& folder, const Experiment& ours) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return;
  if (!fs::is_directory(folder, ignored)) throw InputError(folder.string(), 0, "is a file, not a folder");
  if (fs::is_empty(folder, ignored)) return;
  const std::optional<Experiment> theirs = read_experiment(folder);
  if (!theirs) throw InputError(folder.string(), 0, std::string("is not empty and has no ") + experiment_file + ": give another folder");
  const std::string differs = difference(*theirs, ours);
  if (!differs.empty())
    throw InputError(folder.string(), 0, "holds another experiment: " + differs + ". Give another folder, or remove this one");
}

}  // namespace lf::record
