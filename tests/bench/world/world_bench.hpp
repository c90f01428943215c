// Physics alone at 1 kHz on one core, as a multiple of real time; the peer column is the aim.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::bench {

// Rows `world_free` (the arm sweeping, nothing near) and `world_turning` (the gripped handle turning at 1.5 N m of friction): ours and the aim in simulated
// seconds a second of thread CPU time, ratio ours / aim.
std::vector<Row> run_world_bench();

}  // namespace lf::bench
