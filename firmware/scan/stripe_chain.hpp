// Which peaks of a picture are of a line: a stripe goes on from column to column, a speck that drifts in the water is a few columns wide.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/scan/peaks.hpp"

namespace lf::scan {

struct ChainConfig {
  // A bar of 8 mm at 0.95 m; lens and filter add to that in pixels, whatever the camera. A speck of 1 mm is seen as wide.
  double part_rad = 0.0084;
  double spread_px = 2;
  // A picture without a chain so wide shows no panel, so that its short ones are no parts before a panel.
  double panel_rad = 0.066;
  float step_px = 2.5f;  // from one column to the next; a stripe seen at 60 degrees rises by 1.7

  // Columns of a part and of a panel, at least, for a camera of this focal length.
  int part_columns(double fx_px) const { return columns(part_rad * fx_px + spread_px); }
  int panel_columns(double fx_px) const { return columns(panel_rad * fx_px); }

 private:
  static int columns(double px) { return px < 255 ? std::max(static_cast<int>(std::lround(px)), 4) : 255; }
};

// For each peak the columns of the longest chain that it stands in, its own included, at most 255. In a chain a column may be missing, and the place changes by at most
// `step_px` a column. `peaks` in the order of columns, at most `max_peaks_per_line` a column; `columns` of the same size. O(peaks).
inline void measure_chains(std::span<const Peak> peaks, float step_px, std::span<std::uint8_t> columns) {
  const std::ptrdiff_t count = std::ssize(peaks);
  // Of the longest chain that comes to peak i over those before it in the direction of `step`.
  const auto before = [&](std::ptrdiff_t i, std::ptrdiff_t step, auto columns_of) {
    int longest = 0;
    const Peak& peak = peaks[static_cast<std::size_t>(i)];
    for (std::ptrdiff_t j = i - step; j >= 0 && j < count; j -= step) {
      const Peak& other = peaks[static_cast<std::size_t>(j)];
      const float apart = std::abs(peak.u_px - other.u_px);
      if (apart > 2.5f) break;
      if (apart > 0.5f && std::abs(peak.v_px - other.v_px) <= step_px * apart) longest = std::max(longest, columns_of(j));
    }
    return longest;
  };
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const int from_left = before(i, 1, [&](std::ptrdiff_t j) { return int{columns[static_cast<std::size_t>(j)]}; });
    columns[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::min(from_left + 1, 255));
  }
  // The same from the right; of the last three columns it has to be at hand.
  std::array<int, 4 * max_peaks_per_line> recent{};
  const auto place = [](std::ptrdiff_t i) { return static_cast<std::size_t>(i) % std::tuple_size_v<decltype(recent)>; };
  for (std::ptrdiff_t i = count - 1; i >= 0; --i) {
    const int from_right = before(i, -1, [&](std::ptrdiff_t j) { return recent[place(j)]; });
    recent[place(i)] = std::min(from_right + 1, 255);
    std::uint8_t& whole = columns[static_cast<std::size_t>(i)];
    whole = static_cast<std::uint8_t>(std::min(whole + from_right, 255));
  }
}

}  // namespace lf::scan
