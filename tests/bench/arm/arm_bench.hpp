// The arm's closed forms against KDL's solvers, on the same seeded targets and interleaved.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::bench {

std::vector<Row> run_arm_bench();

}  // namespace lf::bench
