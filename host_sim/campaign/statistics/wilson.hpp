// How far a share that was counted may be off.
#pragma once

#include <cstddef>

namespace lf::campaign {

struct Interval {
  double low = 0, high = 1;
};

// The 95 % interval of a share, from `hits` of `trials` (Wilson, J. Am. Stat. Assoc. 22, 1927). It stays within 0..1, and it has a width at 0 and at all
// of them, too: 200 of 200 may be a share of 98.1 %. 0..1 without trials.
Interval wilson_95(std::size_t hits, std::size_t trials);

}  // namespace lf::campaign
