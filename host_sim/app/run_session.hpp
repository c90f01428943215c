// One mission in simulated time, from power-on to its end, with everything that is kept of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/record/report.hpp"
#include "host_sim/record/result.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

struct RunRequest {
  scenario::Scenario scenario;
  std::uint64_t seed = 1;
  int render_threads = 1;
  bool realtime = false;
  bool outside = true;                          // pictures of the robot from outside
  std::filesystem::path out;                    // the run folder; empty keeps nothing
  std::string command;                          // that reproduces the run, for the report
  std::function<void(const std::string&)> say;  // progress, one line a phase; may be empty
};

struct RunOutcome {
  record::RunResult result;
  bool interrupted = false;
  std::string write_error;  // what could not be recorded, if anything
};

// Throws InputError for a scenario that cannot be run and for an output folder that cannot be made. An interrupt ends it early with what it has; so does a
// full disk end the recording, not the run.
RunOutcome run_mission(const RunRequest& request);

}  // namespace lf::app
