#include "host_sim/app/peak_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lf::app {
namespace {

using Peaks = std::vector<Eigen::Vector2f>;

optics::Frame frame_of(std::int32_t width, std::int32_t height, std::vector<optics::StripePiece> pieces) {
  optics::Frame frame;
  frame.width = width;
  frame.height = height;
  frame.pieces = std::move(pieces);
  return frame;
}

TEST(PeakScore, HoldsPeaksAgainstTheRenderedStripe) {
  // The last is too faint to count.
  const StripeTruth truth = stripe_truth(frame_of(4, 100, {{0, 0, 50, 100}, {0, 1, 51, 100}, {0, 3, 53, 3}}));
  PeakScore score;
  score.add(truth, Peaks{{0, 50.3f}, {1, 80.0f}, {2, 10.0f}});
  EXPECT_EQ(score.visible(), 2u);
  EXPECT_NEAR(score.recall(), 0.5, 1e-12) << "29 px off is another thing";
  EXPECT_NEAR(score.rms_px(), 0.3, 1e-6);
  EXPECT_EQ(score.false_peaks(), 2u);
  EXPECT_NEAR(score.false_share(), 2.0 / 3, 1e-12);
}

// A column with a bright piece on a button and a faint one on the panel; beside it none, but a lens's light of the bright one.
TEST(PeakScore, APeakOnAnotherPieceIsNeitherFalseNorTheOneThatCounts) {
  const StripeTruth truth = stripe_truth(frame_of(8, 100, {{0, 3, 40, 100}, {0, 3, 60, 30}}));
  PeakScore other, both, beside;
  other.add(truth, Peaks{{3, 60.2f}});
  EXPECT_EQ(other.recall(), 0);
  EXPECT_EQ(other.elsewhere_share(), 1);
  EXPECT_EQ(other.false_peaks(), 0u);
  EXPECT_NEAR(other.rms_px(), 0.2, 1e-5);
  both.add(truth, Peaks{{3, 40.1f}, {3, 60.2f}, {3, 80}});
  EXPECT_EQ(both.recall(), 1);
  EXPECT_EQ(both.elsewhere_share(), 0);
  EXPECT_EQ(both.false_peaks(), 1u);
  beside.add(truth, Peaks{{5, 40.5f}, {6, 40.5f}});
  EXPECT_EQ(beside.false_peaks(), 1u) << "three columns off no light of it is left";
  EXPECT_EQ(beside.recall(), 0);
}

// A lens's light from beside excuses nothing where the column has a stripe of its own.
TEST(PeakScore, ASteepStripesNeighboursExcuseNoWrongPick) {
  const StripeTruth truth = stripe_truth(frame_of(8, 100, {{0, 3, 40, 100}, {0, 5, 43.4f, 100}}));
  PeakScore score;
  score.add(truth, Peaks{{3, 44}});
  EXPECT_EQ(score.false_peaks(), 1u);
}

TEST(PeakScore, WhatLiesOnTheArmIsNotLookedFor) {
  optics::Frame frame = frame_of(2, 100, {{0, 0, 40, 100}, {0, 1, 40, 100}, {0, 1, 70, 200}});
  frame.object.assign(200, 9);
  frame.object[70 * 2 + 1] = 4;
  const StripeTruth truth = stripe_truth(frame, [](std::uint16_t object) { return object > 7; });
  PeakScore score;
  score.add(truth, Peaks{{0, 40}, {1, 40}});
  EXPECT_EQ(score.recall(), 1);
  EXPECT_EQ(score.false_peaks(), 0u);
  score.add(truth, Peaks{{0, 40}, {1, 70}});
  EXPECT_EQ(score.false_peaks(), 1u);
  EXPECT_EQ(score.recall(), 0.75);
}

// The plate ends at row 60: the flank's middle lies one pixel beyond it, where there is nothing, and farther down on the arm.
TEST(PeakScore, AFlankAtThePlatesEdgeIsOfThePlate) {
  optics::StripePiece part{0, 0, 61, 100};
  part.part = true;
  optics::Frame frame = frame_of(1, 100, {part, {0, 0, 90, 100}});
  frame.object.assign(100, 0);
  std::fill_n(frame.object.begin(), 61, std::uint16_t{9});
  frame.object[90] = 4;
  const StripeTruth truth = stripe_truth(frame, [](std::uint16_t object) { return object > 7; });
  PeakScore score;
  score.add(truth, Peaks{{0, 61.5f}});
  EXPECT_EQ(score.false_peaks(), 0u);
  score.add(truth, Peaks{{0, 90}});
  EXPECT_EQ(score.false_peaks(), 1u) << "on the arm";
}

// At a border the beam's flank is light of the stripe, without a centre.
TEST(PeakScore, APartOfAStripeIsNoFalsePeakAndNoneThatHasToBeFound) {
  optics::StripePiece part{0, 0, 40, 100};
  part.part = true;
  const StripeTruth truth = stripe_truth(frame_of(2, 100, {part, {0, 1, 50, 100}}));
  PeakScore score;
  score.add(truth, Peaks{{0, 41}, {1, 50.1f}});
  EXPECT_EQ(score.false_peaks(), 0u);
  EXPECT_EQ(score.visible(), 1u);
  EXPECT_NEAR(score.rms_px(), 0.1, 1e-5);
  score.add(truth, Peaks{{0, 43}});
  EXPECT_EQ(score.false_peaks(), 1u) << "3 px off that light";
}

// The light beside a stripe's end, in a column that has a faint flank of another surface: it counted as a false peak.
TEST(PeakScore, AFaintFlankLeavesAPeakToTheBrighterStripeBesideIt) {
  const auto false_peaks = [](float flank_grey, std::int32_t beside_column, float peak_v) {
    optics::StripePiece flank{0, 1, 37, flank_grey};
    flank.part = true;
    PeakScore score;
    score.add(stripe_truth(frame_of(5, 100, {flank, {0, beside_column, 40, 100}})), Peaks{{1, peak_v}});
    EXPECT_EQ(score.found(), 0u);
    return score.false_peaks();
  };
  EXPECT_EQ(false_peaks(4, 3, 42.5f), 1u) << "not at that stripe's height";
  EXPECT_EQ(false_peaks(4, 4, 40.5f), 1u) << "three columns off no light of it is left";
  EXPECT_EQ(false_peaks(4, 3, 40.5f), 0u);
  EXPECT_EQ(false_peaks(6, 3, 40.5f), 1u) << "of the stripe's 100 five are left two columns on";
  EXPECT_EQ(false_peaks(28, 2, 40.5f), 0u);
  EXPECT_EQ(false_peaks(60, 2, 40.5f), 1u) << "the flank is the brighter light";
}

// Two flanks side by side excuse nothing of each other.
TEST(PeakScore, AFlankBesideAFlankIsNoStripe) {
  optics::StripePiece flank{0, 1, 37, 6}, beside{0, 2, 40, 100};
  flank.part = beside.part = true;
  PeakScore score;
  score.add(stripe_truth(frame_of(4, 100, {flank, beside})), Peaks{{1, 40.5f}});
  EXPECT_EQ(score.false_peaks(), 1u);
}

// A part 1.5 px from a centre: a peak between them errs from the centre.
TEST(PeakScore, APartTakesNoPeakFromAWholePiece) {
  optics::StripePiece part{0, 1, 41.5f, 50};
  part.part = true;
  PeakScore score;
  score.add(stripe_truth(frame_of(3, 100, {part, {0, 1, 40, 100}})), Peaks{{1, 41.2f}});
  EXPECT_NEAR(score.rms_px(), 1.2, 1e-5);
  EXPECT_EQ(score.found(), 1u);
}

TEST(PeakScore, PeaksAtAStepOfDepthAreScoredApartFromThoseOnASmoothSurface) {
  optics::Frame frame = frame_of(60, 60, {});
  frame.depth_m.resize(3600);
  // A slope, and beyond column 30 another thing 50 mm nearer.
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 60; ++u)
      frame.depth_m[static_cast<std::size_t>(v * 60 + u)] = 1 + 0.004f * static_cast<float>(v) - (u > 30 ? 0.05f : 0);
  }
  Peaks peaks;
  for (int u = 0; u < 60; ++u) {
    frame.pieces.push_back({0, u, 30, 100});
    peaks.push_back({static_cast<float>(u), u > 25 && u < 36 ? 31.0f : 30.1f});
  }
  PeakScore score;
  score.add(stripe_truth(frame), peaks);
  EXPECT_NEAR(score.smooth_rms_px(), 0.1, 1e-5);
  EXPECT_NEAR(score.rms_px(), std::sqrt((10 * 1.0 + 50 * 0.01) / 60), 1e-5);
}

// The bound is what a matched filter at the true width reaches on drawn stripes: a linearised least-squares fit of the centre with the true height and width known,
// which is efficient where the noise is even.
TEST(PictureNoise, IsWhatAnEfficientEstimateOfTheCentreReaches) {
  constexpr unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  struct Case {
    double height, sigma, background, read, electrons;
  };
  for (const Case& c : {Case{60, 1.6, 40, 1.5, 40}, Case{30, 3.0, 10, 3.0, 0}, Case{120, 1.2, 80, 1.5, 10}}) {
    const PictureNoise noise{c.read, c.electrons, 0};
    TruePiece piece;
    piece.grey = static_cast<float>(c.height), piece.sigma_px = static_cast<float>(c.sigma),
    piece.background = static_cast<float>(c.background);
    double squares = 0;
    constexpr int draws = 4000;
    for (int i = 0; i < draws; ++i) {
      double product = 0, power = 0;
      for (int k = -20; k <= 20; ++k) {
        const double x = k / c.sigma, light = c.height * std::exp(-x * x / 2), slope = light * x / c.sigma;
        const double shot_on = c.electrons > 0 ? (c.background + light) / c.electrons : 0,
                     shot_off = c.electrons > 0 ? c.background / c.electrons : 0;
        const double error = std::sqrt(2 * c.read * c.read + shot_on + shot_off) * normal(random);
        product += error * slope, power += slope * slope;
      }
      squares += product / power * (product / power);
    }
    // The shot noise of the stripe itself is not even; the fit that takes it so loses a few per cent.
    const double seen = squares / draws, bound = noise.centre_variance_px2(piece);
    EXPECT_GT(seen, bound * 0.93) << c.height;
    EXPECT_LT(seen, bound * 1.15) << c.height;
  }
}

// 0.424 C (lambda F / p) sqrt(sigma) for light whose pixel's contrast is C_pix (image-plane simulation of the reference): drawn here as even factors a pixel.
TEST(PictureNoise, OfSpeckleIsThatOfACentroidOfDrawnPixels) {
  constexpr unsigned seed = 12;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const double contrast : {0.1, 0.25}) {
    std::gamma_distribution<double> factor(1 / (contrast * contrast), contrast * contrast);
    for (const double sigma : {1.2, 2.4}) {
      double squares = 0;
      constexpr int draws = 4000;
      for (int i = 0; i < draws; ++i) {
        double sum = 0, moment = 0;
        for (int k = -20; k <= 20; ++k) {
          const double light = std::exp(-k * k / (2 * sigma * sigma)) * factor(random);
          sum += light, moment += k * light;
        }
        squares += moment / sum * (moment / sum);
      }
      TruePiece piece;
      piece.grey = 1e6f, piece.sigma_px = static_cast<float>(sigma);
      EXPECT_NEAR(squares / draws, (PictureNoise{0, 0, contrast}.centre_variance_px2(piece)), 0.12 * squares / draws);
    }
  }
}

// The hand's own stripe a pixel beside the place that the hand shades on the panel.
TEST(PeakScore, APartExcusesNoPeakOnTheHand) {
  for (const bool hand : {false, true}) {
    StripeTruth truth;
    truth.columns.resize(40);
    TruePiece shaded, other;
    shaded.v = 30, shaded.grey = 5, shaded.part = true;
    other.v = 31.2f, other.grey = 80, other.on_another = true;
    for (auto& column : truth.columns) {
      column.push_back(shaded);
      if (hand) column.push_back(other);
    }
    PeakScore score;
    score.add(truth, Peaks{{20, 31.0f}});
    EXPECT_EQ(score.false_peaks(), hand ? 1u : 0u);
  }
}

TEST(PeakScore, TheBoundIsOfPeaksAwayFromMarks) {
  optics::Frame frame = frame_of(40, 60, {});
  frame.depth_m.assign(2400, 1.f);
  Peaks peaks;
  for (int u = 10; u < 30; ++u) {
    const bool marked = u % 2 == 0;
    frame.pieces.push_back({0, u, 30, 50.f, 1.6f, false, marked});
    peaks.push_back({static_cast<float>(u), marked ? 31.f : 30.1f});
  }
  PeakScore score(PictureNoise{1.5, 0, 0});
  score.add(stripe_truth(frame), peaks);
  EXPECT_NEAR(score.clear_rms_px(), 0.1, 1e-5);
  EXPECT_NEAR(score.marks_rms_px(), 1, 1e-5);
  EXPECT_NEAR(score.smooth_rms_px(), std::sqrt((1 + 0.01) / 2), 1e-4);
}

TEST(PeakScore, TheBoundIsOfPeaksThatStandClearOfTheNoise) {
  optics::Frame frame = frame_of(40, 60, {});
  frame.depth_m.assign(2400, 1.f);
  Peaks peaks;
  for (int u = 10; u < 30; ++u) {
    const bool faint = u % 2 == 0;
    frame.pieces.push_back({0, u, 30, faint ? 5.f : 50.f, 1.6f});
    peaks.push_back({static_cast<float>(u), faint ? 31.f : 30.1f});
  }
  const PictureNoise noise{1.5, 0, 0};
  PeakScore score(noise);
  score.add(stripe_truth(frame), peaks);
  EXPECT_NEAR(score.clear_rms_px(), 0.1, 1e-5);
  EXPECT_NEAR(score.clear_bound_px(), std::sqrt(2 * 1.5 * 1.5 * 2 * 1.6 / std::sqrt(pi)) / 50, 1e-6);
  EXPECT_TRUE(std::isnan(PeakScore().clear_bound_px()));
}

}  // namespace
}  // namespace lf::app
