#include "firmware/scan/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lf::scan {
namespace {

// Camera at the base's origin looking along base x (its z), its x to the right (base y), its y down (base z).
CameraCalibration straight_camera() {
  CameraCalibration camera;
  camera.base_from_camera.linear().col(0) = Vec3::UnitY();
  camera.base_from_camera.linear().col(1) = Vec3::UnitZ();
  camera.base_from_camera.linear().col(2) = Vec3::UnitX();
  return camera;
}

// Emitter `below_m` under the camera, its fan forward, turned up by `pitch_rad`; x, the plane's normal, is up when level.
Pose laser_below(double below_m, double pitch_rad) {
  Pose pose = Pose::Identity();
  pose.translation() = Vec3(0, 0, below_m);
  pose.linear().col(0) = Vec3(-std::sin(pitch_rad), 0, -std::cos(pitch_rad));
  pose.linear().col(2) = Vec3(std::cos(pitch_rad), 0, -std::sin(pitch_rad));
  pose.linear().col(1) = pose.linear().col(2).cross(pose.linear().col(0));
  return pose;
}

TEST(Triangulation, IsTheTriangleOfTheTextbook) {
  const CameraCalibration camera = straight_camera();
  const Triangulator triangulator(camera, {}, {});
  const CameraIntrinsics& in = camera.intrinsics;
  for (double pitch : {0.0, 0.3, 0.6}) {
    // On the optical axis the range is baseline / tan(pitch); a level sheet is met at v where f b / (v - cy) is the range.
    const std::optional<Vec3> axis = triangulator.point({in.cx, in.cy}, laser_below(0.3, pitch));
    if (pitch > 0) {
      ASSERT_TRUE(axis);
      EXPECT_LT((*axis - Vec3(0.3 / std::tan(pitch), 0, 0)).norm(), 1e-12);
    }
  }
  const std::optional<Vec3> level = triangulator.point({in.cx + 100, in.cy + 200}, laser_below(0.3, 0));
  ASSERT_TRUE(level);
  const double range_m = in.fy * 0.3 / 200;
  EXPECT_LT((*level - Vec3(range_m, range_m * 100 / in.fx, 0.3)).norm(), 1e-12);
}

TEST(Triangulation, FindsThePointsThatAreSeen) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  CameraCalibration camera = straight_camera();
  camera.intrinsics.distortion = {-0.05, 0.02, 0.001, -0.0008, 0.003};
  const CameraModel model(camera.intrinsics);
  const Triangulator triangulator(camera, {}, {});
  int seen = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 3");
    const Pose laser = laser_below(0.3 + 0.05 * unit(random), 0.4 + 0.2 * unit(random));
    const Vec3 truth = laser * Vec3(0, 0.4 * unit(random), 0.7 + 0.2 * unit(random));
    const std::optional<Vec2> pixel = model.project(camera.base_from_camera.inverse() * truth);
    ASSERT_TRUE(pixel);
    const std::optional<Vec3> point = triangulator.point(*pixel, laser);
    if (std::abs(std::atan2((laser.inverse() * truth).y(), (laser.inverse() * truth).z())) > 0.69) continue;
    ASSERT_TRUE(point);
    EXPECT_LT((*point - truth).norm(), 1e-9);
    ++seen;
  }
  EXPECT_GT(seen, 250);
}

TEST(Triangulation, RefusesWhatIsNoStripe) {
  const CameraCalibration camera = straight_camera();
  const CameraIntrinsics& in = camera.intrinsics;
  const Triangulator triangulator(camera, {.fan_half_angle_rad = 0.5}, {});
  const Pose laser = laser_below(0.3, 0.3);
  EXPECT_TRUE(triangulator.point({in.cx, in.cy}, laser));
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, laser_below(0.3, 0.05))) << "grazing";
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, laser_below(-0.3, 0.3))) << "behind the camera";
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, laser_below(0.01, 0.3))) << "nearer than anything can be";
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, laser_below(0.9, 0.3))) << "beyond the range";
  EXPECT_FALSE(triangulator.point({in.cx + 300, in.cy}, laser)) << "beside the fan";
  EXPECT_FALSE(triangulator.point({std::numeric_limits<double>::quiet_NaN(), 0}, laser));
  Pose broken = laser;
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, broken));
  broken = laser;
  broken.linear()(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(triangulator.point({in.cx, in.cy}, broken));
}

}  // namespace
}  // namespace lf::scan
