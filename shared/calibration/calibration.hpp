// What calibration says of the camera, the laser and the marker: plain numbers, read from YAML by the hosted side.
#pragma once

#include <array>
#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf {

// Pinhole in water with Brown-Conrady distortion (k1 k2 p1 p2 k3), OpenCV's model and order.
struct CameraIntrinsics {
  std::int32_t width = 640;
  std::int32_t height = 480;
  double fx = 361.7, fy = 361.7;  // px; 83 degrees of horizontal field of view in water
  double cx = 319.5, cy = 239.5;  // px, pixel centres at integers
  std::array<double, 5> distortion{};
};

struct CameraCalibration {
  CameraIntrinsics intrinsics;
  Pose base_from_camera = Pose::Identity();
  Duration exposure = Duration::from_us(2000);
};

// The laser moves with the forearm: its pose is given in the tool frame at roll 0 and is carried by slew, shoulder and elbow only.
struct LaserCalibration {
  Pose tool_from_laser = Pose::Identity();
  double fan_half_angle_rad = 0.70;
};

struct MarkerCalibration {
  std::int32_t id = 0;                     // AprilTag 36h11
  double size_m = 0.080;                   // side of the black square
  Pose panel_from_tag = Pose::Identity();  // surveyed
};
using MarkerCalibrations = StaticVector<MarkerCalibration, PanelLayout::max_markers>;

}  // namespace lf
