#include "firmware/scan/plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

double angle_deg(const Vec3& a, const Vec3& b) { return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b))); }

CloudPoint point(const Vec3& p) { return {.p_m = p.cast<float>()}; }

struct Scene {
  std::vector<CloudPoint> points;
  Plane truth;
};

// A panel of 0.8 x 0.6 m swept from above to below, and outliers in the box before and behind it, in the order of the sweep.
Scene swept_panel(std::uint64_t seed, std::size_t count, double outliers, double noise_m) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, noise_m);
  std::uniform_real_distribution<double> unit(0, 1);
  Scene scene;
  const Vec3 normal = Vec3(-1, 0.2 * (unit(random) - 0.5), 0.2 * (unit(random) - 0.5)).normalized();
  const Vec3 across = normal.cross(Vec3::UnitZ()).normalized(), down = across.cross(normal), centre(0.45, 0, 0.65);
  scene.truth = {normal, -normal.dot(centre)};
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count) - 0.5;
    const bool outlier = unit(random) < outliers;
    const Vec3 p = outlier ? Vec3(centre + Vec3(0.6 * (unit(random) - 0.5), 0.8 * (unit(random) - 0.5), 0.6 * t))
                           : Vec3(centre + 0.8 * (unit(random) - 0.5) * across + 0.6 * t * down + noise(random) * normal);
    scene.points.push_back(point(p));
  }
  return scene;
}

class PlaneFitting : public testing::Test {
 protected:
  PlaneFit fit(const std::vector<CloudPoint>& points, PlaneFitter::Config config = {}) { return fitter_->fit(points, config); }
  std::unique_ptr<PlaneFitter> fitter_ = std::make_unique<PlaneFitter>();
};

// Found by fuzz_cloud: what is no point was put far away on the diagonal, which lies in the plane x = y.
TEST_F(PlaneFitting, WhatIsNoPointIsNoInlierOfAnyPlane) {
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::vector<CloudPoint> points;
    for (int i = 0; i < 100; ++i) {
      const double along = unit(random);
      points.push_back(point(Vec3(along, along, unit(random))));
      if (i % 3 == 0) points.push_back(point(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
      if (i % 5 == 0) points.push_back(point(Vec3::Constant(std::numeric_limits<double>::infinity())));
    }
    const PlaneFit result = fit(points, {.tight_sigmas = 3.0});
    ASSERT_TRUE(result.valid);
    ASSERT_EQ(result.points, 100u);
    ASSERT_EQ(result.inliers, 100u);
    const double apart_deg = angle_deg(result.plane.normal, Vec3(1, -1, 0));
    ASSERT_LT(std::min(apart_deg, 180 - apart_deg), 1e-3);
  }
}

TEST_F(PlaneFitting, HoldsAtEveryShareOfOutliersInSweepOrder) {
  const std::pair<double, double> rows[] = {{0.0, 0.005}, {0.3, 0.01}, {0.6, 0.02}, {0.85, 0.05}};  // share, worst angle in degrees
  for (const auto& [outliers, worst_deg] : rows) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(testing::Message() << outliers << " outliers, seed " << seed);
      const Scene scene = swept_panel(seed, 60'000, outliers, 0.001);
      const PlaneFit result = fit(scene.points, {.seed = seed});
      ASSERT_TRUE(result.valid);
      EXPECT_LT(angle_deg(result.plane.normal, scene.truth.normal), worst_deg);
      EXPECT_EQ(result.points, scene.points.size());
      EXPECT_NEAR(result.inliers, (1 - outliers) * 60'000, 0.03 * 60'000);
      EXPECT_NEAR(result.rms_m, 0.001, 0.00025);
    }
  }
}

// A plate that sags by z = a (t^2 - 1/3) along the sweep, t from -1 to 1: the root of its mean square is a sqrt(4 / 45).
TEST_F(PlaneFitting, TellsTheBendOfASaggingPlate) {
  for (const double sag_m : {0.0, 0.0015}) {
    Scene scene = swept_panel(3, 60'000, 0, 0.0008);
    const double count = static_cast<double>(scene.points.size());
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const double t = 2 * static_cast<double>(i) / count - 1;
      scene.points[i].p_m += (sag_m * (t * t - 1.0 / 3) * scene.truth.normal).cast<float>();
    }
    const PlaneFit result = fit(scene.points);
    ASSERT_TRUE(result.valid);
    EXPECT_NEAR(result.bend_m, sag_m * std::sqrt(4.0 / 45), 0.00004) << sag_m;
  }
}

TEST_F(PlaneFitting, OrderOfThePointsDoesNotMatter) {
  Scene scene = swept_panel(5, 30'000, 0.5, 0.001);
  const PlaneFit swept = fit(scene.points);
  std::mt19937_64 random(6);
  for (int turn = 0; turn < 4; ++turn) {
    std::shuffle(scene.points.begin(), scene.points.end(), random);
    const PlaneFit shuffled = fit(scene.points);
    EXPECT_EQ(shuffled.inliers, swept.inliers);
    EXPECT_LT((shuffled.plane.normal - swept.plane.normal).norm(), 1e-9);
    EXPECT_NEAR(shuffled.plane.offset_m, swept.plane.offset_m, 1e-9);
  }
}

// All inliers at the end of the cloud, and a stride that would meet outliers only.
TEST_F(PlaneFitting, TrapsOfPrefixAndStrideAreNotSteppedInto) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<CloudPoint> last(40'000), stride(40'000);
  for (std::size_t i = 0; i < last.size(); ++i) {
    const Vec3 inlier(unit(random), unit(random), 1), outlier(unit(random), unit(random), 1 + unit(random));
    last[i] = point(i < 32'000 ? outlier : inlier);
    stride[i] = point(i % 4 == 0 ? outlier : inlier);
  }
  for (const auto* points : {&last, &stride}) {
    const PlaneFit result = fit(*points);
    ASSERT_TRUE(result.valid);
    EXPECT_LT(angle_deg(result.plane.normal, -Vec3::UnitZ()), 0.02);
    EXPECT_NEAR(result.plane.offset_m, 1, 1e-4);
  }
}

TEST_F(PlaneFitting, TheSameSeedGivesTheSameBits) {
  const Scene scene = swept_panel(8, 20'000, 0.6, 0.001);
  const PlaneFit a = fit(scene.points, {.seed = 3}), b = fit(scene.points, {.seed = 3});
  EXPECT_EQ(a.plane.normal, b.plane.normal);
  EXPECT_EQ(a.plane.offset_m, b.plane.offset_m);
}

TEST_F(PlaneFitting, NormalPointsToTheSideItIsTold) {
  const Scene scene = swept_panel(9, 5'000, 0.2, 0.001);
  const PlaneFit near = fit(scene.points, {.toward_m = Vec3::Zero()}), far = fit(scene.points, {.toward_m = Vec3(2, 0, 0)});
  EXPECT_GT(near.plane.signed_distance_m(Vec3::Zero()), 0);
  EXPECT_GT(far.plane.signed_distance_m(Vec3(2, 0, 0)), 0);
  EXPECT_LT((near.plane.normal + far.plane.normal).norm(), 1e-12);
}

// A marker's plate 2 mm proud, to one side, is within the threshold: a tight window leaves it out.
TEST_F(PlaneFitting, ATightWindowIsNotTiltedByAPlateTwoMillimetresProud) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> noise(0, 0.0004);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<CloudPoint> points;
  for (int i = 0; i < 60'000; ++i) points.push_back(point({0.8 * unit(random), 0.6 * unit(random), 1 + noise(random)}));
  for (int i = 0; i < 6'000; ++i) points.push_back(point({-0.3 + 0.1 * unit(random), 0.2 + 0.1 * unit(random), 0.998 + noise(random)}));
  const PlaneFit plain = fit(points), tight = fit(points, {.tight_sigmas = 3.0});
  EXPECT_GT(angle_deg(plain.plane.normal, -Vec3::UnitZ()), 0.03);
  EXPECT_LT(angle_deg(tight.plane.normal, -Vec3::UnitZ()), 0.006);
  EXPECT_NEAR(tight.plane.offset_m, 1, 2e-5);
  EXPECT_GT(tight.inliers, 60'000u);  // counted within the threshold all the same
}

TEST_F(PlaneFitting, ThreePointsGiveTheirPlane) {
  const PlaneFit result = fit({point({0, 0, 1}), point({1, 0, 1}), point({0, 1, 1})});
  ASSERT_TRUE(result.valid);
  EXPECT_LT((result.plane.normal + Vec3::UnitZ()).norm(), 1e-6);
  EXPECT_EQ(result.inliers, 3u);
}

TEST_F(PlaneFitting, TooLittleIsNoPlane) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 0.0003);
  EXPECT_FALSE(fit({}).valid);
  EXPECT_FALSE(fit({point({0, 0, 1})}).valid);
  EXPECT_FALSE(fit({point({0, 0, 1}), point({1, 0, 1})}).valid);
  EXPECT_FALSE(fit(std::vector<CloudPoint>(1000, point({0.1, 0.2, 0.3}))).valid);
  std::vector<CloudPoint> line, stripe;
  for (int i = 0; i < 1000; ++i) line.push_back(point(Vec3(0.1, 0.2, 0.3) * i * 0.001));
  for (int i = 0; i < 640; ++i) stripe.push_back(point({0.001 * i + noise(random), noise(random), 1 + noise(random)}));
  EXPECT_FALSE(fit(line).valid);
  EXPECT_FALSE(fit(stripe).valid) << "a single stripe does not say how the plane is tilted about it";
}

TEST_F(PlaneFitting, WhatIsNotFiniteIsPassedOver) {
  Scene scene = swept_panel(12, 20'000, 0.3, 0.001);
  const PlaneFit clean = fit(scene.points);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::vector<CloudPoint> dirty;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    dirty.push_back(scene.points[i]);
    dirty.push_back({.p_m = {i % 2 ? nan : 0.1f, 0.2f, i % 2 ? 0.3f : -inf}});
  }
  const PlaneFit result = fit(dirty);
  ASSERT_TRUE(result.valid);
  EXPECT_EQ(result.points, clean.points);
  EXPECT_EQ(result.inliers, clean.inliers);
  EXPECT_LT((result.plane.normal - clean.plane.normal).norm(), 1e-9);
  EXPECT_FALSE(fit(std::vector<CloudPoint>(5000, {.p_m = {nan, nan, nan}})).valid);
}

TEST_F(PlaneFitting, AThresholdThatIsNoneIsRefused) {
  const Scene scene = swept_panel(13, 1'000, 0, 0.001);
  for (double threshold_m : {0.0, -0.001, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(fit(scene.points, {.threshold_m = threshold_m}).valid);
}

}  // namespace
}  // namespace lf::scan
