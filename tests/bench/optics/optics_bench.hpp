// Frame times of the simulated camera: the reference layout at 640x480.
#pragma once

#include <vector>

#include "tests/bench/row.hpp"

namespace lf::bench {

// The peer is the aim that the design sets on two cores: 20 ms with edge samples. No other ray-traced underwater camera runs here.
std::vector<Row> run_optics_bench();

}  // namespace lf::bench
