// The ridge detector of the comparison is what its paper says: on a plain line of any direction to a hundredth of a pixel, and drawn to the light side of a step.
#include "tests/unit/scan/ridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lf::test {
namespace {

FormedStripe without_noise(double beam_px, double slope) {
  FormedStripe s;
  s.noise = false;
  s.beam_sigma_px = beam_px;
  s.slope = slope;
  s.middle_px = slope > 0.5 ? 20.37 : 40.37;
  s.width = 64;
  s.bars.contrast = 1;
  return s;
}

// The Taylor series of second order about the pixel's middle overshoots: of a bell of variance S, seen from a distance d, it says d / (1 - d^2 / S). That is the method's, and below 0.01 px where
// the line passes within 0.3 px of a pixel's middle.
TEST(Ridge, LiesOnAPlainStripeUpToItsTaylorSeries) {
  for (const double beam : {0.8, 1.6, 3.5}) {
    for (const double slope : {0.0, 0.1, 0.6}) {
      const FormedStripe s = without_noise(beam, slope);
      const FormedImage image = form(s);
      const double sigma = ridge_sigma_px(width_px(s)), cosine = 1 / std::hypot(1, slope);
      const double variance = std::pow(beam * cosine, 2) + std::pow(s.lens_sigma_px, 2) + 1.0 / 12 + sigma * sigma;  // along the normal
      const std::vector<double> rows = ridge_rows(image, sigma);
      for (std::size_t u = 16; u < 48; ++u) {
        const double below = image.centre_px[u] - std::round(image.centre_px[u]), d = below * cosine;
        const double overshoot = d / (1 - d * d / variance) / cosine - below;
        EXPECT_NEAR(rows[u], image.centre_px[u] + overshoot, 0.003) << "beam " << beam << ", slope " << slope;
        if (std::abs(below) < 0.3) {
          EXPECT_NEAR(rows[u], image.centre_px[u], 0.01) << "beam " << beam << ", slope " << slope;
        }
      }
    }
  }
}

// The paper's own subject: the smoothed profile's maximum moves to the light side. Here that is a closed form of one dimension. A beam of sigma b on paint of 1 up to
// the edge and 0.1 beyond, seen through Gaussians of variance p (lens, pixel) and s (the detector's): the density of a cut Gaussian, convolved; its maximum by a search.
TEST(Ridge, ErrsAtAStepAsItsSmoothedProfileDoes) {
  for (const double edge_px : {46.0, 48.0, 49.0}) {
    FormedStripe s = without_noise(1.6, 0);
    s.middle_px = 48.37;
    s.bars = {.phase_px = edge_px, .contrast = 10, .single_edge = true};
    const double sigma = ridge_sigma_px(width_px(s)), b2 = s.beam_sigma_px * s.beam_sigma_px;
    const double p2 = s.lens_sigma_px * s.lens_sigma_px + 1.0 / 12 + sigma * sigma;
    // Of the product of two bells at x, the share before the edge: a bell of variance b2 p2 / (b2 + p2).
    const auto profile = [&](double x) {
      const double centre = (s.middle_px * p2 + x * b2) / (b2 + p2), deviation = std::sqrt(b2 * p2 / (b2 + p2));
      const double light = 0.5 * (1 + std::erf((edge_px - centre) / (deviation * std::sqrt(2.0))));
      return (0.1 + 0.9 * light) * std::exp(-0.5 * (x - s.middle_px) * (x - s.middle_px) / (b2 + p2));
    };
    double highest = 0;
    for (double x = 40; x < 56; x += 0.001) {
      if (profile(x) > profile(highest)) highest = x;
    }
    const double bias = ridge_rows(form(s), sigma)[32] - s.middle_px;
    EXPECT_NEAR(bias, highest - s.middle_px, 0.04) << "edge at " << edge_px;  // the Taylor series' second order, over half a pixel
    EXPECT_LT(bias, -0.3) << "edge at " << edge_px;
  }
}

}  // namespace
}  // namespace lf::test
