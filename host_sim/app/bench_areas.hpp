// The benchmarks that this build holds: one area for each folder of tests/bench. Its source is made by CMake.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::app {

struct BenchArea {
  const char* name;
  std::vector<bench::Row> (*run)();
};

const std::vector<BenchArea>& bench_areas();

}  // namespace lf::app
