// Peaks in real pictures, as `lanternfish peaks` finds them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"
#include "tests/unit/scan/real_stripes.hpp"

namespace lf::scan {
namespace {

test::Points peaks_of(const test::Picture& on, const test::Picture& off) {
  const auto detector = std::make_unique<LargePeakDetector>();
  RefinerConfig config;
  config.largest_misfit = std::numeric_limits<float>::infinity();  // as `peaks` has it
  const auto refiner = std::make_unique<LargePeakRefiner>(config);
  const PixelView<std::uint8_t> background = off.pixels.empty() ? PixelView<std::uint8_t>() : off.view();
  std::vector<Peak> peaks(static_cast<std::size_t>(on.width));
  peaks.resize(detector->detect(on.view(), background, peaks));
  peaks.resize(refiner->refine(on.view(), background, peaks));
  test::Points points;
  for (const Peak& peak : peaks) points.emplace_back(double(peak.u_px), double(peak.v_px));
  return points;
}

TEST(PeaksInRealPairs, LieOnTheLine) {
  int right = 0, wrong = 0, elsewhere = 0;
  double scatter_px = 0;
  for (const auto& [number, truth] : test::read_reference()) {
    const test::Pair pair = test::read_pair(number);
    int right_here = 0;
    test::Points straight;
    for (const auto& [u, v] : peaks_of(pair.on, pair.off)) {
      const auto column = static_cast<std::int32_t>(std::lround(u));
      const auto row = truth.find(column);
      if (row == truth.end()) {
        ++elsewhere;
      } else if (std::abs(v - row->second) <= 1.5) {
        ++right_here;
      } else {
        ++wrong;
      }
      if (number == 4 && column >= 60 && column <= 317) straight.emplace_back(column, v);
    }
    right += right_here;
    std::printf("pair %d: %d of %zu\n", number, right_here, truth.size());
    if (number == 4) scatter_px = test::scatter_about_polynomial(straight, 3);
  }
  std::printf("right %d, wrong %d, elsewhere %d; scatter of pair 4 %.3f px\n", right, wrong, elsewhere, scatter_px);
  EXPECT_GE(right, 2140);
  EXPECT_LE(wrong, 45);
  EXPECT_LE(elsewhere, 120);
  EXPECT_LE(scatter_px, 0.10);
}

TEST(PeaksInSpeckle, LieOnFourStraightPieces) {
  const test::Points peaks = peaks_of(test::red_of("weld_stripe_speckle/weld2.png"), {});
  int on_line = 0, in_gap = 0;
  for (const auto& [u, v] : peaks) in_gap += u >= 741 && u <= 814;
  for (const test::Piece& piece : test::pieces) {
    const test::Points near = test::on_piece(peaks, piece);
    ASSERT_GT(near.size(), 50U) << piece.name;
    on_line += static_cast<int>(near.size());
    const double rms_px = test::scatter_about_polynomial(near, 1);
    std::printf("%s: %zu columns, rms %.3f px\n", piece.name, near.size(), rms_px);
    EXPECT_LE(rms_px, piece.rms_px) << piece.name;
  }
  std::printf("on the line %d of 1055, in the gap %d\n", on_line, in_gap);
  EXPECT_GE(on_line, 1030);
  EXPECT_LE(in_gap, 16);
}

}  // namespace
}  // namespace lf::scan
