// The widths that the pictures tell, against those that the pictures were formed with.
#include "firmware/scan/optics_estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/scan/stripe_windows.hpp"

namespace lf::scan {
namespace {

using test::form;
using test::FormedImage;
using test::FormedStripe;

// Half of the rows that are brighter than half the peak, of the middle one of the columns, as a Gaussian's standard deviation: where an estimate may begin.
double width_at_half_height_px(const FormedImage& image) {
  std::vector<double> rows;
  for (int u = 0; u < image.width; ++u) {
    const auto middle = static_cast<int>(std::lround(image.centre_px[static_cast<std::size_t>(u)]));
    int first = middle, last = middle;
    while (first > 0 && image.stripe(u, first - 1) > 0.5 * image.stripe(u, middle)) --first;
    while (last + 1 < image.height && image.stripe(u, last + 1) > 0.5 * image.stripe(u, middle)) ++last;
    rows.push_back(last - first + 1);
  }
  std::nth_element(rows.begin(), rows.begin() + image.width / 2, rows.end());
  return rows[static_cast<std::size_t>(image.width / 2)] / 2.355;
}

StripeOptics first_guess(const FormedImage& image) {
  const double width = width_at_half_height_px(image), lens = 0.8;
  return {static_cast<float>(std::sqrt(std::max(0.1, width * width - lens * lens - 1.0 / 12))), static_cast<float>(lens)};
}

// Eight blocks of eight columns of each picture, from starts that err by up to 0.6 px. Returns the steps that it took until one was below 2 %.
int estimate(const FormedStripe& s, const FormedImage& image, OpticsEstimate& estimate) {
  constexpr int most_steps = 8;
  for (int step = 1; step <= most_steps; ++step) {
    for (int block = 0; block < 8; ++block) {
      StripeWindows windows;
      for (int lane = 0; lane < lane_count; ++lane) {
        const int u = 12 + 17 * block + lane;
        const double error = 0.3 * (lane * 7 % 5 - 2);
        put(image, s, estimate.optics(), u, image.centre_px[static_cast<std::size_t>(u)] + error, lane, windows);
      }
      estimate.add(windows, noise_of(s), fit_stripes(windows, estimate.optics(), noise_of(s), FitStart::far));
    }
    if (estimate.update() < 0.02f) return step;
  }
  return most_steps + 1;
}

FormedStripe at_marks(double beam_px, double lens_px) {
  FormedStripe s;
  s.beam_sigma_px = beam_px;
  s.lens_sigma_px = lens_px;
  s.speckle = 0.18;
  s.bars.angle_rad = 0.6;
  s.bars.phase_px = 3.3;
  s.seed = 5;
  return s;
}

TEST(OpticsEstimate, FindsTheStripesWidthAndTheLensAtMarks) {
  for (const double beam : {0.8, 1.6, 3.5, 5.0}) {
    for (const double lens : {0.6, 1.0, 1.5}) {
      const FormedStripe s = at_marks(beam, lens);
      const FormedImage image = form(s);
      OpticsEstimate found(first_guess(image));
      EXPECT_LE(estimate(s, image, found), 6) << "beam " << beam << " px, lens " << lens << " px";
      const float width = width_in_picture_px(optics_of(s));
      EXPECT_NEAR(width_in_picture_px(found.optics()), width, 0.04 * width) << "beam " << beam << " px, lens " << lens << " px";
      // A narrow beam's own width hides a lens that is narrower still.
      EXPECT_NEAR(found.optics().lens_px, lens, beam < 1 && lens < 1 ? 0.3 : 0.15 * lens)
          << "beam " << beam << " px, lens " << lens << " px";
    }
  }
}

TEST(OpticsEstimate, PlainPaintTellsTheWidthAndNothingOfTheLens) {
  for (const double beam : {0.8, 1.6, 3.5, 5.0}) {
    FormedStripe s = at_marks(beam, 1.0);
    s.bars.contrast = 1;
    const FormedImage image = form(s);
    OpticsEstimate found(first_guess(image));
    const float told = found.optics().lens_px;
    EXPECT_LE(estimate(s, image, found), 6) << "beam " << beam << " px";
    const float width = width_in_picture_px(optics_of(s));
    EXPECT_NEAR(width_in_picture_px(found.optics()), width, 0.04 * width) << "beam " << beam << " px";
    EXPECT_NEAR(found.optics().lens_px, told, 0.1f * told) << "beam " << beam << " px";
  }
}

TEST(OpticsEstimate, StaysWhereNothingIsTold) {
  OpticsEstimate found(StripeOptics{1.7f, 0.9f});
  EXPECT_EQ(found.update(), 0.0f);
  StripeWindows dark;
  dark.count = 20;
  for (auto& row : dark.paint) row = all_lanes(1);
  found.add(dark, PixelNoise{}, fit_stripes(dark, found.optics(), PixelNoise{}, FitStart::far));
  EXPECT_EQ(found.update(), 0.0f);
  EXPECT_EQ(found.optics().beam_px, 1.7f);
  EXPECT_EQ(found.optics().lens_px, 0.9f);
}

}  // namespace
}  // namespace lf::scan
