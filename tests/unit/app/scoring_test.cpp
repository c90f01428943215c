#include "host_sim/app/scoring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/arm5e_bodies.hpp"

namespace lf::app {

TEST(Scoring, PlaneErrorsAreThoseOfTheClosedForm) {
  const PanelLayout layout;
  const Pose truth = layout.nominal_base_from_panel();
  Plane plane;
  plane.normal = truth.linear().col(2);
  plane.offset_m = -plane.normal.dot(truth.translation()) + 0.002;
  EXPECT_NEAR(plane_normal_error_deg(plane, truth), 0, 1e-9);
  EXPECT_NEAR(plane_offset_error_mm(plane, truth, layout), 2, 1e-9);
  plane.normal = Eigen::AngleAxisd(rad_from_deg(0.1), truth.linear().col(0)) * plane.normal;
  EXPECT_NEAR(plane_normal_error_deg(plane, truth), 0.1, 1e-9);
  plane.normal = -plane.normal;
  EXPECT_NEAR(plane_normal_error_deg(plane, truth), 0.1, 1e-9) << "either side";
}

TEST(Scoring, ABarIsTheSameAfterHalfATurn) {
  EXPECT_NEAR(handle_error_deg(rad_from_deg(89), rad_from_deg(-89)), 2, 1e-9);
  EXPECT_NEAR(handle_error_deg(rad_from_deg(10), rad_from_deg(190)), 0, 1e-9);
  EXPECT_NEAR(handle_error_deg(rad_from_deg(-5), rad_from_deg(5)), 10, 1e-9);
}

TEST(Scoring, DistancesToBoxesAndCylinders) {
  scene::Shape box;
  box.kind = scene::ShapeKind::box;
  box.size_m = Vec3(2, 4, 6);
  EXPECT_NEAR(distance_to_surface_m(Vec3(2, 0, 0), box), 1, 1e-12);
  EXPECT_NEAR(distance_to_surface_m(Vec3(0.75, 0, 0), box), 0.25, 1e-12) << "from inside";
  EXPECT_NEAR(distance_to_surface_m(Vec3(4, 6, 0), box), 5, 1e-12) << "to an edge: 3, 4, 5";
  scene::Shape cylinder;
  cylinder.kind = scene::ShapeKind::cylinder;
  cylinder.size_m = Vec3(1, 0, 2);
  EXPECT_NEAR(distance_to_surface_m(Vec3(0, 3, 0), cylinder), 2, 1e-12);
  EXPECT_NEAR(distance_to_surface_m(Vec3(4, 0, 5), cylinder), 5, 1e-12) << "to the rim";
}

TEST(Scoring, DistancesToSpheresCapsulesAndMeshes) {
  scene::Shape sphere;
  sphere.kind = scene::ShapeKind::sphere;
  sphere.size_m = Vec3(2, 0, 0);
  EXPECT_NEAR(distance_to_surface_m(Vec3(3, 4, 0), sphere), 3, 1e-12);
  scene::Shape capsule;
  capsule.kind = scene::ShapeKind::capsule;
  capsule.size_m = Vec3(1, 0, 4);
  EXPECT_NEAR(distance_to_surface_m(Vec3(3, 0, 6), capsule), 4, 1e-12) << "to its cap: 3, 4, 5 less the radius";
  EXPECT_NEAR(distance_to_surface_m(Vec3(3, 0, 1), capsule), 2, 1e-12);
  // A box as a mesh is as far away as the box.
  scene::Shape box, mesh;
  box.size_m = Vec3(2, 2, 2);
  mesh.kind = scene::ShapeKind::mesh;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) mesh.vertices_m.push_back({x, y, z});
    }
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  for (const Vec3& p : {Vec3(3, 0, 0), Vec3(3, 3, 0), Vec3(3, -3, 3), Vec3(0.2, 0.5, 0.4), Vec3(-0.9, 0.1, 0)})
    EXPECT_NEAR(distance_to_surface_m(p, mesh), distance_to_surface_m(p, box), 1e-12) << p.transpose();
}

// A bumpy ball of 2 * 40 * 80 triangles, about the origin.
scene::Shape bumpy_ball() {
  constexpr std::uint32_t rows = 41, columns = 80;
  scene::Shape ball;
  ball.kind = scene::ShapeKind::mesh;
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double latitude = pi * (row / (rows - 1.0) - 0.5), longitude = 2 * pi * column / columns;
      const double radius = 0.1 * (1 + 0.2 * std::sin(3 * longitude) * std::cos(4 * latitude));
      ball.vertices_m.emplace_back(radius * std::cos(latitude) * std::cos(longitude), radius * std::cos(latitude) * std::sin(longitude),
                                   radius * std::sin(latitude));
    }
  }
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t a = row * columns + column, b = row * columns + (column + 1) % columns;
      ball.triangles.push_back({a, b, b + columns});
      ball.triangles.push_back({a, b + columns, a + columns});
    }
  }
  return ball;
}

// The tree finds what looking at every triangle finds.
TEST(Scoring, CloudErrorsAreDistancesToTheNearestSurfaceAndMeshesAreSurface) {
  constexpr std::uint64_t seed = 31;
  scene::Scene scene = scene::bare_scene();
  scene::Body ball;
  ball.shapes.push_back(bumpy_ball());
  ball.shapes[0].body_from_shape = Pose(Eigen::Translation3d(0.01, -0.02, 0.03) * Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()));
  scene.push_back(ball);
  scene::BodyPoses poses = scene::poses_at_origin(scene);
  poses.back() = Pose(Eigen::Translation3d(0.3, 0.1, 0.2) * Eigen::AngleAxisd(1.1, Vec3::UnitY()));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-0.3F, 0.8F);
  std::vector<CloudPoint> cloud(300);
  for (CloudPoint& point : cloud) point.p_m = Eigen::Vector3f(place(random), place(random), place(random));
  const std::vector<double> errors = cloud_errors_mm(cloud, scene, poses);
  ASSERT_EQ(errors.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 p = poses.back().inverse() * cloud[i].p_m.cast<double>();
    EXPECT_NEAR(errors[i], 1e3 * distance_to_surface_m(p, ball.shapes[0]), 1e-9) << "seed " << seed << ", point " << i;
  }
  // With a plate nearer than the ball the plate counts.
  scene::Shape plate;
  plate.kind = scene::ShapeKind::box;
  plate.size_m = Vec3(4, 4, 0.1);
  scene[arm5e_body::panel].shapes = {plate};
  const std::vector<double> both = cloud_errors_mm(cloud, scene, poses);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_NEAR(both[i], std::min(errors[i], 1e3 * distance_to_surface_m(cloud[i].p_m.cast<double>(), plate)), 1e-9);
}

TEST(Scoring, PercentilesAreNearestRank) {
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.95), 5);
  EXPECT_EQ(percentile({7}, 0.01), 7);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

}  // namespace lf::app
