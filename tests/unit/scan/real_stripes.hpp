// Real pictures of laser stripes, and what is known of them (tests/data: laser_on_off_pairs, weld_stripe_speckle).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "firmware/scan/pixel_view.hpp"

namespace lf::test {

struct Picture {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  scan::PixelView<std::uint8_t> view() const { return {pixels.data(), width, height, width}; }
};

// The red channel of a file of tests/data.
Picture red_of(const std::string& file);

struct Pair {
  Picture on, off;
};
Pair read_pair(int number);

// Rows of the line, by column: of each pair.
using Columns = std::map<std::int32_t, double>;
std::map<int, Columns> read_reference();

// The weld's straight pieces: columns, slope, and the rms that is asked for.
struct Piece {
  const char* name;
  std::int32_t first, last;
  double slope, rms_px;
};
inline constexpr std::array<Piece, 4> pieces{{{"left flat", 10, 499, -0.009, 0.55},
                                              {"left slope", 545, 714, 0.909, 0.90},
                                              {"right slope", 835, 1019, -0.868, 0.52},
                                              {"right flat", 1060, 1269, 0.026, 0.40}}};

using Points = std::vector<std::pair<double, double>>;  // column and row

// Root mean square of what a polynomial's least-squares fit leaves.
double scatter_about_polynomial(const Points& points, int order);

// Of `peaks` those of the piece that lie within 14 rows of its line. The line is the median of what they say, at the piece's slope.
Points on_piece(const Points& peaks, const Piece& piece);

}  // namespace lf::test
