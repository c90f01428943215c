#include "firmware/scan/camera_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

constexpr std::array<double, 5> mild{-0.05, 0.02, 0.001, -0.0008, 0.003};

CameraIntrinsics camera_with(const std::array<double, 5>& distortion) {
  CameraIntrinsics intrinsics;
  intrinsics.fy = 363.2;
  intrinsics.distortion = distortion;
  return intrinsics;
}

TEST(CameraModelRays, AreOpenCvsUndistortedPoints) {
  const CameraIntrinsics in = camera_with(mild);
  const CameraModel camera(in);
  const cv::Matx33d k(in.fx, 0, in.cx, 0, in.fy, in.cy, 0, 0, 1);
  std::vector<cv::Point2d> pixels, undistorted;
  for (int u = 0; u <= 640; u += 40)
    for (int v = 0; v <= 480; v += 40) pixels.emplace_back(u, v);
  cv::undistortPoints(pixels, undistorted, k, std::vector<double>(mild.begin(), mild.end()), cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-14));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::optional<Vec3> ray = camera.ray({pixels[i].x, pixels[i].y});
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->norm(), 1, 1e-14);
    EXPECT_NEAR(ray->x() / ray->z(), undistorted[i].x, 1e-9);
    EXPECT_NEAR(ray->y() / ray->z(), undistorted[i].y, 1e-9);
  }
}

TEST(CameraModelProjection, IsOpenCvs) {
  const CameraIntrinsics in = camera_with(mild);
  const CameraModel camera(in);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(unit(random), unit(random), 0.8 + unit(random));
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), cv::Matx33d(in.fx, 0, in.cx, 0, in.fy, in.cy, 0, 0, 1),
                    std::vector<double>(mild.begin(), mild.end()), pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<Vec2> pixel = camera.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), pixels[i].y, 1e-9);
  }
}

TEST(CameraModelStretch, IsTheAreaThatOpenCvImages) {
  const CameraModel camera(camera_with(mild));
  const auto imaged = [](const Vec2& at) {
    std::vector<cv::Point2d> image;
    cv::projectPoints(std::vector<cv::Point3d>{{at.x(), at.y(), 1}}, cv::Vec3d(), cv::Vec3d(), cv::Matx33d::eye(),
                      std::vector<double>(mild.begin(), mild.end()), image);
    return Vec2(image[0].x, image[0].y);
  };
  constexpr double step = 1e-5;
  for (double x = -1; x <= 1; x += 0.25) {
    for (double y = -1; y <= 1; y += 0.25) {
      const Vec2 by_x = (imaged({x + step, y}) - imaged({x - step, y})) / (2 * step),
                 by_y = (imaged({x, y + step}) - imaged({x, y - step})) / (2 * step);
      EXPECT_NEAR(camera.stretch({x, y}), by_x.x() * by_y.y() - by_x.y() * by_y.x(), 1e-8) << x << ", " << y;
    }
  }
}

TEST(CameraModelStretch, IsZeroWhereTheFoldBegins) {
  // r (1 - 0.2 r^2) turns back at r^2 = 1 / 0.6.
  const CameraModel camera(camera_with({-0.2, 0, 0, 0, 0}));
  const double fold = std::sqrt(1 / 0.6);
  EXPECT_GT(camera.stretch({fold - 1e-3, 0}), 0);
  EXPECT_NEAR(camera.stretch({0, fold}), 0, 1e-12);
  EXPECT_LT(camera.stretch({0, -fold - 1e-3}), 0);
}

TEST(CameraModelRays, ProjectBackToTheirPixels) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> share(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 2");
    const CameraModel camera(
        camera_with({0.08 * share(random), 0.03 * share(random), 0.002 * share(random), 0.002 * share(random), 0.005 * share(random)}));
    const Vec2 pixel(319.5 + 320 * share(random), 239.5 + 240 * share(random));
    const std::optional<Vec3> ray = camera.ray(pixel);
    ASSERT_TRUE(ray);
    const std::optional<Vec2> back = camera.project(*ray * 0.7);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - pixel).norm(), 1e-8);
  }
}

TEST(CameraModelRays, OfPixelsThatNothingIsImagedToDoNotExist) {
  const CameraModel folded(camera_with({-0.9, 0, 0, 0, 0}));  // r (1 - 0.9 r^2) never exceeds 0.41
  EXPECT_TRUE(folded.ray({319.5 + 30, 239.5}));
  EXPECT_FALSE(folded.ray({319.5 + 200, 239.5}));
  const CameraModel camera(camera_with(mild));
  EXPECT_FALSE(camera.ray({std::numeric_limits<double>::quiet_NaN(), 0}));
  EXPECT_FALSE(camera.ray({std::numeric_limits<double>::infinity(), 0}));
}

TEST(CameraModelProjection, OfPointsBehindTheCameraDoesNotExist) {
  const CameraModel camera(camera_with(mild));
  EXPECT_FALSE(camera.project({0, 0, -1}));
  EXPECT_FALSE(camera.project({0, 0, 0}));
  EXPECT_FALSE(camera.project({0, std::numeric_limits<double>::quiet_NaN(), 1}));
}

}  // namespace
}  // namespace lf::scan
