#include "tests/bench/scan/scan_bench.hpp"

namespace lf::bench {

std::vector<Row> run_scan_bench() {
  std::vector<Row> rows = run_peaks_bench();
  for (Row& row : run_plane_bench()) rows.push_back(row);
  return rows;
}

}  // namespace lf::bench
