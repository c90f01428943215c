// From geometry to light: what falls on the surfaces that a packet of rays meets, and what the water adds and takes.
//
// The base light (ambient light, lamps and their haze, the water's own colour) changes only with the bodies and the lamps; the laser light (the sheets'
// stripes on the surfaces and their glow in the water) with every move of the arm.
#pragma once

#include <vector>

#include "host_sim/optics/light.hpp"
#include "host_sim/optics/sheet_light.hpp"
#include "host_sim/optics/split_scene.hpp"
#include "host_sim/optics/spot_light.hpp"
#include "host_sim/optics/surface_look.hpp"

namespace lf::optics {

// The lamps' haze along a packet of rays: a row of its grid, and where in the row the first lane lies and how far it is to the next.
struct HazePlace {
  const std::vector<float>* row = nullptr;  // without lamps none
  float u = 0, step = 0;
};

enum class Casters { resting, all };  // the bodies whose shadows count

// All that lights one frame.
class Shader {
 public:
  Shader(const SplitScene& scene, const SurfaceLook& look, const Water& water) : scene_(scene), look_(look), water_(water) {}

  // `footprint`: side of the sample's square, px (1, or 1/4 for sub-pixels).
  Light base(const RayPacket& rays, const HitPacket& hit, float footprint, const HazePlace& haze, Casters casters) const;
  // Of `lit`, bits of lamps that light resting surfaces, those that no moving body shades.
  LaneMask unshaded(const RayPacket& rays, const HitPacket& hit, LaneMask lit) const;

  // `albedo`: of what `hit` has at this footprint, where it is known. `blur_px` as SheetLight::on_surface has it.
  Light stripes(const RayPacket& rays, const HitPacket& hit, float footprint, const RgbLanes* albedo = nullptr, float blur_px = 0) const;

  // Irradiance of something small in the water that faces the lights, W/m2: lasers' lines, lamps without shadows, and a share of the daylight.
  RgbLanes at(const Lanes3& point, float daylight_share) const;

  const SplitScene& scene() const { return scene_; }
  const SurfaceLook& look() const { return look_; }
  const Water& water() const { return water_; }

  std::vector<SheetLight> sheets;
  std::vector<SpotLight> lamps;

 private:
  void add_ambient(const SurfacePacket& surface, RgbLanes& irradiance) const;
  void add_lamps(const SurfacePacket& surface, Casters casters, RgbLanes& irradiance, Light& light) const;
  void add_water(const RayPacket& rays, Lanes range, RgbLanes& radiance) const;
  void reflect(const RgbLanes& albedo, const RgbLanes& irradiance, Lanes range, RgbLanes& direct, RgbLanes& far) const;

  const SplitScene& scene_;
  const SurfaceLook& look_;
  const Water& water_;
};

}  // namespace lf::optics
