// The scan against its peers: stripe peaks against OpenCV, planes against PCL.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::bench {

std::vector<Row> run_peaks_bench();  // 640x480 and 1920x1080: medians of interleaved runs, and the rms error of each
std::vector<Row> run_plane_bench();  // 100,000 points at 30 and 85 % outliers in sweep order: medians, and the worst angle of each
std::vector<Row> run_scan_bench();   // both

}  // namespace lf::bench
