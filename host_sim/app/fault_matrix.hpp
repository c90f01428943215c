// The fault matrix: every kind of fault, at every node, in every step of the mission's table, and pairs of them; each row a run of its own.
//
// A walk is flown once. Where a fault is due the process is copied (fork), and the copy flies on with the fault: no row flies the way to its step again, and
// the copies differ from each other in nothing but their faults.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/app/fault_walk.hpp"
#include "host_sim/app/matrix_rows.hpp"
#include "host_sim/judge/verdict.hpp"

namespace lf::app {

struct RowResult {
  std::string row, kind, step, walk;
  double at_s = 0;  // of the walk, when the first fault is made
  std::vector<std::string> wrong, unclear;
  bool unfelt = false;        // it ended in success, and was touched: its drives had nothing to feel that by
  bool stood_anyway = false;  // a joint that seized where it was to stay was told as a contact
  bool gripped = false;       // the jaw held the handle when there was no power any more
  bool gave_way = false;      // of such a row: the handle slipped in the pads, and a joint moved in its gear later than it may
  bool false_success = false, must_go_on = false, went_on = false;
  std::string end, reason;
  std::vector<std::string> reported;  // the core's faults that it reported since the first was made, by safety::name()
  std::optional<double> stop_ms, standing_s, power_off_s, stop_to_off_s;
  double force_n = 0;

  bool safe() const { return wrong.empty() && !false_success; }
};

// The bus of a scenario's machine.
judge::BusNodes bus_of(const scenario::Scenario& scenario);

std::string row_json(const RowResult& row);                           // one line
std::optional<RowResult> parse_row(const std::string& line);          // nothing for half a line
std::vector<RowResult> read_rows(const std::filesystem::path& file);  // those that are whole; none without the file

// Flies the rows, `jobs` at a time, and appends each to `file` as it ends; `told` is called for each. An interrupt ends it early.
// A row that is rendered is flown whole: a copy of a process has none of its threads, and pictures are drawn by one.
void fly_matrix(const scenario::Scenario& base, const std::vector<MatrixRow>& rows, Sight sight, int jobs,
                const std::filesystem::path& file, const std::function<void(const RowResult&)>& told);

}  // namespace lf::app
