// Reads YAML into what a table of keys is bound to, and refuses everything the table does not have.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "hal/config/key.hpp"

namespace lf::config {

// Where a value came from, for the messages: a file, whose lines count, or one "--set key=value", which has none.
class Source {
 public:
  static Source of_file(std::string path) { return Source(std::move(path), true); }
  // A file whose problems are all wanted: read_map() goes on after each and adds it to `problems`, which outlives the source.
  static Source of_file(std::string path, std::vector<std::string>& problems) {
    Source source(std::move(path), true);
    source.problems_ = &problems;
    return source;
  }
  static Source of_override(const std::string& text) { return Source("--set " + text, false); }

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& message) const;
  const std::string& name() const { return name_; }
  std::vector<std::string>* problems() const { return problems_; }

 private:
  Source(std::string name, bool has_lines) : name_(std::move(name)), has_lines_(has_lines) {}
  std::string name_;
  bool has_lines_;
  std::vector<std::string>* problems_ = nullptr;
};

// Throws InputError with the line for text that is not YAML.
YAML::Node parse_yaml(const std::string& text, const Source& source);

// Reads the map `node` into `table`. `prefix`: path of the node within the table, "" or "valve."; `shown`: what stands before a path in messages.
void read_map(const YAML::Node& node, const std::string& prefix, const std::string& shown, const std::vector<Key>& table,
              const Source& source);

// Reads one value.
void read_value(const YAML::Node& node, const std::string& shown_path, const Key& key, const Source& source);

// ", did you mean" for a path that the table has not: among the names at its level first, then among all paths that end like it. The whole path, after `shown`.
std::string suggest_path(const std::string& path, const std::vector<Key>& table, const std::string& shown = "");

}  // namespace lf::config
