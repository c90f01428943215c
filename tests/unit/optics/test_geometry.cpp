#include <gtest/gtest.h>

#include <limits>

#include "host_sim/optics/tessellation.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

Frame truth_of(const scene::Scene& scene, const scene::BodyPoses& poses) {
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.scene = scene;
  Optics optics(config);
  Shot shot;
  shot.poses = poses;
  shot.truth = true;
  Frame frame;
  optics.render(shot, frame);
  return frame;
}

// Pixel (u, v)'s direction in the base frame of the test camera, with depth 1.
Vec3 direction(int u, int v) {
  const CameraIntrinsics k;
  return looking(Vec3::Zero(), Vec3::UnitX()).linear() * Vec3((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1);
}

TEST(Geometry, DepthOfATiltedPlateIsThatOfItsPlane) {
  scene::BodyPoses poses = resting();
  Pose& panel = poses[arm5e_body::panel];
  panel.linear() = (Eigen::AngleAxisd(0.4, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.2, Vec3::UnitY())).toRotationMatrix();
  panel.translation() = Vec3(0.05, -0.02, 0.03);
  const Frame frame = truth_of(plate_scene(0.8), poses);
  const Vec3 normal = panel.linear().col(0), on_plane = panel * Vec3(0.8, 0, 0);
  for (int v = 180; v < 320; v += 13) {
    for (int u = 240; u < 400; u += 11) {
      const double expected = normal.dot(on_plane) / normal.dot(direction(u, v));
      EXPECT_NEAR(frame.depth_m[static_cast<std::size_t>(v * 640 + u)], expected, 1e-6) << u << " " << v;
      EXPECT_EQ(frame.object[static_cast<std::size_t>(v * 640 + u)], 1 + int(arm5e_body::panel));
    }
  }
}

TEST(Geometry, DepthOfACylinderIsThatOfItsQuadricWithin60Micrometres) {
  scene::Scene scene = scene::bare_scene();
  scene[arm5e_body::first_feature].shapes.push_back(make_shape(scene::ShapeKind::cylinder, {0.03, 0, 0.4}, {0.6, 0, 0}));
  const Frame frame = truth_of(scene, resting());
  int hits = 0;
  for (int v = 150; v < 330; v += 10) {
    for (int u = 290; u < 350; ++u) {
      const Vec3 d = direction(u, v);
      const double a = d.x() * d.x() + d.y() * d.y(), b = -0.6 * d.x(), c = 0.36 - 0.03 * 0.03, root = b * b - a * c;
      if (root < 2e-5) continue;  // the limb, where depth is steep
      const double expected = (-b - std::sqrt(root)) / a;
      EXPECT_NEAR(frame.depth_m[static_cast<std::size_t>(v * 640 + u)], expected, 60e-6) << u << " " << v;
      ++hits;
    }
  }
  EXPECT_GT(hits, 400);
}

TEST(Geometry, TessellationStaysWithin20MicrometresOfCylindersAnd60OfSpheres) {
  for (const double radius : {0.004, 0.008, 0.02, 0.033}) {
    for (const auto kind : {scene::ShapeKind::cylinder, scene::ShapeKind::capsule, scene::ShapeKind::sphere}) {
      const TriangleMesh mesh = tessellate(make_shape(kind, {radius, 0, 0.1}, Vec3::Zero()));
      double worst = 0;
      for (const auto& triangle : mesh.triangles) {
        Vec3 middle = Vec3::Zero();
        for (const auto i : triangle) middle += Vec3(mesh.vertices_m[i][0], mesh.vertices_m[i][1], mesh.vertices_m[i][2]) / 3;
        const double half = kind == scene::ShapeKind::sphere ? 0 : 0.05;
        if (kind == scene::ShapeKind::cylinder && std::abs(std::abs(middle.z()) - half) < 1e-6) continue;  // the flat ends
        const double beyond = std::max(std::abs(middle.z()) - half, 0.0);
        const double distance = kind == scene::ShapeKind::cylinder ? middle.head<2>().norm() : Vec3(middle.x(), middle.y(), beyond).norm();
        worst = std::max(worst, std::abs(distance - radius));
      }
      EXPECT_LT(worst, kind == scene::ShapeKind::cylinder ? 20e-6 : 60e-6) << radius;  // facets of a sphere sag in two directions
    }
  }
}

TEST(Geometry, AMeshIsDrawnWhereItsTrianglesAre) {
  scene::Scene scene = scene::bare_scene();
  scene::Shape mesh = make_shape(scene::ShapeKind::mesh, Vec3::Zero(), {0.5, 0, 0});
  mesh.vertices_m = {{0, -0.1, -0.1}, {0, 0.1, -0.1}, {0, 0, 0.1}};
  mesh.triangles = {{0, 1, 2}};
  scene[arm5e_body::first_feature].shapes.push_back(mesh);
  const Frame frame = truth_of(scene, resting());
  EXPECT_NEAR(frame.depth_m[240 * 640 + 320], 0.5, 1e-6);
  EXPECT_EQ(frame.depth_m[400 * 640 + 100], std::numeric_limits<float>::infinity());
  EXPECT_EQ(frame.object[400 * 640 + 100], 0);
}

TEST(Geometry, RefusesShapesThatMakeNoSense) {
  EXPECT_THROW(tessellate(make_shape(scene::ShapeKind::box, {0.1, 0, 0.1}, Vec3::Zero())), InputError);
  EXPECT_THROW(tessellate(make_shape(scene::ShapeKind::sphere, {std::nan(""), 0, 0}, Vec3::Zero())), InputError);
  scene::Shape mesh = make_shape(scene::ShapeKind::mesh, Vec3::Zero(), Vec3::Zero());
  mesh.vertices_m = {Vec3::Zero()};
  mesh.triangles = {{0, 0, 1}};
  EXPECT_THROW(tessellate(mesh), InputError);
}

}  // namespace
}  // namespace lf::optics::test
