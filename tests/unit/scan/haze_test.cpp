// The haze against sums of Gaussians in closed form.
#include "firmware/scan/haze.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace lf::scan {
namespace {

constexpr std::int32_t width = 640, height = 480;

double line_spread(double distance_px, double sigma_px) {
  return std::exp(-0.5 * distance_px * distance_px / (sigma_px * sigma_px)) / (sigma_px * std::sqrt(2 * std::numbers::pi));
}

// A value that is the same all along a line goes over into Gaussians of 8, 32 and 128 px.
double haze_of_line(double distance_px) {
  return 0.248 * line_spread(distance_px, 8) + 0.275 * line_spread(distance_px, 32) + 0.118 * line_spread(distance_px, 128);
}

PixelView<std::uint8_t> view(const std::vector<std::uint8_t>& pixels, std::int32_t w = width, std::int32_t h = height) {
  return {pixels.data(), w, h, w};
}

TEST(Haze, OfAUniformPictureIsItsShare) {
  const std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height), 200);
  const auto haze = std::make_unique<Haze>();
  haze->compute(view(pixels));
  for (const float u : {-5.0f, 0.0f, 3.7f, 320.0f, 639.0f, 700.0f}) {
    for (const float v : {-5.0f, 0.0f, 240.3f, 479.0f, 500.0f}) EXPECT_NEAR(haze->at(u, v), 200 * haze_share, 1e-3) << u << ", " << v;
  }
}

// Within a tenth of the peak, as cells of 8 px follow a Gaussian of 8. Lines wherever they lie over the cells, along rows and along columns.
TEST(Haze, OfALineIsThreeGaussians) {
  const auto haze = std::make_unique<Haze>();
  for (const std::int32_t line : {236, 239, 240, 243}) {
    std::vector<std::uint8_t> along_rows(static_cast<std::size_t>(width * height)), along_columns(along_rows.size());
    for (std::int32_t i = 0; i < 3; ++i) {
      for (std::int32_t u = 0; u < width; ++u) along_rows[static_cast<std::size_t>((line - 1 + i) * width + u)] = 250;
      for (std::int32_t v = 0; v < height; ++v) along_columns[static_cast<std::size_t>(v * width + line - 1 + i)] = 250;
    }
    const double peak = 750 * haze_of_line(0);
    for (const std::int32_t distance : {0, 3, 7, 10, 15, 25, 50, 80}) {
      const double expected = 750 * haze_of_line(distance);
      haze->compute(view(along_rows));
      EXPECT_NEAR(haze->at(320, static_cast<float>(line + distance)), expected, 0.10 * peak) << "row " << line << " + " << distance;
      EXPECT_NEAR(haze->at(320, static_cast<float>(line - distance)), expected, 0.10 * peak) << "row " << line << " - " << distance;
      haze->compute(view(along_columns));
      EXPECT_NEAR(haze->at(static_cast<float>(line + distance), 240), expected, 0.10 * peak) << "column " << line << " + " << distance;
    }
  }
}

// A camera of half the pixels a radian: everything is half as wide.
TEST(Haze, ScalesWithTheCamera) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height));
  for (std::int32_t v = 239; v <= 241; ++v) std::fill_n(pixels.begin() + v * width, width, std::uint8_t{250});
  const auto haze = std::make_unique<Haze>();
  haze->compute(view(pixels), 16.0f);
  for (const int distance : {0, 10, 30, 100}) {
    const double expected =
        750 * (0.248 * line_spread(distance, 16) + 0.275 * line_spread(distance, 64) + 0.118 * line_spread(distance, 256));
    EXPECT_NEAR(haze->at(320, static_cast<float>(240 + distance)), expected, 0.03 * 750 * haze_of_line(0)) << distance;
  }
}

TEST(Haze, TakesAnySizeThatFits) {
  const auto haze = std::make_unique<Haze>();
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 3}, {9, 8}, {33, 479}, {639, 480}}) {
    const std::vector<std::uint8_t> pixels(static_cast<std::size_t>(w * h), 100);
    haze->compute(view(pixels, w, h));
    EXPECT_NEAR(haze->at(static_cast<float>(w) / 2, static_cast<float>(h) / 2), 100 * haze_share, 1e-3) << w << " x " << h;
  }
  const std::vector<std::uint8_t> large(static_cast<std::size_t>(641 * 480), 100);
  haze->compute(view(large, 641, 480));
  EXPECT_EQ(haze->at(10, 10), 0.0f) << "too large";
  haze->compute({});
  EXPECT_EQ(haze->at(10, 10), 0.0f) << "no picture";
}

}  // namespace
}  // namespace lf::scan
