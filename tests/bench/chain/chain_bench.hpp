// Inverse kinematics of any arm against KDL's solvers: the reference's protocol, 10,000 random reachable poses on each of five arms. And as many for each of
// the tasks that ask for less than a pose, and 100,000 poses of 2000 arms made at random.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::bench {

std::vector<Row> run_chain_bench();

}  // namespace lf::bench
