// The gain between two pictures whose exposures differ by a known factor, with a stripe in one of them.
#include "firmware/scan/exposure_gain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/unit/scan/formed_stripe.hpp"

namespace lf::scan {
namespace {

using test::form;
using test::FormedImage;
using test::FormedStripe;

template <class Pixel>
std::vector<Pixel> exposed(const std::vector<double>& plane, double by, double full_scale) {
  std::vector<Pixel> pixels;
  for (const double grey : plane) pixels.push_back(static_cast<Pixel>(std::clamp(std::round(by * grey), 0.0, full_scale)));
  return pixels;
}

template <class Pixel>
PixelView<Pixel> view(const std::vector<Pixel>& pixels, const FormedImage& image) {
  return {pixels.data(), image.width, image.height, image.width};
}

FormedImage marks_with_a_wide_stripe() {
  FormedStripe s;
  s.width = 320;
  s.height = 240;
  s.middle_px = 100;
  s.beam_sigma_px = 5;
  s.peak_grey = 120;
  s.ambient_grey = 90;
  s.bars.angle_rad = 0.7;
  s.speckle = 0.18;
  return form(s);
}

TEST(ExposureGain, IsFoundWithinTwoPerCent) {
  const FormedImage image = marks_with_a_wide_stripe();
  const std::vector<std::uint8_t> on = exposed<std::uint8_t>(image.on, 1, 255);
  for (const double gain : {0.4, 0.93, 1.0, 1.07, 1.5, 2.57}) {
    const std::vector<std::uint8_t> off = exposed<std::uint8_t>(image.off, 1 / gain, 255);
    EXPECT_NEAR(gain_between(view(on, image), view(off, image), 255), gain, 0.02 * gain);
  }
}

TEST(ExposureGain, OfSixteenBitsIsTheSame) {
  const FormedImage image = marks_with_a_wide_stripe();
  const std::vector<std::uint16_t> on = exposed<std::uint16_t>(image.on, 16, 4095), off = exposed<std::uint16_t>(image.off, 16 / 1.3, 4095);
  EXPECT_NEAR(gain_between(view(on, image), view(off, image), 4095), 1.3, 0.02);
}

TEST(ExposureGain, IsOneWhereNothingTells) {
  const FormedImage image = marks_with_a_wide_stripe();
  const std::vector<std::uint8_t> dark(image.on.size(), 3), white(image.on.size(), 255), on = exposed<std::uint8_t>(image.on, 1, 255);
  EXPECT_EQ(gain_between(view(dark, image), view(dark, image), 255), 1.0f);
  EXPECT_EQ(gain_between(view(on, image), view(white, image), 255), 1.0f);
  EXPECT_EQ(gain_between(view(on, image), PixelView<std::uint8_t>(), 255), 1.0f);
  EXPECT_EQ(gain_between(view(on, image), PixelView<std::uint8_t>(on.data(), 64, 64, 64), 255), 1.0f);
}

}  // namespace
}  // namespace lf::scan
