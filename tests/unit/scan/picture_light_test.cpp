#include "firmware/scan/picture_light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

constexpr int width = 640, height = 480;

PictureLight light_of(const std::function<double(int u, int v)>& grey) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u)
      pixels[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] =
          static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, std::round(grey(u, v)))));
  }
  return picture_light({pixels.data(), width, height, width});
}

TEST(PictureLight, OfAnEvenPictureIsItsGrey) {
  const PictureLight even = light_of([](int, int) { return 37; });
  EXPECT_EQ(even.mean_grey, 37);
  EXPECT_EQ(even.contrast_grey, 0);
  EXPECT_EQ(even.white_share, 0);
  const PictureLight white = light_of([](int, int v) { return v < height / 4 ? 254 : 255; });
  EXPECT_EQ(white.white_share, 0.75f);
}

TEST(PictureLight, HasTheNoiseOfItsPixels) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 12);
  EXPECT_NEAR(light_of([&](int u, int) { return 100 + 0.05 * u + noise(random); }).noise_grey, 12, 0.5);
}

// Squares of 16 px: every second step between squares of 8 is one of 40 grey levels.
TEST(PictureLight, HasTheStepOfAPatternForItsContrast) {
  const PictureLight pattern = light_of([](int u, int v) { return ((u / 16 + v / 16) % 2) != 0 ? 140 : 100; });
  EXPECT_EQ(pattern.mean_grey, 120);
  EXPECT_EQ(pattern.contrast_grey, 40);
}

// Of 79 x 60 steps one in a hundred are 47: a pattern of 128 px has 7 steps inside and 2 at its edges in each of its 16 rows.
TEST(PictureLight, SeesAMarkerInAnOtherwiseEvenPicture) {
  const PictureLight marker = light_of([](int u, int v) {
    const int du = u - 200, dv = v - 200;
    if (du < 0 || dv < 0 || du >= 128 || dv >= 128) return 100;
    return ((du / 16 + dv / 16) % 2) != 0 ? 150 : 50;
  });
  EXPECT_GT(marker.contrast_grey, 30);
}

// The mean of 64 pixels of sigma 3 has 0.375, the step between two of them 0.53; one in a hundred exceeds 2.58 of these, 1.37.
TEST(PictureLight, IsHardlyMovedByNoiseOrByASlope) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 3);
  const PictureLight noisy = light_of([&](int, int) { return 60 + noise(random); });
  EXPECT_NEAR(noisy.contrast_grey, 1.37, 0.3);
  const PictureLight slope = light_of([](int u, int) { return 20 + 0.2 * u; });
  EXPECT_NEAR(slope.contrast_grey, 8 * 0.2, 0.26);
}

TEST(PictureLight, OfNoPictureIsNothing) {
  EXPECT_EQ(picture_light({}).mean_grey, 0);
  const std::vector<std::uint8_t> few(12, 200);
  const PictureLight small = picture_light({few.data(), 4, 3, 4});
  EXPECT_EQ(small.mean_grey, 200);
  EXPECT_EQ(small.contrast_grey, 0);
}

}  // namespace
}  // namespace lf::scan
