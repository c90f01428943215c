// Volume, area, centroid and bounds against closed forms, and against other sums.
#include <numbers>
#include <random>

#include "shared/mesh/judge.hpp"
#include "tests/unit/mesh/readings.hpp"

namespace lf::mesh::test {
namespace {

TEST(Measures, OfABox) {
  const MeshMeasures m = measure(joined({}, box({1, 2, 3}), Vec3(10, 20, -30)));
  EXPECT_NEAR(m.volume_m3, 6, 1e-13);
  EXPECT_NEAR(m.area_m2, 22, 1e-13);
  EXPECT_LT((m.centroid_m - Vec3(10.5, 21, -28.5)).norm(), 1e-13);
  EXPECT_EQ(m.least_m, Vec3(10, 20, -30));
  EXPECT_EQ(m.most_m, Vec3(11, 22, -27));
  EXPECT_EQ(m.edges, 18U);
  EXPECT_EQ(m.shells, 1U);
  EXPECT_EQ(m.euler, 2);
}

TEST(Measures, OfATetrahedron) {
  const MeshMeasures m = measure(tetrahedron());
  EXPECT_NEAR(m.volume_m3, 1.0 / 6, 1e-16);
  EXPECT_NEAR(m.area_m2, 1.5 + std::numbers::sqrt3 / 2, 1e-15);
  EXPECT_LT((m.centroid_m - Vec3::Constant(0.25)).norm(), 1e-15);
  EXPECT_EQ(m.euler, 2);
  EXPECT_NEAR(measure(inside_out(tetrahedron())).volume_m3, -1.0 / 6, 1e-16);
}

TEST(Measures, OfNothing) {
  const MeshMeasures m = measure({});
  EXPECT_EQ(m.volume_m3, 0);
  EXPECT_EQ(m.shells, 0U);
  EXPECT_EQ(m.euler, 0);
}

// The sphere's mesh is a stack of frusta with regular polygons as bases: another way to the same sum.
TEST(Measures, OfASphereAreThoseOfItsFrusta) {
  constexpr double radius_m = 0.3;
  for (const std::uint32_t n : {5U, 12U, 31U}) {
    double volume_m3 = 0, area_m2 = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double ra = radius_m * std::sin(pi * i / n), rb = radius_m * std::sin(pi * (i + 1) / n);
      const double height = radius_m * (std::cos(pi * i / n) - std::cos(pi * (i + 1) / n)), polygon = n / 2.0 * std::sin(2 * pi / n);
      volume_m3 += height / 3 * polygon * (ra * ra + ra * rb + rb * rb);
      area_m2 += n * std::sin(pi / n) * (ra + rb) * std::hypot(height, (rb - ra) * std::cos(pi / n));
    }
    const MeshMeasures m = measure(sphere(radius_m, n));
    EXPECT_NEAR(m.volume_m3, volume_m3, 1e-15);
    EXPECT_NEAR(m.area_m2, area_m2, 1e-14);
    EXPECT_LT(m.centroid_m.norm(), 1e-15);
    EXPECT_EQ(m.euler, 2);
  }
}

// Twice as fine is four times as near: chords of a circle are of second order.
TEST(Measures, OfSphereAndTorusComeNearTheirFormulasWithTheSquareOfTheGrid) {
  constexpr double r = 0.3, ring = 0.5, tube = 0.2;
  const auto errors = [&](std::uint32_t n) {
    const MeshMeasures ball = measure(sphere(r, n)), tire = measure(torus(ring, tube, n));
    return std::array<double, 4>{4 * pi / 3 * r * r * r - ball.volume_m3, 4 * pi * r * r - ball.area_m2,
                                 2 * pi * pi * ring * tube * tube - tire.volume_m3, 4 * pi * pi * ring * tube - tire.area_m2};
  };
  const std::array<double, 4> coarse = errors(32), fine = errors(64), finest = errors(128);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(finest[i], 0) << "inscribed";
    EXPECT_NEAR(std::log2(coarse[i] / fine[i]), 2, 0.02) << i;
    EXPECT_NEAR(std::log2(fine[i] / finest[i]), 2, 0.005) << i;
  }
  EXPECT_EQ(measure(torus(ring, tube, 16)).euler, 0);
}

TEST(Measures, OfSeveralPiecesAreTheirSum) {
  const MeshMeasures m =
      measure(joined(joined(box({2, 2, 2}), inside_out(box({1, 1, 1})), Vec3::Constant(0.5)), torus(0.5, 0.2, 8), Vec3(5, 0, 0)));
  EXPECT_NEAR(m.volume_m3, 8 - 1 + measure(torus(0.5, 0.2, 8)).volume_m3, 1e-13);
  EXPECT_EQ(m.shells, 3U);
  EXPECT_EQ(m.euler, 2 + 2 + 0);
}

// 32 triangles around the origin, not convex. The volume is exact, in rational numbers, as the sum of prisms over the plane z = 0 and not of tetrahedra.
TEST(Measures, OfARoughBodyAreThoseOfAnotherDecomposition) {
  const Mesh body{{{59, 2, 7},
                   {-69, 5, -2},
                   {-8, 56, -6},
                   {2, -54, -2},
                   {3, 8, 54},
                   {9, -2, -69},
                   {39, 46, -1},
                   {-4, 45, 38},
                   {35, -5, 47},
                   {-47, 37, -9},
                   {-51, -3, 39},
                   {-46, -46, 0},
                   {1, -45, 50},
                   {39, -46, -3},
                   {45, 0, -51},
                   {2, 46, -46},
                   {-47, -1, -49},
                   {1, -42, -33}},
                  {{0, 6, 8},   {6, 2, 7},   {8, 7, 4},   {6, 7, 8},    {2, 9, 7},   {9, 1, 10},  {7, 10, 4},  {9, 10, 7},
                   {1, 11, 10}, {11, 3, 12}, {10, 12, 4}, {11, 12, 10}, {3, 13, 12}, {13, 0, 8},  {12, 8, 4},  {13, 8, 12},
                   {2, 6, 15},  {6, 0, 14},  {15, 14, 5}, {6, 14, 15},  {1, 9, 16},  {9, 2, 15},  {16, 15, 5}, {9, 15, 16},
                   {3, 11, 17}, {11, 1, 16}, {17, 16, 5}, {11, 16, 17}, {0, 13, 14}, {13, 3, 17}, {14, 17, 5}, {13, 17, 14}}};
  EXPECT_FALSE(judge(body).any());
  const MeshMeasures m = measure(body);
  EXPECT_NEAR(m.volume_m3, 4166413.0 / 6, 1e-9);
  EXPECT_LT((m.centroid_m - Vec3(-37576175.0 / 16665652, -1587213.0 / 8332826, -21656799.0 / 8332826)).norm(), 1e-13);
}

TEST(Measures, FollowAnyAffineTransform) {
  constexpr std::uint64_t seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Mesh before = i % 2 == 0 ? torus(0.5, 0.2, 9) : sphere(0.3, 6);
    Mat3 linear;
    Vec3 moved_m;
    for (double& value : linear.reshaped()) value = uniform(random);
    for (double& value : moved_m) value = 100 * uniform(random);
    if (std::abs(linear.determinant()) < 0.05) continue;
    Mesh after = before;
    for (Vec3& vertex : after.vertices_m) vertex = linear * vertex + moved_m;
    const MeshMeasures m = measure(before), n = measure(after);
    // Coordinates of 100 m have a last bit of 1.4e-14 m.
    EXPECT_NEAR(n.volume_m3, m.volume_m3 * linear.determinant(), 1e-13);
    EXPECT_LT((n.centroid_m - (linear * m.centroid_m + moved_m)).norm(), 1e-10);
    EXPECT_EQ(n.edges, m.edges);
    const Mat3 turn = Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), 1.1).normalized().toRotationMatrix();
    Mesh turned = before;
    for (Vec3& vertex : turned.vertices_m) vertex = turn * vertex + moved_m;
    EXPECT_NEAR(measure(turned).area_m2, m.area_m2, 1e-12);
  }
}

}  // namespace
}  // namespace lf::mesh::test
