#include "host_sim/app/scoring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(Scoring, PercentilesAreNearestRank) {
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.95), 5);
  EXPECT_EQ(percentile({7}, 0.01), 7);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

}  // namespace lf::app
