// The tables of pictures that the tests' renderer forms.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/unit/scan/peak_table/table.hpp"

namespace lf::test {

// Plain paint: stripes of 0.8 to 5 px, with and without speckle, each with an off picture and without one. 640x480, and 320 columns of 1920x1080; 8 and 12 bits. The first
// format also with an off picture of 1/1.6 of the exposure.
std::vector<Table> plain_tables(std::uint64_t seed);

// The same of stripes that are clipped, and of faint ones: 6 sigmas of the difference's noise.
Table hard_table(std::uint64_t seed);

// Steps of 10:1 at three angles: three stripes, in clear and in hazy water. Only columns whose step lies within 2.5 widths of the stripe count.
Table step_table(std::uint64_t seed);

}  // namespace lf::test
