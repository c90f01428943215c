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

TEST(Scoring, PeaksAreHeldAgainstTheRenderedStripe) {
  optics::Frame frame;
  frame.width = 4;
  frame.height = 100;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.stripe_v = {50, 51, nan, 53};
  frame.stripe_grey = {100, 100, 100, 3};  // the last is too faint to count
  frame.pieces = {{0, 0, 50, 100}, {0, 1, 51, 100}, {0, 3, 53, 3}};
  PeakScore score;
  const scan::Peak peaks[] = {{0, 50.3f, 100, 0, 0}, {1, 80.0f, 100, 0, 0}, {2, 10.0f, 100, 0, 0}};
  score.add(frame, peaks);
  EXPECT_EQ(score.visible(), 2u);
  EXPECT_NEAR(score.recall(), 0.5, 1e-12) << "29 px off is another thing";
  EXPECT_NEAR(score.rms_px(), 0.3, 1e-6);
  EXPECT_EQ(score.false_peaks(), 2u);
  EXPECT_NEAR(score.false_share(), 2.0 / 3, 1e-12);
}

// A column with a bright piece on a button and a faint one on the panel; beside it none, but a lens's light of the bright one.
TEST(Scoring, APeakOnAnotherPieceIsNeitherFalseNorTheOneThatCounts) {
  optics::Frame frame;
  frame.width = 8;
  frame.height = 100;
  frame.stripe_v.assign(8, std::numeric_limits<float>::quiet_NaN());
  frame.stripe_grey.assign(8, 0);
  frame.stripe_v[3] = 40, frame.stripe_grey[3] = 100;
  frame.pieces = {{0, 3, 40, 100}, {0, 3, 60, 30}};
  PeakScore other, both, beside;
  other.add(frame, std::vector<scan::Peak>{{3, 60.2f, 30, 0, 0}});
  EXPECT_EQ(other.recall(), 0);
  EXPECT_EQ(other.elsewhere_share(), 1);
  EXPECT_EQ(other.false_peaks(), 0u);
  EXPECT_NEAR(other.rms_px(), 0.2, 1e-5);
  both.add(frame, std::vector<scan::Peak>{{3, 40.1f, 100, 0, 0}, {3, 60.2f, 30, 0, 0}, {3, 80, 30, 0, 0}});
  EXPECT_EQ(both.recall(), 1);
  EXPECT_EQ(both.elsewhere_share(), 0);
  EXPECT_EQ(both.false_peaks(), 1u);
  beside.add(frame, std::vector<scan::Peak>{{5, 40.5f, 20, 0, 0}, {6, 40.5f, 20, 0, 0}});
  EXPECT_EQ(beside.false_peaks(), 1u) << "three columns off no light of it is left";
  EXPECT_EQ(beside.recall(), 0);
}

TEST(Scoring, PeaksAtAStepOfDepthAreScoredApartFromThoseOnASmoothSurface) {
  optics::Frame frame;
  frame.width = 60;
  frame.height = 60;
  frame.stripe_v.assign(60, 30);
  frame.stripe_grey.assign(60, 100);
  frame.depth_m.resize(3600);
  // A slope, and beyond column 30 another thing 50 mm nearer.
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 60; ++u)
      frame.depth_m[static_cast<std::size_t>(v * 60 + u)] = 1 + 0.004f * static_cast<float>(v) - (u > 30 ? 0.05f : 0);
  }
  for (int u = 0; u < 60; ++u) frame.pieces.push_back({0, u, 30, 100});
  std::vector<scan::Peak> peaks;
  for (int u = 0; u < 60; ++u) peaks.push_back({static_cast<float>(u), u > 25 && u < 36 ? 31.0f : 30.1f, 100, 0, 0});
  PeakScore score;
  score.add(frame, peaks);
  EXPECT_NEAR(score.smooth_rms_px(), 0.1, 1e-5);
  EXPECT_NEAR(score.rms_px(), std::sqrt((10 * 1.0 + 50 * 0.01) / 60), 1e-5);
}

TEST(Scoring, PercentilesAreNearestRank) {
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.95), 5);
  EXPECT_EQ(percentile({7}, 0.01), 7);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

}  // namespace lf::app
