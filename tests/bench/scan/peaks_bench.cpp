#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>

#include "firmware/scan/peaks.hpp"
#include "tests/bench/scan/scan_bench.hpp"

namespace lf::bench {
namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) { return std::chrono::duration<double, std::micro>(Clock::now() - start).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// A stripe of sigma 1.5 px and 60 grey levels on a backscatter skirt of 30 % over a textured scene, noise of 2 grey levels: turbid water.
struct Picture {
  cv::Mat on, off;
  std::vector<double> centre_px;
};

Picture make_picture(int width, int height) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 2);
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  Picture p{cv::Mat(height, width, CV_8U), cv::Mat(height, width, CV_8U), std::vector<double>(static_cast<std::size_t>(width))};
  for (int u = 0; u < width; ++u) {
    const double centre = p.centre_px[static_cast<std::size_t>(u)] = height * (0.2 + 0.6 * u / width) + shift(random);
    for (int v = 0; v < height; ++v) {
      const double d = v - centre, scene = 30 + 10 * std::sin(0.7 * v) * std::cos(0.3 * u);
      const double stripe = 60 * (std::exp(-0.5 * d * d / 2.25) + 0.3 * std::exp(-0.5 * (d - 6) * (d - 6) / 144));
      p.on.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(scene + stripe + noise(random));
      p.off.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(scene + noise(random));
    }
  }
  return p;
}

// On less off, blurred; each column's brightest row; centre of mass about it. The usual way with OpenCV.
struct OpenCvPeaks {
  cv::Mat difference, blurred, brightest;
  std::vector<float> centre_px;

  void detect(const Picture& p) {
    cv::subtract(p.on, p.off, difference);
    cv::GaussianBlur(difference, blurred, {5, 5}, 0);
    cv::reduceArgMax(blurred, brightest, 0);
    centre_px.assign(static_cast<std::size_t>(p.on.cols), -1);
    for (int u = 0; u < p.on.cols; ++u) {
      const int row = brightest.at<int>(0, u);
      int weight = 0, moment = 0;
      for (int v = std::max(0, row - 5); v <= std::min(p.on.rows - 1, row + 5); ++v) {
        const int grey = blurred.at<std::uint8_t>(v, u);
        weight += grey;
        moment += (v - row) * grey;
      }
      if (weight > 0)
        centre_px[static_cast<std::size_t>(u)] = static_cast<float>(row) + static_cast<float>(moment) / static_cast<float>(weight);
    }
  }
};

void add_rows(int width, int height, std::vector<Row>& rows) {
  const Picture picture = make_picture(width, height);
  const scan::PixelView<std::uint8_t> on(picture.on.data, width, height, width), off(picture.off.data, width, height, width);
  auto detector = std::make_unique<scan::LargePeakDetector>();
  std::vector<scan::Peak> peaks(static_cast<std::size_t>(width));
  OpenCvPeaks peer;
  std::size_t found = 0;
  std::vector<double> ours_us, peer_us;
  cv::setNumThreads(1);
  for (int run = 0; run < 60; ++run) {
    Clock::time_point start = Clock::now();
    found = detector->detect(on, off, peaks);
    ours_us.push_back(us_since(start));
    start = Clock::now();
    peer.detect(picture);
    peer_us.push_back(us_since(start));
  }
  double ours_squares = 0, peer_squares = 0;
  for (std::size_t i = 0; i < found; ++i)
    ours_squares += std::pow(peaks[i].v_px - picture.centre_px[static_cast<std::size_t>(peaks[i].u_px)], 2);
  for (std::size_t u = 0; u < picture.centre_px.size(); ++u) peer_squares += std::pow(peer.centre_px[u] - picture.centre_px[u], 2);
  const double ours_rms = std::sqrt(ours_squares / static_cast<double>(std::max<std::size_t>(1, found)));
  const double peer_rms = std::sqrt(peer_squares / width);
  const std::string size = std::to_string(width) + "x" + std::to_string(height), name = "OpenCV blur + argmax + centre of mass";
  rows.push_back({"peaks " + size, median(ours_us), median(peer_us), name, median(peer_us) / median(ours_us), "us",
                  "on-off difference, one thread; " + std::to_string(found) + " of " + std::to_string(width) + " columns"});
  rows.push_back({"peaks " + size + " error", ours_rms, peer_rms, name, peer_rms / ours_rms, "px rms",
                  "backscatter skirt of 30 %, noise 2 grey levels"});
}

}  // namespace

std::vector<Row> run_peaks_bench() {
  std::vector<Row> rows;
  add_rows(640, 480, rows);
  add_rows(1920, 1080, rows);
  return rows;
}

}  // namespace lf::bench
