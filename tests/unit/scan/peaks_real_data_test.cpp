// Peaks in real pictures, as `lanternfish peaks` finds them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "firmware/scan/peak_refiner.hpp"
#include "firmware/scan/peaks.hpp"

namespace lf::scan {
namespace {

const std::string data_folder = LANTERNFISH_TEST_DATA;

struct Picture {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  PixelView<std::uint8_t> view() const { return {pixels.data(), width, height, width}; }
};

Picture red_of(const std::string& file) {
  const cv::Mat image = cv::imread(data_folder + "/" + file, cv::IMREAD_COLOR);
  Picture picture{image.cols, image.rows, {}};
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) picture.pixels.push_back(image.at<cv::Vec3b>(v, u)[2]);
  }
  return picture;
}

std::vector<Peak> peaks_of(const Picture& on, const Picture& off) {
  const auto detector = std::make_unique<LargePeakDetector>();
  RefinerConfig config;
  config.largest_misfit = std::numeric_limits<float>::infinity();  // as `peaks` has it
  const auto refiner = std::make_unique<LargePeakRefiner>(config);
  const PixelView<std::uint8_t> background = off.pixels.empty() ? PixelView<std::uint8_t>() : off.view();
  std::vector<Peak> peaks(static_cast<std::size_t>(on.width));
  peaks.resize(detector->detect(on.view(), background, peaks));
  peaks.resize(refiner->refine(on.view(), background, peaks));
  return peaks;
}

using Columns = std::map<std::int32_t, double>;

// Rows of the line, by column: of each pair.
std::map<int, Columns> read_reference() {
  std::map<int, Columns> pairs;
  std::ifstream in(data_folder + "/laser_on_off_pairs/reference.csv");
  std::string line;
  std::getline(in, line);
  int pair = 0, u = 0, v = 0;
  char comma = 0;
  while (in >> pair >> comma >> u >> comma >> v) pairs[pair][u] = v;
  return pairs;
}

// Root mean square of what a polynomial's least-squares fit leaves.
double scatter_about_polynomial(const std::vector<std::pair<double, double>>& points, int order) {
  const auto rows = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd a(rows, order + 1);
  Eigen::VectorXd b(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto& [x, y] = points[static_cast<std::size_t>(i)];
    for (int k = 0; k <= order; ++k) a(i, k) = std::pow((x - points.front().first) / 100, k);
    b(i) = y;
  }
  return (a * a.colPivHouseholderQr().solve(b) - b).norm() / std::sqrt(static_cast<double>(rows));
}

TEST(PeaksInRealPairs, LieOnTheLine) {
  int right = 0, wrong = 0, elsewhere = 0;
  double scatter_px = 0;
  for (const auto& [pair, truth] : read_reference()) {
    const std::string number = (pair < 10 ? "0" : "") + std::to_string(pair);
    const std::string name = "laser_on_off_pairs/pair" + number;
    int right_here = 0;
    std::vector<std::pair<double, double>> straight;
    for (const Peak& peak : peaks_of(red_of(name + "_on.jpg"), red_of(name + "_off.jpg"))) {
      const auto column = static_cast<std::int32_t>(std::lround(peak.u_px));
      const auto row = truth.find(column);
      if (row == truth.end()) {
        ++elsewhere;
      } else if (std::abs(double(peak.v_px) - row->second) <= 1.5) {
        ++right_here;
      } else {
        ++wrong;
      }
      if (pair == 4 && column >= 60 && column <= 317) straight.emplace_back(column, double(peak.v_px));
    }
    right += right_here;
    std::printf("pair %d: %d of %zu\n", pair, right_here, truth.size());
    if (pair == 4) scatter_px = scatter_about_polynomial(straight, 3);
  }
  std::printf("right %d, wrong %d, elsewhere %d; scatter of pair 4 %.3f px\n", right, wrong, elsewhere, scatter_px);
  EXPECT_GE(right, 2140);
  EXPECT_LE(wrong, 45);
  EXPECT_LE(elsewhere, 120);
  EXPECT_LE(scatter_px, 0.10);
}

struct Piece {
  const char* name;
  std::int32_t first, last;
  double slope, rms_px;
};

TEST(PeaksInSpeckle, LieOnFourStraightPieces) {
  const std::vector<Peak> peaks = peaks_of(red_of("weld_stripe_speckle/weld2.png"), {});
  int on_line = 0, in_gap = 0;
  for (const Peak& peak : peaks) in_gap += peak.u_px >= 741 && peak.u_px <= 814;
  for (const Piece& piece : {Piece{"left flat", 10, 499, -0.009, 0.55}, Piece{"left slope", 545, 714, 0.909, 0.90},
                             Piece{"right slope", 835, 1019, -0.868, 0.52}, Piece{"right flat", 1060, 1269, 0.026, 0.40}}) {
    // Where the line lies: the median of what the peaks say, at the piece's slope.
    std::vector<double> heights;
    for (const Peak& peak : peaks) {
      if (peak.u_px >= static_cast<float>(piece.first) && peak.u_px <= static_cast<float>(piece.last))
        heights.push_back(double(peak.v_px) - piece.slope * double(peak.u_px));
    }
    ASSERT_GT(heights.size(), 50U) << piece.name;
    std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
    const double height = heights[heights.size() / 2];
    std::vector<std::pair<double, double>> near;
    for (const Peak& peak : peaks) {
      const double u = double(peak.u_px), v = double(peak.v_px);
      if (u < piece.first || u > piece.last || std::abs(v - height - piece.slope * u) > 14) continue;
      near.emplace_back(u, v);
    }
    on_line += static_cast<int>(near.size());
    const double rms_px = scatter_about_polynomial(near, 1);
    std::printf("%s: %zu columns, rms %.3f px\n", piece.name, near.size(), rms_px);
    EXPECT_LE(rms_px, piece.rms_px) << piece.name;
  }
  std::printf("on the line %d of 1055, in the gap %d\n", on_line, in_gap);
  EXPECT_GE(on_line, 1015);
  EXPECT_LE(in_gap, 16);
}

}  // namespace
}  // namespace lf::scan
