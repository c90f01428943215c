// A lamp's light on surfaces, and the haze that all lamps raise in the water before the camera.
#pragma once

#include <vector>

#include "host_sim/optics/surface.hpp"
#include "host_sim/optics/water.hpp"

namespace lf::optics {

class SpotLight {
 public:
  // `share`: of the exposure during which it is on.
  SpotLight(const LampConfig& config, const Pose& base_from_body, float share = 1);

  // The share of the lamp's full intensity that leaves it toward a point.
  Lanes cone_weight(const Lanes3& beam, Lanes range_m) const;

  // Irradiance (W/m2) of a surface before occlusion, attenuated on the way there.
  RgbLanes on_surface(const SurfacePacket& surface, const Water& water) const;

  // Of something small that faces the lamp.
  RgbLanes at(const Lanes3& point, const Water& water) const;

  // Radiance scattered toward `origin` by a metre of water at `point`, 1/m, attenuated on both ways.
  RgbLanes scattered(const Lanes3& point, const Lanes3& unit_direction, Lanes camera_range_m, const Water& water) const;

  const Lanes3& position() const { return position_; }
  Vec3 place_m() const { return {position_.x[0], position_.y[0], position_.z[0]}; }
  bool casts_shadows() const { return casts_shadows_; }

 private:
  Lanes3 position_, axis_;
  Rgb intensity_w_sr_;
  float cos_outer_, cos_inner_;
  bool casts_shadows_;
};

// Single scattering of the lamps along the camera's rays, summed up to some 24 ranges on a grid of every 16th pixel and interpolated: it is smooth.
// Surfaces' shadows in the water are left out.
class LampHaze {
 public:
  static constexpr int spacing_px = 16;
  static constexpr int knots = 24;

  LampHaze(const CameraRays& rays, const CameraPlace& place, int width, int height, const std::vector<SpotLight>& lamps,
           const Water& water);

  // The grid brought to one row of pixels: [column node][band][knot].
  std::vector<float> row(int v) const;

  // Adds the haze of pixels u .. u + 7 (or of one pixel, `step` 0) up to `range_m`.
  static void add(const std::vector<float>& row, float u, float step, Lanes range_m, RgbLanes& radiance);

 private:
  int columns_ = 0, rows_ = 0;
  std::vector<float> sums_;  // [row node][column node][band][knot]
};

}  // namespace lf::optics
