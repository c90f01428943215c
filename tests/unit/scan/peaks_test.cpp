#include "firmware/scan/peaks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "tests/unit/scan/stripe_image.hpp"

namespace lf::scan {
namespace {

struct Score {
  double rms_px = 0, bias_px = 0, recall = 0;
  int wrong = 0;  // more than 3 px off
};

Score score_of(const std::vector<std::pair<int, double>>& found, const std::vector<double>& truth) {
  Score score;
  int good = 0;
  double squares = 0, sum = 0;
  for (const auto& [column, centre] : found) {
    const double error = centre - truth[column];
    if (std::abs(error) > 3) {
      ++score.wrong;
      continue;
    }
    ++good;
    squares += error * error;
    sum += error;
  }
  score.recall = static_cast<double>(good) / static_cast<double>(truth.size());
  score.rms_px = std::sqrt(squares / std::max(1, good));
  score.bias_px = sum / std::max(1, good);
  return score;
}

Score ours(const test::StripeImage& image, bool differencing = true) {
  auto detector = std::make_unique<PeakDetector>();
  std::vector<Peak> peaks(image.width);
  const std::size_t n = detector->detect(image.on_view(), differencing ? image.off_view() : ImageView{}, peaks);
  std::vector<std::pair<int, double>> found;
  for (std::size_t i = 0; i < n; ++i) found.emplace_back(static_cast<int>(peaks[i].u_px), peaks[i].v_px);
  return score_of(found, image.centre_px);
}

// What the field's programs do with OpenCV: difference, blur, brightest row of each column, centre of mass about it.
Score opencv(const test::StripeImage& image) {
  const cv::Mat on(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.on.data()));
  const cv::Mat off(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.off.data()));
  cv::Mat difference, blurred, brightest;
  cv::subtract(on, off, difference);
  cv::GaussianBlur(difference, blurred, {5, 5}, 0);
  cv::reduceArgMax(blurred, brightest, 0);
  std::vector<std::pair<int, double>> found;
  for (int u = 0; u < image.width; ++u) {
    double weight = 0, moment = 0;
    const int row = brightest.at<int>(0, u);
    for (int v = std::max(0, row - 5); v <= std::min(image.height - 1, row + 5); ++v) {
      weight += difference.at<std::uint8_t>(v, u);
      moment += v * static_cast<double>(difference.at<std::uint8_t>(v, u));
    }
    if (weight > 0) found.emplace_back(u, moment / weight);
  }
  return score_of(found, image.centre_px);
}

struct Row {
  const char* name;
  test::StripeModel model;
  double rms_low_px, rms_high_px;  // measured with four seeds, less and plus a fifth and 0.01 px
  double recall;
};

// The stripe's profile against what was measured: an error below its bound would mean that the truth has leaked into the detector.
const Row table[] = {
    {"narrow, clear", {.sigma_px = 0.7}, 0.015, 0.045, 0.999},
    {"clear", {.sigma_px = 1.5}, 0.010, 0.035, 0.999},
    {"wide, clear", {.sigma_px = 2.5}, 0.010, 0.035, 0.999},
    {"clear at the noise of 3", {.sigma_px = 1.2, .amplitude = 120, .noise = 3}, 0.03, 0.10, 0.999},
    {"faint: amplitude 16 times the noise", {.sigma_px = 1.5, .amplitude = 48, .noise = 3}, 0.10, 0.19, 0.999},
    {"very faint: 8 times", {.sigma_px = 1.5, .amplitude = 25, .noise = 3}, 0.20, 0.34, 0.98},
    {"skirt", {.sigma_px = 1.5, .amplitude = 80, .noise = 2, .skirt = 0.3}, 0.03, 0.08, 0.999},
    {"heavy skirt", {.sigma_px = 1.5, .amplitude = 60, .noise = 2, .skirt = 0.8}, 0.05, 0.12, 0.999},
    {"glow that ends at the stripe", {.sigma_px = 1.5, .amplitude = 80, .noise = 2, .step = 0.15}, 0.08, 0.15, 0.999},
    {"clipped twice over", {.sigma_px = 2.0, .amplitude = 450, .noise = 2}, 0.01, 0.06, 0.999},
    {"clipped fourfold", {.sigma_px = 2.0, .amplitude = 1000, .noise = 2}, 0.01, 0.06, 0.999},
    {"clipped fourfold and wide", {.sigma_px = 3.0, .amplitude = 1000, .noise = 2}, 0.01, 0.05, 0.999},
};

TEST(Peaks, ErrorsAreThoseOfTheTable) {
  for (Row row : table) {
    for (std::uint64_t seed : {1u, 2u}) {
      SCOPED_TRACE(testing::Message() << row.name << ", seed " << seed);
      row.model.seed = seed;
      const Score score = ours(make_stripe_image(row.model));
      EXPECT_GT(score.rms_px, row.rms_low_px);
      EXPECT_LT(score.rms_px, row.rms_high_px);
      EXPECT_GE(score.recall, row.recall);
      EXPECT_LE(score.wrong, 2);
    }
  }
}

TEST(Peaks, AreMoreExactThanOpenCvsCentreOfMassOnEveryKindOfStripe) {
  for (Row row : table) {
    if (row.model.amplitude < 40) continue;  // very faint stripes of noise 3: OpenCV finds some of them elsewhere
    SCOPED_TRACE(row.name);
    row.model.seed = 5;
    const test::StripeImage image = make_stripe_image(row.model);
    EXPECT_LT(ours(image).rms_px, opencv(image).rms_px);
  }
}

TEST(Peaks, AreFoundWithoutABackgroundImageOnAnEvenScene) {
  const Score score = ours(test::make_stripe_image({.sigma_px = 1.5, .texture = 0, .seed = 3}), false);
  EXPECT_GE(score.recall, 0.999);
  EXPECT_LT(score.rms_px, 0.03);
}

TEST(Peaks, DifferencingRemovesATextureThatMisleadsTheImageAlone) {
  test::StripeImage image = test::make_stripe_image({.sigma_px = 1.5, .amplitude = 60, .noise = 2, .texture = 28, .seed = 4});
  const Score with = ours(image), without = ours(image, false);
  EXPECT_GE(with.recall, 0.999);
  EXPECT_EQ(with.wrong, 0);
  EXPECT_LT(with.rms_px, 0.5 * without.rms_px);
}

TEST(Peaks, AColumnOfNoiseHasNone) {
  const test::StripeImage image = test::make_stripe_image({.amplitude = 0, .noise = 3, .seed = 6});
  auto detector = std::make_unique<PeakDetector>();
  std::vector<Peak> peaks(image.width);
  EXPECT_LE(detector->detect(image.on_view(), image.off_view(), peaks), 12u);
  EXPECT_GE(detector->counters().weak + detector->counters().ambiguous, 628u);
}

TEST(Peaks, TwoStripesOfLikeHeightAreAmbiguousAndOfUnlikeHeightAreNot) {
  const int width = 64, height = 200;
  for (const auto& [second, found] : {std::pair{100, 0u}, std::pair{40, 64u}}) {
    std::vector<std::uint8_t> image(width * height, 10);
    for (int u = 0; u < width; ++u) {
      for (const auto& [row, grey] : {std::pair{60, 110}, std::pair{140, second + 10}}) {
        image[(row - 1) * width + u] = image[(row + 1) * width + u] = static_cast<std::uint8_t>(grey / 2 + 5);
        image[row * width + u] = static_cast<std::uint8_t>(grey);
      }
    }
    auto detector = std::make_unique<PeakDetector>();
    std::vector<Peak> peaks(width);
    const std::size_t n = detector->detect(ImageView{image.data(), width, height, width}, {}, peaks);
    EXPECT_EQ(n, found);
    EXPECT_EQ(detector->counters().ambiguous, width - found);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(peaks[i].v_px, 60, 1e-4);
      EXPECT_NEAR(peaks[i].amplitude, 100, 1e-4);
      EXPECT_NEAR(peaks[i].ratio, 0.4, 0.02);
    }
  }
}

// A handle before the panel carries its piece of the stripe; both are measured, the stronger first.
TEST(Peaks, TwoPiecesOfAStripeInAColumnAreBothGivenWhenAskedFor) {
  const int width = 64, height = 200;
  std::vector<std::uint8_t> image(width * height, 10);
  for (int u = 0; u < width; ++u) {
    for (const auto& [row, grey] : {std::pair{60, 90}, std::pair{140, 110}}) {
      image[(row - 1) * width + u] = image[(row + 1) * width + u] = static_cast<std::uint8_t>(grey / 2 + 5);
      image[row * width + u] = static_cast<std::uint8_t>(grey);
    }
  }
  auto detector = std::make_unique<PeakDetector>(PeakConfig{.peaks_per_line = 2});
  std::vector<Peak> peaks(width * 2);
  ASSERT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, peaks), 128u);
  for (int u = 0; u < width; ++u) {
    EXPECT_EQ(peaks[2 * u].u_px, static_cast<float>(u));
    EXPECT_NEAR(peaks[2 * u].v_px, 140, 1e-4);
    EXPECT_EQ(peaks[2 * u + 1].u_px, static_cast<float>(u));
    EXPECT_NEAR(peaks[2 * u + 1].v_px, 60, 1e-4);
  }
  EXPECT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, std::span(peaks).first(64)), 0u)
      << "no room for two a column";
  auto four = std::make_unique<PeakDetector>(PeakConfig{.peaks_per_line = 4});
  EXPECT_EQ(four->detect(ImageView{image.data(), width, height, width}, {}, peaks), 0u) << "no room for four";
}

TEST(Peaks, AWidePlateauIsSaturatedNotAStripe) {
  const int width = 64, height = 100;
  std::vector<std::uint8_t> image(width * height, 20);
  std::fill(image.begin() + 40 * width, image.begin() + 60 * width, 255);
  auto detector = std::make_unique<PeakDetector>();
  std::vector<Peak> peaks(width);
  EXPECT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, peaks), 0u);
  EXPECT_EQ(detector->counters().saturated, 64u);
  // Two more of them: none is a stripe's.
  std::fill(image.begin() + 8 * width, image.begin() + 24 * width, 255);
  std::fill(image.begin() + 76 * width, image.begin() + 94 * width, 255);
  EXPECT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, peaks), 0u);
  EXPECT_EQ(detector->counters().saturated, 128u);
}

// A lamp of 20 rows, and a line: what is passed over may be the stripe itself, and a faint line its ghost.
TEST(Peaks, BesideALampALineHasToBeAsStrong) {
  const int width = 64, height = 120;
  for (const auto& [grey, lamp, found] : {std::tuple{36, 255, 0u}, {36, 20, 64u}, {250, 255, 64u}}) {
    std::vector<std::uint8_t> image(width * height, 20);
    std::fill(image.begin() + 20 * width, image.begin() + 40 * width, static_cast<std::uint8_t>(lamp));
    for (int row = 84; row <= 86; ++row) std::fill_n(image.begin() + row * width, width, static_cast<std::uint8_t>(grey));
    auto detector = std::make_unique<PeakDetector>();
    std::vector<Peak> peaks(width);
    EXPECT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, peaks), found) << grey << ", lamp " << lamp;
    EXPECT_EQ(detector->counters().saturated, 64u - found) << grey << ", lamp " << lamp;
  }
}

// A lamp's flanks are steep, whatever window looks at them.
TEST(Peaks, OfAWideStripeAPlateauIsToldFromALampByItsFlanks) {
  const int width = 64, height = 200;
  for (const int rows : {14, 17, 20, 23}) {
    std::vector<std::uint8_t> lamp(width * height, 20), stripe(width * height, 20);
    // A bell that is clipped over as many rows.
    const double sigma = 5.0, middle = 100.3, peak = 235 * std::exp(0.5 * std::pow(rows / (2 * sigma), 2));
    for (int v = 0; v < height; ++v) {
      const double light = 20 + peak * std::exp(-0.5 * std::pow((v - middle) / sigma, 2));
      std::fill_n(stripe.begin() + v * width, width, static_cast<std::uint8_t>(std::min(255.0, std::round(light))));
    }
    std::fill(lamp.begin() + 90 * width, lamp.begin() + (90 + rows) * width, 255);
    auto detector = std::make_unique<PeakDetector>();
    detector->follow(5.0f);
    std::vector<Peak> peaks(width);
    EXPECT_EQ(detector->detect(ImageView{lamp.data(), width, height, width}, {}, peaks), 0u) << rows;
    EXPECT_EQ(detector->counters().saturated, 64u) << rows;
    ASSERT_EQ(detector->detect(ImageView{stripe.data(), width, height, width}, {}, peaks), 64u) << rows;
    EXPECT_NEAR(peaks[0].v_px, middle, 0.05) << rows;
    EXPECT_NEAR(peaks[0].clipped, rows, 1);
  }
}

// Its outer flank is beyond the image: the peak was given beyond it, too.
TEST(Peaks, APlateauAtTheBorderLiesInTheImage) {
  const int width = 64, height = 40;
  for (const bool at_the_end : {false, true}) {
    std::vector<std::uint8_t> image(width * height, 0);
    const auto begin = image.begin() + (at_the_end ? (height - 5) * width : 0);
    std::fill(begin, begin + 5 * width, 255);
    auto detector = std::make_unique<PeakDetector>();
    std::vector<Peak> peaks(width);
    const std::size_t found = detector->detect(ImageView{image.data(), width, height, width}, {}, peaks);
    ASSERT_EQ(found, 64u);
    for (const Peak& peak : peaks) {
      EXPECT_GE(peak.v_px, 0);
      EXPECT_LE(peak.v_px, height - 1);
      EXPECT_NEAR(peak.v_px, at_the_end ? height - 3 : 2, 2.5);
    }
  }
}

TEST(Peaks, RowsOfATurnedImageGiveTheSameAsColumns) {
  const test::StripeImage image = test::make_stripe_image({.width = 333, .height = 287, .sigma_px = 1.3, .noise = 2, .seed = 8});
  const auto turn = [&](const std::vector<std::uint8_t>& from) {
    std::vector<std::uint8_t> to(from.size());
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u) to[u * image.height + v] = from[v * image.width + u];
    return to;
  };
  const std::vector<std::uint8_t> on = turn(image.on), off = turn(image.off);
  auto columns = std::make_unique<PeakDetector>();
  auto rows = std::make_unique<PeakDetector>(PeakConfig{.axis = PeakAxis::row});
  std::vector<Peak> by_column(image.width), by_row(image.width);
  const std::size_t n = columns->detect(image.on_view(), image.off_view(), by_column);
  ASSERT_EQ(rows->detect(ImageView{on.data(), image.height, image.width, image.height},
                         ImageView{off.data(), image.height, image.width, image.height}, by_row),
            n);
  ASSERT_GT(n, 330u);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(by_column[i].u_px, by_row[i].v_px);
    EXPECT_EQ(by_column[i].v_px, by_row[i].u_px);
    EXPECT_EQ(by_column[i].amplitude, by_row[i].amplitude);
  }
}

TEST(Peaks, SixteenBitImagesGiveTheSameAsTheirEightBits) {
  const test::StripeImage image = test::make_stripe_image({.width = 200, .height = 150, .noise = 2, .seed = 9});
  std::vector<std::uint16_t> on(image.on.size()), off(image.off.size());
  std::transform(image.on.begin(), image.on.end(), on.begin(), [](std::uint8_t g) { return static_cast<std::uint16_t>(g * 257); });
  std::transform(image.off.begin(), image.off.end(), off.begin(), [](std::uint8_t g) { return static_cast<std::uint16_t>(g * 257); });
  auto narrow = std::make_unique<PeakDetector>();
  auto wide = std::make_unique<LargePeakDetector16>(PeakConfig{.min_contrast = 6 * 257, .full_scale = 65535});
  std::vector<Peak> a(200), b(200);
  const std::size_t n = narrow->detect(image.on_view(), image.off_view(), a);
  ASSERT_EQ(wide->detect({on.data(), 200, 150, 200}, {off.data(), 200, 150, 200}, b), n);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(a[i].v_px, b[i].v_px, 1e-4);
    EXPECT_NEAR(257 * a[i].amplitude, b[i].amplitude, 1);
  }
}

// Rows taken together by two or four: the same stripe at as many times the size is found at the same places, and its window is as many times as wide.
TEST(Peaks, TheWindowIsAsWideAsTheStripe) {
  EXPECT_EQ(PeakDetector::rows_as_one_for(0), 1);
  EXPECT_EQ(PeakDetector::rows_as_one_for(2.6f), 1);
  EXPECT_EQ(PeakDetector::rows_as_one_for(2.7f), 2);
  EXPECT_EQ(PeakDetector::rows_as_one_for(5.2f), 2);
  EXPECT_EQ(PeakDetector::rows_as_one_for(5.3f), 4);
  for (const int size : {1, 2, 4}) {
    const int width = 64, height = 100 * size;
    std::vector<std::uint8_t> image(width * height);
    for (int u = 0; u < width; ++u) {
      for (int v = 0; v < height; ++v) {
        const double place = (v + 0.5) / size - 0.5, light = 120 * std::exp(-0.5 * std::pow((place - 40.3 - 0.05 * u) / 1.6, 2));
        image[v * width + u] = static_cast<std::uint8_t>(std::lround(20 + light));
      }
    }
    auto detector = std::make_unique<PeakDetector>();
    detector->follow(static_cast<float>(1.6 * size));
    std::vector<Peak> peaks(width);
    ASSERT_EQ(detector->detect(ImageView{image.data(), width, height, width}, {}, peaks), 64u);
    EXPECT_EQ(detector->rows_as_one(), size);
    for (int u = 0; u < width; ++u) {
      EXPECT_NEAR(peaks[u].v_px, (40.3 + 0.05 * u + 0.5) * size - 0.5, 0.05 * size) << "size " << size << ", column " << u;
      // Of the brightest pixel, at most half a pixel from the middle: 120 (1 - exp(-0.5^2 / (2 1.6^2))) is 5.7 less; rounding twice.
      EXPECT_NEAR(peaks[u].amplitude, 120, 6.7) << "size " << size;
    }
  }
}

// Nothing is told of it: of 15 grey levels with a noise of 3 the narrow window finds hardly a column.
TEST(Peaks, AFaintWideStripeIsSearchedWithAllWindows) {
  test::StripeModel model{.sigma_px = 5.0, .amplitude = 15, .noise = 3};
  model.seed = 12;
  const test::StripeImage image = make_stripe_image(model);
  auto detector = std::make_unique<PeakDetector>(), narrow = std::make_unique<PeakDetector>();
  narrow->follow(1.5f);
  std::vector<Peak> peaks(image.width);
  EXPECT_LT(narrow->detect(image.on_view(), image.off_view(), peaks), 0.4 * image.width);
  const std::size_t found = detector->detect(image.on_view(), image.off_view(), peaks);
  EXPECT_GE(found, 0.97 * image.width);
  EXPECT_GT(detector->rows_as_one(), 1);
  const PeakCounters& counters = detector->counters();
  EXPECT_EQ(counters.found, found) << "of the window that was taken";
  EXPECT_EQ(counters.found + counters.weak + counters.saturated + counters.ambiguous, static_cast<std::uint64_t>(image.width));
}

// The response of -(1 - z^5)^4 / (1 - z)^2 is the convolution with its 19 taps, whatever the running sums overflow to.
TEST(Peaks, OfBlackAndWhiteNoiseAreWhereTheConvolutionIsHighest) {
  constexpr std::array taps{-1, -2, -3, -4, -5, -2, 1, 4, 7, 10, 7, 4, 1, -2, -5, -4, -3, -2, -1};
  std::mt19937_64 random(10);
  const int width = 128, height = 480;
  std::vector<std::uint8_t> on(width * height), off(width * height);
  for (auto& grey : on) grey = random() & 1 ? 254 : 0;
  for (auto& grey : off) grey = random() & 1 ? 254 : 0;
  PeakConfig config{.max_ratio = 2.0f};  // all columns are reported
  auto detector = std::make_unique<PeakDetector>(config);
  std::vector<Peak> peaks(width);
  const std::size_t count =
      detector->detect(ImageView{on.data(), width, height, width}, ImageView{off.data(), width, height, width}, peaks);
  ASSERT_GT(count, 120u) << "some look like stripes at an edge";
  for (std::size_t i = 0; i < count; ++i) {
    const int u = static_cast<int>(peaks[i].u_px);
    int best = 0, best_row = 0;
    std::vector<int> response(height);
    for (int v = 0; v < height; ++v)
      for (int k = 0; k < 19; ++k) {
        const int row = std::clamp(v + k - 9, 0, height - 1);
        response[v] += taps[k] * (on[row * width + u] - off[row * width + u]);
      }
    for (int v = 1; v + 1 < height; ++v)
      if (response[v] >= response[v - 1] && response[v] > response[v + 1] && response[v] > best) best = response[best_row = v];
    EXPECT_NEAR(peaks[i].v_px, best_row, 2.1) << "column " << u;  // the narrow filter may move it by one pixel, flanks by half of one
  }
}

TEST(Peaks, ImagesThatAreNotTakeNothing) {
  auto detector = std::make_unique<PeakDetector>();
  std::vector<std::uint8_t> pixels(100 * 100, 50);
  std::vector<Peak> peaks(100);
  const ImageView good{pixels.data(), 100, 100, 100};
  EXPECT_EQ(detector->detect(ImageView{}, {}, peaks), 0u);
  EXPECT_EQ(detector->detect(ImageView{pixels.data(), 100, 100, 50}, {}, peaks), 0u);    // stride below width
  EXPECT_EQ(detector->detect(ImageView{pixels.data(), 100, 24, 100}, {}, peaks), 0u);    // too short for the filter
  EXPECT_EQ(detector->detect(good, ImageView{pixels.data(), 100, 99, 100}, peaks), 0u);  // background of another size
  EXPECT_EQ(detector->detect(good, {}, std::span(peaks).first(99)), 0u);                 // no room
  EXPECT_EQ(detector->counters().weak, 0u);
  EXPECT_EQ(detector->detect(good, {}, peaks), 0u);
  EXPECT_EQ(detector->counters().weak, 100u);
}

TEST(Peaks, AtTheVeryBordersStayInside) {
  for (int row : {0, 1, 2, 97, 98, 99}) {
    std::vector<std::uint8_t> pixels(64 * 100, 10);
    std::fill_n(pixels.begin() + row * 64, 64, 255);
    auto detector = std::make_unique<PeakDetector>();
    std::vector<Peak> peaks(64);
    const std::size_t n = detector->detect(ImageView{pixels.data(), 64, 100, 64}, {}, peaks);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(peaks[i].v_px, row, 1.5);
  }
}

}  // namespace
}  // namespace lf::scan
