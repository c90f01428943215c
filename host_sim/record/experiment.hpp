// What made a folder of results: the resolved scenario, every file it used, the program, and what else was chosen. A folder that another experiment made
// is not written to.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lf::record {

// What an experiment is made of, by name: "scenario" is the resolved YAML, "program" and "file PATH" are SHA-256 sums, the rest is as it was chosen.
using Experiment = std::map<std::string, std::string>;

inline constexpr const char* experiment_file = "experiment.json";

// SHA-256 over everything in it, 64 hex digits.
std::string hash_of(const Experiment& experiment);

// A file's bytes, and the hash of them. Throw InputError when it cannot be read.
std::string bytes_of(const std::filesystem::path& path);
std::string file_hash(const std::filesystem::path& path);

// How `theirs` differs from `ours`, one clause each: "valve.friction_nm was 2, is 3". Empty when they are the same.
std::string difference(const Experiment& theirs, const Experiment& ours);

// The keys of a resolved scenario's YAML with their values, by path: "valve.friction_nm" is "{min: 0.5, max: 3}".
std::map<std::string, std::string> scenario_keys(const std::string& yaml);

std::string experiment_json(const Experiment& experiment);
// The experiment that made a folder; nothing where there is none, or the file is not one.
std::optional<Experiment> read_experiment(const std::filesystem::path& folder);

// Throws InputError when the folder holds another experiment, saying what differs, or results that say nothing of theirs.
void refuse_other(const std::filesystem::path& folder, const Experiment& ours);

}  // namespace lf::record
