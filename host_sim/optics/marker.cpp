#include "host_sim/optics/marker.hpp"

#include <cmath>
#include <opencv2/aruco.hpp>

#include "shared/input_error.hpp"

namespace lf::optics {

Marker::Marker(std::int32_t id, double size_m) : size_m_(size_m) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  if (id < 0 || id >= dictionary->bytesList.rows)
    throw InputError("marker: 36h11 has no id " + std::to_string(id) + " (0.." + std::to_string(dictionary->bytesList.rows - 1) + ")");
  if (!(size_m > 0) || !std::isfinite(size_m)) throw InputError("marker: its size must be positive");
  cv::Mat bitmap;
  dictionary->drawMarker(id, cells, bitmap, 1);
  // OpenCV keeps AprilTags half a turn on from the way that AprilTag's own images are printed.
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) white_[row][column] = bitmap.at<std::uint8_t>(cells - 1 - row, cells - 1 - column) > 127;
  }
}

bool Marker::white(double x_m, double y_m) const {
  const double column = (x_m / size_m_ + 0.5) * cells, row = (0.5 - y_m / size_m_) * cells;
  if (!(column >= 0 && column < cells && row >= 0 && row < cells)) return true;
  return white_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
}

float Marker::white_share(const Vec2& p, const Vec2& du, const Vec2& dv) const {
  constexpr int n = 6;  // 36 samples: a cell's edge lands within 1/12 px
  const double reach = 0.5 * (du.cwiseAbs() + dv.cwiseAbs()).maxCoeff();
  if (p.cwiseAbs().maxCoeff() - reach > 0.5 * size_m_) return 1.f;
  int count = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Vec2 q = p + du * ((i + 0.5) / n - 0.5) + dv * ((j + 0.5) / n - 0.5);
      count += white(q.x(), q.y());
    }
  }
  return static_cast<float>(count) / (n * n);
}

}  // namespace lf::optics
