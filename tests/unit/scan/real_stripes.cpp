#include "tests/unit/scan/real_stripes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/unit/read_picture.hpp"

namespace lf::test {
namespace {

const std::string data_folder = LANTERNFISH_TEST_DATA;

}  // namespace

Picture red_of(const std::string& file) {
  const cv::Mat image = read_picture(data_folder + "/" + file);
  Picture picture{image.cols, image.rows, {}};
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) picture.pixels.push_back(image.at<cv::Vec3b>(v, u)[2]);
  }
  return picture;
}

Pair read_pair(int number) {
  const std::string name = std::string("laser_on_off_pairs/pair") + (number < 10 ? "0" : "") + std::to_string(number);
  return {red_of(name + "_on.jpg"), red_of(name + "_off.jpg")};
}

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

double scatter_about_polynomial(const Points& points, int order) {
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

Points on_piece(const Points& peaks, const Piece& piece) {
  std::vector<double> heights;
  for (const auto& [u, v] : peaks) {
    if (u >= piece.first && u <= piece.last) heights.push_back(v - piece.slope * u);
  }
  if (heights.empty()) return {};
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
  const double height = heights[heights.size() / 2];
  Points near;
  for (const auto& [u, v] : peaks) {
    if (u >= piece.first && u <= piece.last && std::abs(v - height - piece.slope * u) <= 14) near.emplace_back(u, v);
  }
  return near;
}

}  // namespace lf::test
