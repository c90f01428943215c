// The fit on pictures that a camera forms (formed_stripe.hpp), beside the bound that noise sets.
#include "firmware/scan/stripe_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/unit/scan/stripe_windows.hpp"

namespace lf::scan {
namespace {

using test::bound_px;
using test::form;
using test::FormedImage;
using test::FormedStripe;
using test::noise_of;
using test::optics_of;
using test::over_edges;
using test::PairHaze;
using test::put;
using test::width_px;

struct Errors {
  std::vector<double> px;    // fitted less true row
  std::vector<double> over;  // the same over the standard deviation that the fit gives
  int lost = 0;

  static double rms(const std::vector<double>& values) {
    double squares = 0;
    for (const double value : values) squares += value * value;
    return std::sqrt(squares / static_cast<double>(values.size()));
  }
  double rms_px() const { return rms(px); }
  double percentile_px(double share) const {
    std::vector<double> sizes;
    for (const double error : px) sizes.push_back(std::abs(error));
    std::sort(sizes.begin(), sizes.end());
    return sizes[static_cast<std::size_t>(share * static_cast<double>(sizes.size() - 1))];
  }
};

// Eight columns at a time, from starts that err by up to `start_error_px`, alternately to either side.
void fit_columns(const FormedStripe& s, const FormedImage& image, const std::vector<int>& columns, double start_error_px, FitStart start,
                 Errors& errors) {
  const PairHaze haze(image);
  for (std::size_t c = 0; c < columns.size(); c += lane_count) {
    StripeWindows windows;
    std::array<int, lane_count> first{};
    for (int lane = 0; lane < lane_count; ++lane) {
      const int u = columns[std::min(c + static_cast<std::size_t>(lane), columns.size() - 1)];
      const double error = start_error_px * (lane % 2 == 0 ? 1 : -1);
      first[static_cast<std::size_t>(lane)] = put(image, s, optics_of(s), u, image.centre_px[static_cast<std::size_t>(u)] + error, lane,
                                                  windows, s.scatter_to_camera > 0 ? &haze : nullptr);
    }
    const StripeFits fits = fit_stripes(windows, optics_of(s), noise_of(s), start);
    for (int lane = 0; lane < lane_count && c + static_cast<std::size_t>(lane) < columns.size(); ++lane) {
      if (!fits.found[lane]) {
        ++errors.lost;
        continue;
      }
      const double truth = image.centre_px[static_cast<std::size_t>(columns[c + static_cast<std::size_t>(lane)])];
      errors.px.push_back(first[static_cast<std::size_t>(lane)] + fits.centre[lane] - truth);
      errors.over.push_back(errors.px.back() / std::sqrt(fits.variance_px2[lane]));
    }
  }
}

// Edges at four angles.
Errors at_edges(const FormedStripe& stripe, double start_error_px = 0) {
  Errors errors;
  over_edges(stripe, 30, [&](const FormedStripe& s, const FormedImage& image, const std::vector<int>& columns) {
    fit_columns(s, image, columns, start_error_px, FitStart::far, errors);
  });
  return errors;
}

Errors on_plain_paint(FormedStripe s, double start_error_px, FitStart start) {
  s.bars.contrast = 1;
  Errors errors;
  for (s.seed = 1; s.seed <= 3; ++s.seed) {
    const FormedImage image = form(s);
    std::vector<int> columns;
    for (int u = 0; u < image.width; ++u) columns.push_back(u);
    fit_columns(s, image, columns, start_error_px, start, errors);
  }
  return errors;
}

TEST(StripeFit, OnPlainPaintItReachesTheBound) {
  for (const double beam : {0.8, 1.2, 1.6, 2.4, 3.5, 5.0}) {
    for (const double speckle : {0.0, 0.18}) {
      FormedStripe s;
      s.beam_sigma_px = beam;
      s.speckle = speckle;
      s.peak_grey = 110;  // none clipped
      const Errors errors = on_plain_paint(s, 0.2, FitStart::near);
      EXPECT_EQ(errors.lost, 0);
      EXPECT_LT(errors.rms_px(), 1.25 * bound_px(s)) << "beam " << beam << " px, speckle " << speckle;
      // Nobody is better than the bound: then it would be wrong.
      EXPECT_GT(errors.rms_px(), 0.75 * bound_px(s)) << "beam " << beam << " px, speckle " << speckle;
    }
  }
}

// Asked for: 0.20 px rms over edges of 10:1, 1 px at the 99.9th percentile.
TEST(StripeFit, AtEdgesItErrsByAFifthOfAPixel) {
  for (const double beam : {1.2, 1.6, 2.4}) {
    for (const double speckle : {0.0, 0.18}) {
      FormedStripe s;
      s.beam_sigma_px = beam;
      s.speckle = speckle;
      const Errors errors = at_edges(s);
      EXPECT_EQ(errors.lost, 0);
      EXPECT_LT(errors.rms_px(), 0.20) << "beam " << beam << " px, speckle " << speckle;
      EXPECT_LT(errors.percentile_px(0.999), 1.0) << "beam " << beam << " px, speckle " << speckle;
    }
  }
}

// Asked for: 0.25 px with 0.35 of the light scattered, and speckle.
TEST(StripeFit, AtEdgesInHazeItErrsByAQuarterOfAPixel) {
  for (const double beam : {1.2, 1.6, 2.4}) {
    FormedStripe s;
    s.beam_sigma_px = beam;
    s.speckle = 0.18;
    s.scatter_to_camera = 0.35;
    const Errors errors = at_edges(s);
    EXPECT_EQ(errors.lost, 0);
    EXPECT_LT(errors.rms_px(), 0.25) << "beam " << beam << " px";
    EXPECT_LT(errors.percentile_px(0.999), 1.0) << "beam " << beam << " px";
  }
}

// Without noise, what is left is the model's own error: the blur is not quite the second-order form that Tweedie's formula has at an edge.
TEST(StripeFit, AtEdgesItHasHardlyABias) {
  FormedStripe s;
  s.beam_sigma_px = 1.2;
  s.noise = false;
  EXPECT_LT(at_edges(s).rms_px(), 0.07);
}

// A stripe on a picture that took its blur for none errs three times as much: the shift is what the fit is for.
TEST(StripeFit, WithoutTheLensItsBiasIsThatOfAProduct) {
  FormedStripe s;
  s.beam_sigma_px = 1.2;
  s.noise = false;
  const double sharp = at_edges(s).rms_px();
  Errors errors;
  const FormedImage image = [&] {
    s.bars.angle_rad = 0.5;
    return form(s);
  }();
  std::vector<int> columns;
  for (int u = 12; u < image.width - 12; ++u) {
    if (image.to_edge_px[static_cast<std::size_t>(u)] <= 4) columns.push_back(u);
  }
  FormedStripe lensless = s;
  lensless.beam_sigma_px = std::sqrt(s.beam_sigma_px * s.beam_sigma_px + s.lens_sigma_px * s.lens_sigma_px);
  lensless.lens_sigma_px = 0;
  fit_columns(lensless, image, columns, 0, FitStart::far, errors);
  EXPECT_GT(errors.rms_px(), 3 * sharp);
}

TEST(StripeFit, FindsTheStripeFromTwoWidthsAway) {
  for (const double beam : {1.2, 2.4}) {
    FormedStripe s;
    s.beam_sigma_px = beam;
    const Errors near = at_edges(s), far = at_edges(s, 1.5 * width_px(s));
    EXPECT_LE(far.lost, static_cast<int>(far.px.size()) / 200) << "beam " << beam;
    EXPECT_LT(far.rms_px(), 1.1 * near.rms_px()) << "beam " << beam;
  }
}

TEST(StripeFit, KnowsItsOwnError) {
  for (const double speckle : {0.0, 0.18}) {
    FormedStripe s;
    s.speckle = speckle;
    EXPECT_NEAR(Errors::rms(on_plain_paint(s, 0, FitStart::near).over), 1.0, 0.1) << "speckle " << speckle;
    EXPECT_NEAR(Errors::rms(at_edges(s).over), 1.0, 0.15) << "speckle " << speckle;
  }
}

TEST(StripeFit, AClippedStripeIsMeasuredByItsFlanks) {
  FormedStripe s;
  s.beam_sigma_px = 2.4;
  s.peak_grey = 500;
  const Errors errors = on_plain_paint(s, 0.3, FitStart::near);
  EXPECT_EQ(errors.lost, 0);
  EXPECT_LT(errors.rms_px(), 0.06);
}

TEST(StripeFit, ALaneDoesNotKnowItsNeighbours) {
  FormedStripe s;
  const FormedImage image = form(s);
  StripeWindows together;
  for (int lane = 0; lane < lane_count; ++lane)
    put(image, s, optics_of(s), 20 + 7 * lane, image.centre_px[static_cast<std::size_t>(20 + 7 * lane)], lane, together);
  const StripeFits all = fit_stripes(together, optics_of(s), noise_of(s), FitStart::far);
  for (int lane = 0; lane < lane_count; ++lane) {
    StripeWindows alone;
    put(image, s, optics_of(s), 20 + 7 * lane, image.centre_px[static_cast<std::size_t>(20 + 7 * lane)], lane, alone);
    const StripeFits one = fit_stripes(alone, optics_of(s), noise_of(s), FitStart::far);
    ASSERT_NE(one.found[lane], 0);
    EXPECT_EQ(one.centre[lane], all.centre[lane]);
    EXPECT_EQ(one.found[(lane + 1) % lane_count], 0) << "nothing is found where there is nothing";
  }
}

TEST(StripeFit, GivesNothingWhereThereIsTooLittle) {
  FormedStripe s;
  const FormedImage image = form(s);
  StripeWindows windows;
  for (int lane = 0; lane < lane_count; ++lane) put(image, s, optics_of(s), 40, image.centre_px[40], lane, windows);
  for (int i = 7; i < windows.count; ++i) windows.valid[static_cast<std::size_t>(i)][0] = 0;
  for (int i = 0; i < windows.count; ++i) windows.stripe[static_cast<std::size_t>(i)][1] = -20;
  windows.start[2] += 30;
  const StripeFits fits = fit_stripes(windows, optics_of(s), noise_of(s), FitStart::far);
  EXPECT_EQ(fits.found[0], 0) << "seven pixels";
  EXPECT_EQ(fits.found[1], 0) << "darker than without the laser";
  EXPECT_EQ(fits.found[2], 0) << "a start outside the window";
  EXPECT_NE(fits.found[3], 0);
  windows.count = 0;
  EXPECT_EQ(fit_stripes(windows, optics_of(s), noise_of(s), FitStart::far).found[3], 0);
  windows.count = StripeWindows::most_rows + 1;
  EXPECT_EQ(fit_stripes(windows, optics_of(s), noise_of(s), FitStart::far).found[3], 0);
}

}  // namespace
}  // namespace lf::scan
