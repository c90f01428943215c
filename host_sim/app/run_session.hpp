// One mission in simulated time, from power-on to its end, with everything that is kept of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/record/experiment.hpp"
#include "host_sim/record/report.hpp"
#include "host_sim/record/result.hpp"
#include "host_sim/scenario/scenario.hpp"

namespace lf::app {

struct RunRequest {
  scenario::Scenario scenario;
  std::uint64_t seed = 1;
  int render_threads = 1;
  bool realtime = false;
  bool given_sight = false;                     // nothing is rendered: for runs that are not about seeing
  bool record_images = false;                   // the camera's pictures as they are, in raw/
  bool outside = true;                          // pictures of the robot from outside
  std::filesystem::path out;                    // the run folder; empty keeps nothing
  record::Experiment experiment;                // what the folder is held against
  record::ProvenanceRecord provenance;          // command, date, --set; the rest is filled in
  std::function<void(const std::string&)> say;  // progress, one line a phase; may be empty
};

struct RunOutcome {
  record::RunResult result;
  bool interrupted = false;
  std::string write_error;  // what could not be recorded, if anything: the run has failed then, whatever the mission did
  bool kept = false;        // the run folder is in its place
  bool has_report = false;
};

// Goes on until the arm stands and has no power, 3 s after the mission's end at most. Throws InputError for a scenario that cannot be run and for an
// output folder that cannot be made or holds another experiment. An interrupt ends it early with what it has, which is kept where no finished run stands.
// A full disk ends the recording, not the run; but a run that could not be recorded has failed.
RunOutcome run_mission(const RunRequest& request);

}  // namespace lf::app
