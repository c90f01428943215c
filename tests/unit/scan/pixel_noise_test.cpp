#include "firmware/scan/pixel_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

constexpr int width = 640, height = 480;

template <class Pixel>
float noise_of(int full_scale, NoiseAlong along, const std::function<double(int u, int v)>& grey) {
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u)
      pixels[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] =
          static_cast<Pixel>(std::clamp(std::round(grey(u, v) * full_scale / 255), 0.0, double(full_scale)));
  }
  return pixel_noise_grey(PixelView<Pixel>(pixels.data(), width, height, width), full_scale, along);
}

// Rounding adds a twelfth of a level squared.
TEST(PixelNoise, IsThatOfThePixelsOverSlopesAndShapes) {
  for (const double sigma : {0.5, 1.0, 1.5, 3.0, 12.0, 25.0}) {
    for (const int full_scale : {255, 1023, 4095}) {
      std::mt19937 random(5);
      std::normal_distribution<double> noise(0, sigma);
      const auto grey = [&](int u, int v) { return 100 + 0.05 * u - 0.03 * v + (((u / 32 + v / 32) % 2) != 0 ? 20 : 0) + noise(random); };
      const double rounded = std::hypot(sigma, 255.0 / full_scale / std::sqrt(12.0));
      for (const NoiseAlong along : {NoiseAlong::rows, NoiseAlong::columns}) {
        const float seen =
            full_scale == 255 ? noise_of<std::uint8_t>(full_scale, along, grey) : noise_of<std::uint16_t>(full_scale, along, grey);
        EXPECT_NEAR(seen, rounded, 0.06 * rounded + 0.02) << sigma << " of " << full_scale;
      }
    }
  }
}

TEST(PixelNoise, OfRowsIsSeenAlongColumnsAlone) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0, 2);
  std::vector<double> rows(height);
  for (double& row : rows) row = noise(random);
  const auto grey = [&](int, int v) { return 100 + rows[static_cast<std::size_t>(v)]; };
  EXPECT_NEAR((noise_of<std::uint16_t>(4095, NoiseAlong::columns, grey)), 2, 0.5) << "of the darkest and brightest of 120 rows";
  EXPECT_LT((noise_of<std::uint16_t>(4095, NoiseAlong::rows, grey)), 0.1);
}

// Bars of 20 and 200 grey levels, 5 px each, as a picture of nothing but edges. 40 electrons to a grey level are 0.7 and 2.2 of shot noise. The other picture is darker.
TEST(ReadNoise, IsToldFromPaintAndFromTheNoiseOfTheLight) {
  for (const double sigma : {1.0, 1.5, 3.0}) {
    for (const double gain : {1.0, 1.3}) {
      std::mt19937 random(8);
      std::normal_distribution<double> noise(0, 1);
      const auto picture = [&](double brighter) {
        std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
        for (int v = 0; v < height; ++v) {
          for (int u = 0; u < width; ++u) {
            const double paint = brighter * (((u + 2 * v) / 10) % 2 == 0 ? 20 : 150);
            const double grey = paint + std::sqrt(sigma * sigma + paint / 40) * noise(random);
            pixels[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] =
                static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0));
          }
        }
        return pixels;
      };
      const std::vector<std::uint8_t> on = picture(gain), off = picture(1);
      const float seen = read_noise_grey(PixelView<std::uint8_t>(on.data(), width, height, width),
                                         PixelView<std::uint8_t>(off.data(), width, height, width), static_cast<float>(gain), 40, 255,
                                         NoiseAlong::columns);
      EXPECT_NEAR(seen, std::hypot(sigma, 0.29), 0.08 * sigma) << sigma << " " << gain;
    }
  }
}

TEST(PixelNoise, TellsNothingOfClippedAndSmallPictures) {
  EXPECT_EQ((noise_of<std::uint8_t>(255, NoiseAlong::rows, [](int u, int v) { return (u * 7 + v) % 2 == 0 ? 0 : 255; })), 0);
  EXPECT_EQ(pixel_noise_grey(PixelView<std::uint8_t>(), 255, NoiseAlong::rows), 0);
  const std::uint8_t few[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_EQ(pixel_noise_grey(PixelView<std::uint8_t>(few, 3, 3, 3), 255, NoiseAlong::columns), 0);
  EXPECT_EQ(pixel_noise_grey(PixelView<std::uint8_t>(few, 9, 1, 9), 255, NoiseAlong::columns), 0);
}

}  // namespace
}  // namespace lf::scan
