// One camera of the rig: where it stands, its rays, its sensor, and how radiance becomes grey levels.
#pragma once

#include "host_sim/optics/camera_rays.hpp"
#include "host_sim/optics/sensor.hpp"
#include "host_sim/optics/water.hpp"

namespace lf::optics {

// Grey levels of eight pixels in each channel; a mono camera has only the first.
using GreyLanes = std::array<Lanes, 3>;

struct Camera {
  // Throws what CameraRays throws.
  explicit Camera(const CameraConfig& camera);

  int width() const { return config.intrinsics.width; }
  int height() const { return config.intrinsics.height; }
  std::size_t channels() const { return config.colour ? 3 : 1; }
  RayPacket row(int u, int v) const { return rays.row(place, u, v); }
  RayLines lines(int u, int v) const { return rays.lines(place, u, v); }

  // The rays of half of pixel (u, v)'s 4x4 sub-pixels: two a row, column and diagonal, and the others.
  RayPacket sub_pixels(int u, int v, int half) const;

  GreyLanes grey(const RgbLanes& radiance) const;

  CameraConfig config;
  CameraPlace place;
  CameraRays rays;
  Sensor sensor;
};

}  // namespace lf::optics
