// Pictures of a marker with a known pose: each pixel on an edge the mean of 8 x 8 rays, so that edges fall where they should to a hundredth of a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/calibration/calibration.hpp"
#include "shared/messages/image.hpp"

namespace lf::vision::test {

struct RenderedMarker {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  std::array<Vec2, 4> corners_px;  // true ones, counter-clockwise from the bottom left

  ImageView view() const { return {pixels.data(), width, height, width}; }
};

struct MarkerScene {
  CameraIntrinsics camera;
  Pose camera_from_tag = Pose::Identity();
  std::int32_t id = 7;
  double size_m = 0.080;
  double plate_m = 0.100;  // white, around the black square
  double black = 40, white = 200, surround = 110;
  double noise_grey = 0;  // standard deviation
  std::uint32_t seed = 1;
};

// Undistorted pinhole only: a pixel's ray is ((u - cx) / fx, (v - cy) / fy, 1). The bits are those of OpenCV's dictionary, half a turn on.
RenderedMarker render_marker(const MarkerScene& scene);

// A pose `distance_m` away, the marker seen by `tilt_rad` about the axis at `tilt_axis_rad` in its plane, and turned by `turn_rad`.
Pose looking_at_marker(double distance_m, double tilt_rad, double tilt_axis_rad, double turn_rad, const Vec2& offset_m = Vec2::Zero());

}  // namespace lf::vision::test
