// Tables of Markdown whose rows are measured by two threads. The order of rows, and each row's figures, do not depend on the threads.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/scan/peak_table/peak_methods.hpp"
#include "tests/unit/scan/peak_table/peak_score.hpp"

namespace lf::test {

using Scores = std::array<PeakScore, method_names.size()>;

// What is asked of the first method. A limit that is not set is not asked.
struct Asked {
  std::optional<double> rms_px, percentile_999_px;
  double recall = 0.97, false_share = 0.002;
};

struct TableRow {
  std::string scene;
  std::optional<double> bound_px;
  Scores scores;
  std::optional<Asked> asked;
};

// Why the first method misses what is asked of it; empty where it does not.
std::string miss_of(const TableRow& row);

struct Table {
  std::string title;
  std::vector<std::function<std::vector<TableRow>()>> parts;  // each measures some rows
};

// Prints the table. Returns the rows that miss what is asked, as lines of Markdown.
std::vector<std::string> print(const Table& table);

}  // namespace lf::test
