// One packet of rays from geometry to light: what the camera's rays meet, what lights it, and what the water adds and takes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host_sim/optics/ray_scene.hpp"
#include "host_sim/optics/sheet_light.hpp"
#include "host_sim/optics/spot_light.hpp"
#include "host_sim/optics/surface_look.hpp"

namespace lf::optics {

// A sampled packet. Bit i of `reached` says that light i could reach the lane, of `lit` that it does: lasers from bit 0, lamps from bit 16.
struct Sample {
  HitPacket hit;
  LaneMask reached{}, lit{};
  RgbLanes radiance{};
};

// All that lights one frame.
class Shader {
 public:
  Shader(const RayScene& scene, const SurfaceLook& look, const Water& water) : scene_(scene), look_(look), water_(water) {}

  // `haze_row` is the lamps' haze along the packet's row, from pixel `u` on in steps of `u_step`; nullptr without lamps.
  Sample sample(const RayPacket& rays, float footprint, float blur_px, const std::vector<float>* haze_row, float u, float u_step) const;

  // Which of the wanted lanes see the light, nothing in between.
  LaneMask visible_from(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const;

  const RayScene& scene() const { return scene_; }
  const SurfaceLook& look() const { return look_; }
  const Water& water() const { return water_; }

  std::vector<SheetLight> sheets;
  std::vector<SpotLight> lamps;

 private:
  void add_ambient(const SurfacePacket& surface, RgbLanes& irradiance) const;
  void add_lamps(const SurfacePacket& surface, RgbLanes& irradiance, Sample& sample) const;
  void add_sheets(const SurfacePacket& surface, const RgbLanes& albedo, float footprint, float blur_px, Sample& sample) const;
  void add_water(const RayPacket& rays, Lanes range, RgbLanes& radiance) const;

  const RayScene& scene_;
  const SurfaceLook& look_;
  const Water& water_;
};

inline constexpr float near_m = 0.03f;  // closer to a camera or a light is its own housing

}  // namespace lf::optics
