// Whether the answer of `peaks` is to be trusted: what a stripe looks like where its peaks were found, and how its peaks scatter.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "firmware/scan/peaks.hpp"

namespace lf::app {

// Grey levels of the picture, less those of the one without the laser where there is one: by line across the stripe, and place along the line.
struct StripePicture {
  std::int32_t lines = 0, length = 0;
  std::function<double(std::int32_t line, std::int32_t place)> grey;
};

struct StripeLook {
  std::int32_t lines = 0, found = 0;
  std::uint64_t ambiguous = 0;  // lines in which several peaks are as strong
  bool off_given = false;  // a picture without the laser was subtracted
  double dark_share =
      0;  // of the lines found, those in which a dark line stands beside the peak or elsewhere, more than half as deep as the peak is high
  double width_px = 0;    // of the mean profile at half its height; 0: not measured
  double scatter_px = 0;  // 1 sigma of the peaks about their neighbours, by the median of their second differences; 0: not measured
};

// The peaks' places are `v_px` for PeakAxis::column, `u_px` for row; at most one a line.
StripeLook look_at_stripe(const StripePicture& picture, std::span<const scan::Peak> peaks, scan::PeakAxis axis);

// Reasons to doubt the peaks, a sentence each; empty: none. Where fewer than 10 peaks are, their look is not judged.
std::vector<std::string> peak_doubts(const StripeLook& look);

}  // namespace lf::app
