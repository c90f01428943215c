// Detector and refiner together, on pictures that a camera forms: nothing is told of the stripe, the lens, the water or the exposures.
#include "firmware/scan/peak_refiner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "tests/unit/scan/formed_stripe.hpp"
#include "tests/unit/scan/refined_pictures.hpp"

namespace lf::scan {
namespace {

using test::coarse;
using test::compare;
using test::Errors;
using test::form;
using test::FormedImage;
using test::FormedStripe;
using test::height;
using test::over_angles;
using test::pixels;
using test::scene;
using test::turned;
using test::width;
using test::width_px;

// Six sigmas of the difference's noise, speckled. What looked like marks in plain columns' noise was taken for a lens of 2 px and more, and the centres erred by 0.755 px.
TEST(PeakRefiner, AFaintPairTellsNothingOfTheLens) {
  for (const double beam : {0.8, 1.6}) {
    FormedStripe s = scene(beam);
    s.bars.contrast = 1;
    const double read = s.read_noise_grey * s.read_noise_grey + 1.0 / 12;
    s.peak_grey = 6 * std::sqrt(2 * read + 2 * s.ambient_grey / s.electrons_per_grey) * width_px(s) / s.beam_sigma_px;
    const auto refiner = std::make_unique<PeakRefiner>();
    const float told = refiner->optics().lens_px;
    Errors errors;
    for (s.seed = 1; s.seed <= 6; ++s.seed) {
      const FormedImage image = form(s);
      const auto on = pixels<std::uint8_t>(image.on), off = pixels<std::uint8_t>(image.off);
      std::vector<Peak> peaks = coarse(on, off, 255);
      peaks.resize(refiner->refine({on.data(), width, height, width}, {off.data(), width, height, width}, peaks));
      compare(s, image, peaks, errors);
    }
    EXPECT_EQ(refiner->optics().lens_px, told) << "beam " << beam << " px, seeds 1 to 6";
    const double over_bound = Errors::rms(errors.elsewhere) / test::bound_px(s, true);
    std::printf("faint, beam %.1f px: %.3f px, %.2f of the bound, %zu of %d columns\n", beam, Errors::rms(errors.elsewhere), over_bound,
                errors.elsewhere.size(), errors.columns);
    EXPECT_LT(over_bound, 1.25);
    EXPECT_GE(static_cast<double>(errors.elsewhere.size()), 0.97 * errors.columns);
    EXPECT_LE(errors.far, 0.002 * errors.columns);
  }
}

TEST(PeakRefiner, BegunAnewItIsAsNew) {
  FormedStripe wide = scene(5.0), s = scene(1.2);
  wide.speckle = 0.4;
  const auto used = std::make_unique<PeakRefiner>(), fresh = std::make_unique<PeakRefiner>();
  (void)over_angles(wide, *used);
  used->begin_anew();
  EXPECT_FALSE(used->begun());
  EXPECT_EQ(used->noise().speckle, fresh->noise().speckle);
  (void)over_angles(s, *used);
  (void)over_angles(s, *fresh);
  EXPECT_EQ(width_in_picture_px(used->optics()), width_in_picture_px(fresh->optics()));
  EXPECT_EQ(used->optics().lens_px, fresh->optics().lens_px);
  EXPECT_EQ(used->noise().model, fresh->noise().model);
  EXPECT_TRUE(used->begun());
}

// The first pictures of a sweep show a few columns of the hand's edge, out of focus. A lens of 2.5 px that they told held for the panel's first hundred pictures.
class AFewColumns : public testing::TestWithParam<double> {};  // the scatter

// On plain paint, which tells nothing of the haze to who does not look for it.
TEST_P(AFewColumns, TellNothingOfTheNextPicture) {
  FormedStripe edge = scene(2.0), s = scene(1.2);
  edge.lens_sigma_px = 3.0;
  edge.bars.contrast = 1;
  s.scatter_to_camera = GetParam();
  const auto used = std::make_unique<PeakRefiner>(), fresh = std::make_unique<PeakRefiner>();
  for (edge.seed = 1; edge.seed <= 4; ++edge.seed) {
    const FormedImage image = form(edge);
    const auto on = pixels<std::uint8_t>(image.on), off = pixels<std::uint8_t>(image.off);
    std::vector<Peak> peaks = coarse(on, off, 255);
    peaks.resize(40);
    (void)used->refine({on.data(), width, height, width}, {off.data(), width, height, width}, peaks);
  }
  ASSERT_GT(width_in_picture_px(used->optics()), 1.5 * width_px(s));
  (void)over_angles(s, *used);
  (void)over_angles(s, *fresh);
  EXPECT_EQ(width_in_picture_px(used->optics()), width_in_picture_px(fresh->optics()));
  EXPECT_EQ(used->optics().lens_px, fresh->optics().lens_px);
  EXPECT_EQ(used->optics().scatter, fresh->optics().scatter);
  EXPECT_EQ(used->noise().model, fresh->noise().model);
}

INSTANTIATE_TEST_SUITE_P(InClearAndTurbidWater, AFewColumns, testing::Values(0.0, 0.35));

// Asked for: 0.07 px. The window's ends, where the stripe had not ended, bent it by 0.08 px.
TEST(PeakRefiner, WithoutNoiseAPictureAloneHasNoBias) {
  for (const double beam : {0.8, 1.2, 1.6, 2.4, 3.5, 5.0}) {
    FormedStripe s = scene(beam);
    s.bars.contrast = 1;
    s.noise = false;
    s.peak_grey = 130;
    const FormedImage image = form(s);
    const auto on = pixels<std::uint8_t>(image.on);
    std::vector<Peak> peaks = coarse<std::uint8_t>(on, {}, 255);
    const auto refiner = std::make_unique<PeakRefiner>();
    peaks.resize(refiner->refine({on.data(), width, height, width}, {}, peaks));
    ASSERT_GE(peaks.size(), 300U);
    double worst = 0;
    for (const Peak& peak : peaks)
      worst = std::max(worst, std::abs(peak.v_px - image.centre_px[static_cast<std::size_t>(std::lround(peak.u_px))]));
    std::printf("beam %.1f px: at most %.4f px\n", beam, worst);
    EXPECT_LE(worst, 0.07) << "beam " << beam << " px";
  }
}

TEST(PeakRefiner, BearsABackgroundOfAnotherExposure) {
  const FormedStripe s = scene(1.6);
  for (const double gain : {0.7, 1.07, 1.6}) {
    const auto refiner = std::make_unique<PeakRefiner>();
    const Errors errors = over_angles(s, *refiner, gain);
    EXPECT_NEAR(refiner->gain(), gain, 0.02 * gain);
    EXPECT_GE(static_cast<double>(errors.at_edges.size() + errors.elsewhere.size()), 0.97 * errors.columns) << "gain " << gain;
    EXPECT_LT(Errors::rms(errors.at_edges), 0.24) << "gain " << gain;
    EXPECT_LT(Errors::rms(errors.elsewhere), 0.26) << "gain " << gain << ": most of it on dark paint";
  }
}

// The same picture on its side, its levels sixteenfold in twelve bits.
TEST(PeakRefiner, RowsAndDepthsAreAllOne) {
  FormedStripe s = scene(1.6);
  s.bars.angle_rad = 0.5;
  s.bits = 12;  // clipped by `pixels`, at the full scale that the refiner is told
  const FormedImage image = form(s);
  const auto on = pixels<std::uint16_t>(image.on, 16, 4095), off = pixels<std::uint16_t>(image.off, 16, 4095);
  std::vector<Peak> columns = coarse(on, off, 4095), rows = columns;
  for (Peak& peak : rows) std::swap(peak.u_px, peak.v_px);
  RefinerConfig config;
  config.full_scale = 4095;
  const auto upright = std::make_unique<LargePeakRefiner16>(config);
  config.axis = PeakAxis::row;
  const auto on_its_side = std::make_unique<LargePeakRefiner16>(config);
  columns.resize(upright->refine({on.data(), width, height, width}, {off.data(), width, height, width}, columns));
  const auto on_turned = turned(on), off_turned = turned(off);
  rows.resize(on_its_side->refine({on_turned.data(), height, width, height}, {off_turned.data(), height, width, height}, rows));
  ASSERT_EQ(columns.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(columns[i].u_px, rows[i].v_px);
    EXPECT_NEAR(columns[i].v_px, rows[i].u_px, 0.05) << "what is learned sums in another order";
  }
  Errors errors;
  compare(s, image, columns, errors);
  EXPECT_LT(Errors::rms(errors.at_edges), 0.24);
}

// On plain paint a picture by itself is enough, clipped or not.
TEST(PeakRefiner, OnePictureIsEnoughOnPlainPaint) {
  for (const double ambient : {40.0, 110.0}) {
    FormedStripe s = scene(1.6);
    s.bars.contrast = 1;
    s.ambient_grey = ambient;
    const FormedImage image = form(s);
    const auto on = pixels<std::uint8_t>(image.on);
    std::vector<Peak> peaks = coarse<std::uint8_t>(on, {}, 255);
    const auto refiner = std::make_unique<PeakRefiner>();
    peaks.resize(refiner->refine({on.data(), width, height, width}, {}, peaks));
    Errors errors;
    compare(s, image, peaks, errors);
    EXPECT_GE(static_cast<int>(errors.elsewhere.size()), 0.99 * width) << "ambient light " << ambient;
    EXPECT_LT(Errors::rms(errors.elsewhere), 0.20) << "ambient light " << ambient;
  }
}

TEST(PeakRefiner, RefusesWhatItCannotTake) {
  const auto refiner = std::make_unique<PeakRefiner>();
  const std::vector<std::uint8_t> grey(static_cast<std::size_t>(width * height), 50), large(static_cast<std::size_t>(641 * 100), 50);
  std::array<Peak, 3> peaks{};
  const PixelView<std::uint8_t> sound(grey.data(), width, height, width);
  EXPECT_EQ(refiner->refine({}, {}, peaks), 0u);
  EXPECT_EQ(refiner->refine({large.data(), 641, 100, 641}, {}, peaks), 0u);
  EXPECT_EQ(refiner->refine(sound, {grey.data(), width, height - 1, width}, peaks), 0u);
  EXPECT_EQ(refiner->refine(sound, sound, {}), 0u);
  EXPECT_EQ(refiner->counters().not_fitted, 0u);
  // Peaks where there is none, at the corners and outside.
  peaks = {Peak{0, 0}, Peak{319, 191}, Peak{4000, 500}};
  EXPECT_EQ(refiner->refine(sound, sound, peaks), 0u);
  EXPECT_EQ(refiner->counters().not_fitted + refiner->counters().misfits, 3u);
}

}  // namespace
}  // namespace lf::scan
