// Pictures that a camera forms, their peaks by detector and refiner, and how far those are off.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "firmware/scan/peak_refiner.hpp"
#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::test {

inline constexpr std::int32_t width = 320, height = 192;

inline FormedStripe scene(double beam_px) {
  FormedStripe s;
  s.width = width;
  s.height = height;
  s.middle_px = 80.37;
  s.beam_sigma_px = beam_px;
  s.speckle = 0.18;
  s.bars.phase_px = 3.3;
  return s;
}

template <class Pixel>
std::vector<Pixel> pixels(const std::vector<double>& plane, double by = 1, double full_scale = 255) {
  std::vector<Pixel> out;
  for (const double grey : plane) out.push_back(static_cast<Pixel>(std::clamp(std::round(by * grey), 0.0, full_scale)));
  return out;
}

template <class Pixel>
std::vector<Pixel> turned(const std::vector<Pixel>& in) {
  std::vector<Pixel> out(in.size());
  for (std::int32_t v = 0; v < height; ++v) {
    for (std::int32_t u = 0; u < width; ++u) out[static_cast<std::size_t>(u * height + v)] = in[static_cast<std::size_t>(v * width + u)];
  }
  return out;
}

// The detector's peaks of a pair, or of a picture alone: it knows nothing of edges.
template <class Pixel>
std::vector<scan::Peak> coarse(const std::vector<Pixel>& on, const std::vector<Pixel>& off, std::int32_t full_scale) {
  scan::PeakConfig config;
  config.full_scale = full_scale;
  auto detector = std::make_unique<scan::BasicPeakDetector<Pixel, 4096>>(config);
  std::vector<scan::Peak> peaks(static_cast<std::size_t>(width));
  const scan::PixelView<Pixel> none, dark{off.data(), width, height, width};
  peaks.resize(detector->detect({on.data(), width, height, width}, off.empty() ? none : dark, peaks));
  return peaks;
}

struct Errors {
  std::vector<double> at_edges, elsewhere;  // px
  int columns = 0, far = 0;                 // far: by more than 2 px

  static double rms(const std::vector<double>& errors) {
    double squares = 0;
    for (const double error : errors) squares += error * error;
    return errors.empty() ? 0 : std::sqrt(squares / static_cast<double>(errors.size()));
  }
  static double percentile_999(const std::vector<double>& errors) {
    if (errors.empty()) return 0;
    std::vector<double> sizes;
    for (const double error : errors) sizes.push_back(std::abs(error));
    std::sort(sizes.begin(), sizes.end());
    return sizes[static_cast<std::size_t>(std::ceil(0.999 * static_cast<double>(sizes.size()))) - 1];
  }
};

inline void compare(const FormedStripe& s, const FormedImage& image, std::span<const scan::Peak> peaks, Errors& errors) {
  errors.columns += image.width;
  for (const scan::Peak& peak : peaks) {
    const auto u = static_cast<std::size_t>(std::lround(peak.u_px));
    const double error = peak.v_px - image.centre_px[u];
    if (std::abs(error) > 2) {
      ++errors.far;
      continue;
    }
    (image.to_edge_px[u] <= 2.5 * width_px(s) ? errors.at_edges : errors.elsewhere).push_back(error);
  }
}

// One refiner over four pictures, edges at as many angles.
inline Errors over_angles(FormedStripe s, scan::PeakRefiner& refiner, double gain = 1, Errors errors = {}) {
  for (const double angle_rad : {0.0, 0.5, 1.0, 1.5}) {
    s.bars.angle_rad = angle_rad;
    s.seed = static_cast<std::uint64_t>(1 + 100 * angle_rad + 1000 * (s.bars.phase_px - 3.3));
    const FormedImage image = form(s);
    const auto on = pixels<std::uint8_t>(image.on), off = pixels<std::uint8_t>(image.off, 1 / gain);
    std::vector<scan::Peak> peaks = coarse(on, off, 255);
    // Twice, so that the first picture is measured with what it has told.
    for (int time = 0; time < 2; ++time) {
      std::vector<scan::Peak> refined = peaks;
      refined.resize(refiner.refine({on.data(), width, height, width}, {off.data(), width, height, width}, refined));
      if (time == 1) compare(s, image, refined, errors);
    }
  }
  return errors;
}

}  // namespace lf::test
