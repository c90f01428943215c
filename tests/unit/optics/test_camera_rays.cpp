#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "host_sim/optics/camera_rays.hpp"
#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

CameraIntrinsics distorted_camera() {
  CameraIntrinsics k;
  k.fx = 362.3, k.fy = 361.1, k.cx = 322.4, k.cy = 236.9;
  k.distortion = {-0.12, 0.05, 0.0012, -0.0007, -0.01};
  return k;
}

TEST(CameraRays, ProjectedBackByOpenCvEveryRayComesBackToItsPixel) {
  const CameraIntrinsics k = distorted_camera();
  const cv::Matx33d matrix(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const std::vector<double> coefficients(k.distortion.begin(), k.distortion.end());
  for (int v = 0; v < k.height; v += 37) {
    for (int u = 0; u < k.width; u += 41) {
      const auto ray = camera_ray(k, std::nullopt, u, v);
      ASSERT_TRUE(ray.has_value());
      std::vector<cv::Point2d> image;
      cv::projectPoints(std::vector<cv::Point3d>{{ray->direction.x(), ray->direction.y(), 1.0}}, cv::Vec3d(), cv::Vec3d(), matrix,
                        coefficients, image);
      EXPECT_NEAR(image[0].x, u, 1e-9);
      EXPECT_NEAR(image[0].y, v, 1e-9);
    }
  }
}

TEST(CameraRays, AgreeWithOpenCvsUndistortion) {
  const CameraIntrinsics k = distorted_camera();
  const cv::Matx33d matrix(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const std::vector<double> coefficients(k.distortion.begin(), k.distortion.end());
  const unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 639), v(0, 479);
  for (int i = 0; i < 200; ++i) {
    const cv::Point2d pixel(u(random), v(random));
    std::vector<cv::Point2d> normalised;
    cv::undistortPoints(std::vector<cv::Point2d>{pixel}, normalised, matrix, coefficients, cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-14));
    const auto ray = camera_ray(k, std::nullopt, pixel.x, pixel.y);
    ASSERT_TRUE(ray.has_value());
    EXPECT_NEAR(ray->direction.x(), normalised[0].x, 1e-8);
    EXPECT_NEAR(ray->direction.y(), normalised[0].y, 1e-8);
  }
}

TEST(CameraRays, TableInSinglePrecisionFollowsTheExactRaysBetweenPixelsToo) {
  const CameraIntrinsics k = distorted_camera();
  const CameraRays rays(k, std::nullopt);
  const CameraPlace place(Pose::Identity());
  for (int v = 0; v < k.height; v += 53) {
    for (int u = 0; u < k.width; u += 47) {
      Lanes offset_u, offset_v;
      for (int i = 0; i < lane_count; ++i)
        offset_u[i] = 0.13f * static_cast<float>(i) - 0.5f, offset_v[i] = 0.5f - 0.12f * static_cast<float>(i);
      const RayPacket packet = rays.around(place, u, v, offset_u, offset_v);
      for (int i = 0; i < lane_count; ++i) {
        const auto exact = camera_ray(k, std::nullopt, u + offset_u[i], v + offset_v[i]);
        EXPECT_NEAR(packet.direction.x[i], exact->direction.x(), 1e-6);  // 4e-4 px
        EXPECT_NEAR(packet.direction.y[i], exact->direction.y(), 1e-6);
      }
    }
  }
}

TEST(CameraRays, BendAtAFlatPortByTheClosedFormOfSnellsLaw) {
  CameraIntrinsics k;
  k.fx = k.fy = 500;
  const FlatPort port{.distance_m = 0.025, .thickness_m = 0.012, .glass_index = 1.49, .water_index = 1.34};
  for (const double u : {0.0, 100.0, 319.5, 500.0, 639.0}) {
    for (const double v : {0.0, 239.5, 400.0}) {
      const auto ray = camera_ray(k, port, u, v);
      ASSERT_TRUE(ray.has_value());
      const double x = (u - k.cx) / k.fx, y = (v - k.cy) / k.fy, radius = std::hypot(x, y);
      const double in_air = std::atan(radius), in_glass = std::asin(std::sin(in_air) / 1.49), in_water = std::asin(std::sin(in_air) / 1.34);
      const double out_at = port.distance_m * std::tan(in_air) + port.thickness_m * std::tan(in_glass);
      EXPECT_NEAR(ray->origin.z(), 0.037, 1e-12);
      EXPECT_NEAR(ray->origin.head<2>().norm(), out_at, 1e-12);
      EXPECT_NEAR(ray->direction.head<2>().norm(), std::tan(in_water), 1e-12);
      if (radius > 0) {
        EXPECT_NEAR(ray->direction.x() * y, ray->direction.y() * x, 1e-12);  // stays in the plane of incidence
      }
    }
  }
}

TEST(CameraRays, ThroughThePortAxisTheFocalLengthGrowsByTheWatersIndex) {
  CameraIntrinsics k;
  const auto ray = camera_ray(k, FlatPort{}, k.cx + 1.0, k.cy);
  EXPECT_NEAR(ray->direction.x(), 1.0 / (k.fx * 1.34), 1e-8);
}

TEST(CameraRays, RefuseADistortionThatFoldsTheImageOver) {
  CameraIntrinsics k;
  k.distortion = {-1.5, 0, 0, 0, 0};
  EXPECT_THROW(CameraRays(k, std::nullopt), InputError);
}

}  // namespace
}  // namespace lf::optics
