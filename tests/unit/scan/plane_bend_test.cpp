// Against closed forms: the mean of white noise goes with one over the root of the count, and a sagging plate has a known root mean square.
#include "firmware/scan/plane_bend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

constexpr double width_m = 0.8, height_m = 0.6;
constexpr double far_m = 1.0;  // a threshold beyond all points

// A plate that is tilted as a panel before the robot; `off_m` is added along its normal at places of -1 to 1 across and down.
template <class Off>
std::vector<CloudPoint> plate(std::size_t count, std::mt19937_64& random, const Plane& plane, const Off& off_m) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Vec3 across = plane.normal.cross(Vec3::UnitZ()).normalized(), down = across.cross(plane.normal);
  const Vec3 centre = Vec3(0.5, 0.1, 0.6) - plane.signed_distance_m(Vec3(0.5, 0.1, 0.6)) * plane.normal;
  std::vector<CloudPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = unit(random), t = unit(random);
    const Vec3 p = centre + 0.5 * width_m * s * across + 0.5 * height_m * t * down + off_m(s, t) * plane.normal;
    points.push_back({.p_m = p.cast<float>()});
  }
  return points;
}

Plane tilted() {
  Plane plane;
  plane.normal = Vec3(-1, 0.2, 0.3).normalized();
  plane.offset_m = 0.45;
  return plane;
}

TEST(PlaneBend, OfWhiteNoiseIsThatOfTheCellsMeans) {
  const Plane plane = tilted();
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 0.001);
    const auto points = plate(64'000, random, plane, [&](double, double) { return noise(random); });
    // 64 cells of 1000 points each, or fewer and fuller ones where the plate lies oblique to the grid.
    EXPECT_LT(plane_bend(points, plane, far_m).bend_m, 1.5 * 0.001 / std::sqrt(1000));
    EXPECT_GT(plane_bend(points, plane, far_m).bend_m, 0.5 * 0.001 / std::sqrt(1000));
  }
}

// z = a (s^2 - 1/3): mean square 4 a^2 / 45.
TEST(PlaneBend, OfASaggingPlateIsItsRootMeanSquareWhateverTheNoise) {
  const Plane plane = tilted();
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.001);
  for (const double sag_m : {0.0005, 0.001, 0.002}) {
    const auto points = plate(64'000, random, plane, [&](double s, double) { return sag_m * (s * s - 1.0 / 3) + noise(random); });
    EXPECT_NEAR(plane_bend(points, plane, far_m).bend_m, sag_m * std::sqrt(4.0 / 45), 0.08 * sag_m * std::sqrt(4.0 / 45)) << sag_m;
  }
}

// Of the plate's 0.8 x 0.6 m, however it lies, and of a strip of it.
TEST(PlaneBend, SaysHowWideWhatWasSeenIs) {
  const Plane plane = tilted();
  std::mt19937_64 random(7);
  const auto points = plate(64'000, random, plane, [](double, double) { return 0.0; });
  EXPECT_NEAR(plane_bend(points, plane, far_m).seen_m, height_m, 0.005);
  const Vec3 across = plane.normal.cross(Vec3::UnitZ()).normalized(), down = across.cross(plane.normal);
  std::vector<CloudPoint> strip;
  for (const CloudPoint& point : points) {
    if (std::abs((point.p_m.cast<double>() - Vec3(0.5, 0.1, 0.6)).dot(down)) < 0.07) strip.push_back(point);
  }
  EXPECT_NEAR(plane_bend(strip, plane, far_m).seen_m, 0.14, 0.003);
}

TEST(PlaneBend, OfFewPointsIsTheirScatter) {
  const Plane plane = tilted();
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.001);
  const auto points = plate(800, random, plane, [&](double, double) { return noise(random); });
  EXPECT_NEAR(plane_bend(points, plane, far_m).bend_m, 0.001, 0.0001);
}

TEST(PlaneBend, LeavesOutWhatIsNoPointOrNotOfThePlane) {
  const Plane plane = tilted();
  std::mt19937_64 random(6);
  auto points = plate(64'000, random, plane, [](double, double) { return 0.0; });
  const auto far_off = plate(20'000, random, plane, [](double, double) { return 0.02; });
  points.insert(points.end(), far_off.begin(), far_off.end());
  for (int i = 0; i < 1000; ++i) points.push_back({.p_m = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())});
  for (int i = 0; i < 1000; ++i) points.push_back({.p_m = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity())});
  EXPECT_LT(plane_bend(points, plane, 0.003).bend_m, 1e-6);
}

TEST(PlaneBend, OfNoPointsAndOfOnePlaceIsFinite) {
  const Plane plane = tilted();
  EXPECT_EQ(plane_bend({}, plane, far_m).bend_m, 0);
  const std::vector<CloudPoint> same(100, CloudPoint{.p_m = (-plane.offset_m * plane.normal + 0.002 * plane.normal).cast<float>()});
  EXPECT_NEAR(plane_bend(same, plane, far_m).bend_m, 0.002, 1e-6);
}

}  // namespace
}  // namespace lf::scan
