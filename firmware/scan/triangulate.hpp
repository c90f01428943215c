// A stripe's pixel and the laser's plane make a point: the camera's ray crossed with the plane.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/scan/camera_model.hpp"
#include "shared/calibration/calibration.hpp"

namespace lf::scan {

class Triangulator {
 public:
  struct Config {
    double min_angle_rad = 0.10;    // between ray and laser plane: below, 0.1 px is more than 2.5 mm at 0.9 m
    double min_range_m = 0.10;      // from the camera: nearer is the arm itself or what drifts by
    double max_range_m = 2.0;       // farther is no panel within reach
    double fan_margin_rad = 0.035;  // beyond the fan's edge: light there is no stripe
    // The box of the base frame in which the panel can be: what is outside is the arm's own hand in the sheet, or nothing.
    Vec3 region_min_m{-1, -1, -1};
    Vec3 region_max_m{1, 1, 1.5};
  };

  Triangulator(const CameraCalibration& camera, const LaserCalibration& laser, const Config& config)
      : camera_(camera.intrinsics),
        base_from_camera_(camera.base_from_camera),
        fan_half_angle_rad_(laser.fan_half_angle_rad),
        config_(config) {}

  // The point seen at `pixel` (px) in the base frame (m), with the laser at `base_from_laser`.
  // Nothing where the ray grazes the plane, or meets it behind the camera, out of range, behind the emitter or beside the fan,
  // and where the point is outside the region.
  std::optional<Vec3> point(const Vec2& pixel, const Pose& base_from_laser) const;

 private:
  CameraModel camera_;
  Pose base_from_camera_;
  double fan_half_angle_rad_;
  Config config_;
};

}  // namespace lf::scan
