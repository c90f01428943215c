// The experiment that a run or a campaign is, and the folder it goes to by default.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/record/experiment.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

// The resolved scenario, the files it uses, and this program. Throws InputError for a file that cannot be read.
record::Experiment experiment_of(const scenario::Scenario& scenario);
// The same with the seed of one run.
record::Experiment experiment_of(const scenario::Scenario& scenario, std::uint64_t seed);

// The resolved scenario of a run, in its folder: `lanternfish run FOLDER/scenario.yaml --seed N` is the same run again, whatever became of the file that
// it was made of. Files of the user's own that it names lie beside it, as they did beside the user's; those above the scenario's folder are named by their
// whole path.
inline constexpr const char* scenario_file = "scenario.yaml";
// Throws InputError for a file that cannot be read, RecordError for one that cannot be written.
void keep_scenario(const scenario::Scenario& scenario, const record::RunFolder& run);

// runs/BASE; with --set, and where another experiment stands there already, runs/BASE-HASH: what differs does not get in each other's way.
std::filesystem::path default_folder(const std::string& base, bool has_overrides, const record::Experiment& experiment);

}  // namespace lf::app
