// A campaign: a scenario, or a grid of them, flown with many seeds; what each run came to, and where all that comes from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/grid.hpp"
#include "host_sim/record/experiment.hpp"
#include "host_sim/record/result.hpp"

namespace lf::campaign {

// One run.
struct RunSummary {
  std::uint64_t seed = 0;
  bool success = false;
  bool false_success = false;        // the mission believes it succeeded, and the truth disagrees
  bool calibration_doubted = false;  // by what looks and presses left over
  std::optional<record::FailureRecord> failure;
  std::string as_expected;      // the failure that the scenario asked for, and got
  std::vector<double> figures;  // as figures(); NaN where there is none
  double wall_s = record::unknown;
  std::string digest;
  std::string folder;       // below the campaign's; empty: the run left none
  bool has_report = false;  // folder/report.html is there
};

struct Cell {
  Choice choice;
  std::string folder;  // below the campaign's; empty without a grid
  record::Experiment experiment;
  std::vector<RunSummary> runs;          // by seed
  std::vector<std::uint64_t> not_flown;  // an interrupt came before
};

// From when to when the program flew runs of it: several where it was interrupted and went on. UTC, "2026-11-24T21:35:00Z".
struct Sitting {
  std::string begun, ended;
  std::size_t flown = 0;
};

struct Campaign {
  std::string scenario;  // its name
  std::string seeds;     // as asked for
  std::vector<std::string> set;
  std::vector<std::string> keys;  // the grid's
  std::string command, version, revision;
  std::vector<Sitting> sittings;
  std::vector<Cell> cells;  // at least one
};

// A run as the table has it; `folder` below the campaign's.
RunSummary run_of(const record::RunResult& result, const std::string& folder, bool has_report);

// "ok", "ok, it failed as expected: ...", "FALSE SUCCESS in turn: ...", "failed in boot: ...".
std::string verdict_of(const RunSummary& run);

}  // namespace lf::campaign
