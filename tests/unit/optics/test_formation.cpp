// The pieces of which a picture is made after the rays, each against a closed form or a published figure.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "host_sim/optics/formation/halo_pyramid.hpp"
#include "host_sim/optics/formation/lens_spot.hpp"
#include "host_sim/optics/formation/normal_deviates.hpp"
#include "host_sim/optics/formation/speckle.hpp"
#include "shared/lanes/lanes.hpp"

namespace lf::optics::test {
namespace {

double bell(double x, double sigma) { return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * pi)); }

TEST(GaussianTaps, HaveTheVarianceThatIsAskedFor) {
  for (double sigma = 0.05; sigma < 4.5; sigma += 0.07) {
    const GaussianTaps taps = GaussianTaps::of(sigma);
    double sum = taps.tap[0], variance = 0;
    for (int k = 1; k <= taps.radius; ++k) {
      sum += 2.0 * taps.tap[static_cast<std::size_t>(k)];
      variance += 2.0 * k * k * taps.tap[static_cast<std::size_t>(k)];
    }
    EXPECT_NEAR(sum, 1, 1e-6) << sigma;
    EXPECT_NEAR(variance, sigma * sigma, 1e-4 * sigma * sigma) << sigma;
  }
}

struct Planes {
  explicit Planes(int w, int h)
      : width(w), height(h), stride((static_cast<std::size_t>(w) + 7) / 8 * 8), in(stride * static_cast<std::size_t>(h)), out(in) {}
  void fill(float value) { std::fill(in.begin(), in.end(), value); }
  PlaneView<const float> source() const { return {in.data(), stride, width, height}; }
  PlaneView<float> target() { return {out.data(), stride, width, height}; }
  int width, height;
  std::size_t stride;
  std::vector<float> in, out;
};

TEST(HaloPyramid, SpreadsALineAsTheGaussianThatWasAskedFor) {
  WorkerPool pool(2);
  for (const double sigma : {2.0, 2.4, 3.1, 5.5, 8.0, 20.0, 32.0, 60.0}) {
    double worst = 0;
    for (int place = 0; place < 16; ++place) {
      Planes planes(640, 41);
      const int line = 312 + place;
      for (int v = 0; v < planes.height; ++v) planes.in[static_cast<std::size_t>(v) * planes.stride + static_cast<std::size_t>(line)] = 1;
      const std::vector<std::uint8_t> no_rows(static_cast<std::size_t>(planes.height));
      HaloPyramid(planes.width, planes.height)
          .add(planes.source(), {{1.f, sigma}}, planes.source(), {planes.source(), no_rows}, {}, planes.target(), pool);
      for (int u = 0; u < planes.width; ++u) {
        worst = std::max(worst,
                         std::abs(planes.out[20 * planes.stride + static_cast<std::size_t>(u)] - bell(u - line, sigma)) / bell(0, sigma));
      }
    }
    EXPECT_LT(worst, sigma < 3 ? 0.06 : 0.03) << sigma;
  }
}

TEST(HaloPyramid, LeavesAnEvenPictureEven) {
  WorkerPool pool(1);
  for (const auto& [width, height] : {std::pair{640, 480}, std::pair{333, 217}, std::pair{17, 3}, std::pair{1, 1}}) {
    Planes planes(width, height);
    planes.fill(7);
    const std::vector<std::uint8_t> no_rows(static_cast<std::size_t>(height));
    HaloPyramid(width, height)
        .add(planes.source(), {{0.5f, 2.0}, {0.25f, 32.0}, {0.1f, 400.0}}, planes.source(), {planes.source(), no_rows}, {0.05f, 6.0},
             planes.target(), pool);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u)
        ASSERT_NEAR(planes.out[static_cast<std::size_t>(v) * planes.stride + static_cast<std::size_t>(u)], 0.9 * 7, 1e-4);
    }
  }
}

// Rows that are known to be 0 are not read.
TEST(HaloPyramid, OfALinesPlaneTheRowsThatAreNotZeroAreEnough) {
  WorkerPool pool(1);
  Planes grey(64, 48), line(64, 48), none(64, 48);
  grey.fill(5);
  for (std::size_t u = 0; u < 64; ++u) line.in[21 * line.stride + u] = line.in[34 * line.stride + u] = static_cast<float>(u);
  std::vector<std::uint8_t> all(48, 1), one(48);
  one[21] = one[34] = 1;
  const auto halo = [&](const std::vector<std::uint8_t>& rows) {
    std::fill(none.out.begin(), none.out.end(), 0.f);
    HaloPyramid(64, 48).add(none.source(), {}, grey.source(), {line.source(), rows}, {0.1f, 6.0}, none.target(), pool);
    return none.out;
  };
  EXPECT_EQ(halo(all), halo(one));
  EXPECT_NE(halo(all), halo(std::vector<std::uint8_t>(48)));
}

TEST(LensSpot, TurnsAStepIntoTheNormalDistributionsOwn) {
  const int width = 640, height = 480;
  Planes planes(width, height);
  const LensSpot lens(width, height, 0.9, 1.8);
  std::vector<float> scratch(planes.stride + 2 * LensSpot::reach()), row(planes.stride);
  for (const auto& [edge, v] : {std::pair{320, 240}, std::pair{40, 20}, std::pair{600, 460}, std::pair{160, 240}}) {
    for (int y = 0; y < height; ++y) {
      for (int u = 0; u < width; ++u)
        planes.in[static_cast<std::size_t>(y) * planes.stride + static_cast<std::size_t>(u)] = u < edge ? 0.f : 1.f;
    }
    lens.show(planes.source(), v, {0, width / lane_count}, scratch.data(), row.data());
    const double sigma = lens.sigma_px(edge - 0.5, v);
    for (int u = edge - 6; u < edge + 6; ++u) {
      // Pixels add their own width to the step, and samples of a bell their own to it: under a hundredth at this width.
      EXPECT_NEAR(row[static_cast<std::size_t>(u)], 0.5 * std::erfc(-(u - (edge - 0.5)) / (sigma * std::sqrt(2.0))), 0.02)
          << edge << " " << u;
    }
  }
  EXPECT_NEAR(lens.sigma_px(319.5, 239.5), 0.9, 1e-9);
  EXPECT_NEAR(lens.sigma_px(0, 0), 1.8, 1e-9);
}

TEST(LensSpot, ShowsTheWantedPacketsAlone) {
  Planes planes(64, 32);
  planes.fill(3);
  for (const double spot_px : {1.2, 4.5}) {
    const LensSpot lens(64, 32, spot_px, spot_px);
    std::vector<float> scratch(planes.stride + 2 * LensSpot::reach(), 1e9f), row(planes.stride);
    lens.show(planes.source(), 10, {3, 4}, scratch.data(), row.data());
    for (int u = 0; u < 64; ++u) EXPECT_NEAR(row[static_cast<std::size_t>(u)], u / 8 == 3 ? 3 : 0, 1e-5) << spot_px << " " << u;
  }
}

TEST(NormalDeviates, AreTheSameInARowAsOneByOne) {
  for (const std::size_t count : {1, 8, 9, 63, 64, 65, 200}) {
    std::vector<float> row(count + lane_count);
    normal_deviates(4'294'967'290U, count, 77, row.data());  // the numbers begin anew after 2^32
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(row[i], normal_deviate(4'294'967'290U + static_cast<std::uint32_t>(i), 77)) << count << " " << i;
  }
}

// Written down from the program of 3dcd7c3, which took them eight by eight: a run's digest rests on them.
TEST(NormalDeviates, AreThoseOfEarlierVersions) {
  const std::pair<std::uint32_t, float> known[] = {{0, 1.23989463F}, {1, -0.540919244F}, {77, -0.776132584F}, {307199, 0.679600954F}};
  for (const auto& [number, deviate] : known) EXPECT_FLOAT_EQ(normal_deviate(number, 0x123456789ABCDEF), deviate) << number;
}

std::vector<float> factors(const Speckle& speckle, std::uint32_t first, std::size_t count) {
  std::vector<float> factors(count);
  speckle.factors(first, count, factors.data());
  return factors;
}

TEST(Speckle, HasMeanOneAndItsContrast) {
  for (const double contrast : {0.05, 0.18, 0.35}) {
    const Speckle speckle(contrast, 5, {0.1234, 0.5, -0.3});
    double sum = 0, squares = 0;
    const std::uint32_t count = 200'000;
    for (const float factor : factors(speckle, 0, count)) sum += factor, squares += double(factor) * factor;
    const double mean = sum / count;
    EXPECT_NEAR(mean, 1, 4 * contrast / std::sqrt(double(count)) + 2e-3);
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean), contrast, 0.02 * contrast);
  }
}

TEST(Speckle, IsThatOfEarlierVersions) {
  const std::vector<float> known{0.832275093F, 1.05430317F,  0.817940772F, 0.949764073F, 0.884888232F,
                                 1.36553025F,  0.981095672F, 1.08670616F,  0.809469461F, 0.792776287F};
  const Speckle speckle(0.18, 5, {0.1234, 0.5, -0.3});
  const std::vector<float> from_60 = factors(speckle, 60, 80), from_0 = factors(speckle, 0, 160);
  for (std::size_t i = 0; i < known.size(); ++i) EXPECT_FLOAT_EQ(from_60[i], known[i]) << i;
  for (std::size_t i = 0; i < from_60.size(); ++i) EXPECT_EQ(from_60[i], from_0[60 + i]) << i;
}

double likeness(const Speckle& a, const Speckle& b) {
  double both = 0, first = 0, second = 0;
  const std::vector<float> of_a = factors(a, 0, 40'000), of_b = factors(b, 0, 40'000);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const double x = of_a[i] - 1, y = of_b[i] - 1;
    both += x * y, first += x * x, second += y * y;
  }
  return both / std::sqrt(first * second);
}

TEST(Speckle, IsFrozenWithTheEmitterAndNewOnceThatHasMoved) {
  const Vec3 place(0.2, -0.1, 0.35);
  const Speckle at(0.18, 9, place);
  EXPECT_DOUBLE_EQ(likeness(at, Speckle(0.18, 9, place)), 1);
  EXPECT_GT(likeness(at, Speckle(0.18, 9, place + Vec3(0.00002, 0, 0))), 0.9);
  for (const Vec3& move : {Vec3(0.0015, 0, 0), Vec3(0, -0.0015, 0), Vec3(0, 0, 0.0015)})
    EXPECT_LT(std::abs(likeness(at, Speckle(0.18, 9, place + move))), 0.05);
}

// The centre of mass of a Gaussian stripe under speckle errs by 0.424 C (lambda F# / p) sqrt(s) pixels, where one pixel's contrast is 0.27 C at 6 um, F/2.8 and 520 nm.
TEST(Speckle, MovesAStripesCentreOfMassAsMuchAsCoherentLightDoes) {
  const double lambda_f_over_pitch = 0.52 * 2.8 / 6;
  for (const double s : {1.2, 1.6, 2.4, 3.5}) {
    const double expected = 0.424 * 0.71 * lambda_f_over_pitch * std::sqrt(s);
    const Speckle speckle(0.27 * 0.71, 77, {0, 0, 0.1});
    double squares = 0;
    const int columns = 4000;
    for (int column = 0; column < columns; ++column) {
      double sum = 0, moment = 0;
      const std::vector<float> factor = factors(speckle, static_cast<std::uint32_t>(column * 64), 40);
      for (int v = -20; v < 20; ++v) {
        const double light = bell(v, s) * factor[static_cast<std::size_t>(v + 20)];
        sum += light, moment += light * v;
      }
      squares += moment / sum * moment / sum;
    }
    EXPECT_NEAR(std::sqrt(squares / columns), expected, 0.09 * expected) << s;
  }
}

}  // namespace
}  // namespace lf::optics::test
