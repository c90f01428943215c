// The docked robot's camera and laser at their nominal places, and docking errors, for the scan's tests.
#pragma once

#include <random>

#include "shared/calibration/calibration.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::test {

inline CameraCalibration nominal_camera() {
  CameraCalibration camera;
  const Vec3 axis = Vec3(0.678, 0.257, 0.688).normalized();  // 43.5 degrees down, 20.75 to the right
  const Vec3 right = Vec3::UnitZ().cross(axis).normalized();
  camera.base_from_camera.linear().col(0) = right;
  camera.base_from_camera.linear().col(1) = axis.cross(right);
  camera.base_from_camera.linear().col(2) = axis;
  camera.base_from_camera.translation() = Vec3(0.015, -0.245, 0.060);
  return camera;
}

inline LaserCalibration nominal_laser() {
  LaserCalibration laser;
  laser.tool_from_laser.translation() = Vec3(-0.090, 0, -0.365);
  return laser;
}

// The nominal panel shifted along the base's axes and turned about them at its origin, uniformly within the given bounds.
template <class Random>
Pose docked_panel(Random& random, double shift_m, double turn_rad) {
  std::uniform_real_distribution<double> share(-1, 1);
  Pose pose = PanelLayout{}.nominal_base_from_panel();
  const Vec3 turn = turn_rad * Vec3(share(random), share(random), share(random));
  pose.translation() += shift_m * Vec3(share(random), share(random), share(random));
  pose.linear() =
      (Eigen::AngleAxisd(turn.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(turn.y(), Vec3::UnitY()) * Eigen::AngleAxisd(turn.x(), Vec3::UnitX()))
          .toRotationMatrix() *
      pose.linear();
  return pose;
}

}  // namespace lf::test
