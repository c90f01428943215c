#include "host_sim/optics/shader.hpp"

namespace lf::optics {
namespace {

constexpr float one_over_pi = 0.318309886f;
constexpr float open_water_m = 1e6f;
const Vec3 up_in_base(0, 0, -1);

}  // namespace

// Downwelling light as a bright hemisphere above and a dim one below.
void Shader::add_ambient(const SurfacePacket& surface, RgbLanes& irradiance) const {
  const Lanes sky = 0.5f + 0.5f * dot(surface.normal, Lanes3(up_in_base));
  const Lanes weight = 0.1f + 0.9f * sky;
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] += water_.ambient_w_m2[band] * weight;
}

void Shader::add_lamps(const SurfacePacket& surface, Casters casters, RgbLanes& irradiance, Light& light) const {
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const RgbLanes falling = lamps[i].on_surface(surface, water_);
    const LaneMask reached = surface.met & ((falling[0] + falling[1] + falling[2]) > 0.f);
    LaneMask lit = reached;
    if (lamps[i].casts_shadows()) {
      lit = casters == Casters::all ? scene_.clear_of_all(lamps[i].position(), surface, reached)
                                    : scene_.clear_of_resting(lamps[i].position(), surface, reached);
    }
    light.reached |= reached & (1 << (16 + i));
    light.lit |= lit & (1 << (16 + i));
    for (std::size_t band = 0; band < 3; ++band) irradiance[band] += lit ? falling[band] : Lanes{};
  }
}

// The light of the open water that gathers along the ray, brighter upward.
void Shader::add_water(const RayPacket& rays, Lanes range, RgbLanes& radiance) const {
  const Lanes height = dot(rays.direction, Lanes3(up_in_base)) / CameraRays::slope(rays);
  const Lanes gradient = 1.f + 0.6f * height;
  for (std::size_t band = 0; band < 3; ++band)
    radiance[band] += water_.water_w_m2_sr[band] * gradient * (1.f - water_.broad_transmission(band, range));
}

// `irradiance` has the way back to the camera in it. Adds what comes back directly, and what scatters on that way.
void Shader::reflect(const RgbLanes& albedo, const RgbLanes& irradiance, Lanes range, RgbLanes& direct, RgbLanes& far) const {
  const Lanes unspread = water_.direct(range), scattered = water_.scattered(range);
  for (std::size_t band = 0; band < 3; ++band) {
    const Lanes light = albedo[band] * one_over_pi * irradiance[band];
    direct[band] += light * unspread;
    far[band] += light * scattered;
  }
}

Light Shader::base(const RayPacket& rays, const HitPacket& hit, float footprint, const HazePlace& haze, Casters casters) const {
  Light light;
  const SurfacePacket surface = make_surface(rays, hit);
  if (any(surface.met)) {
    RgbLanes irradiance{};
    add_ambient(surface, irradiance);
    add_lamps(surface, casters, irradiance, light);
    for (std::size_t band = 0; band < 3; ++band)
      irradiance[band] = surface.met ? irradiance[band] * water_.transmission(band, surface.range) : Lanes{};
    light.albedo = look_.albedo(surface, hit.shape, footprint);
    reflect(light.albedo, irradiance, surface.range, light.radiance, light.scattered);
  }
  const Lanes range = surface.met ? surface.range : all_lanes(open_water_m);
  add_water(rays, range, light.radiance);
  if (haze.row != nullptr) LampHaze::add(*haze.row, haze.u, haze.step, range, light.radiance);
  return light;
}

LaneMask Shader::unshaded(const RayPacket& rays, const HitPacket& hit, LaneMask lit) const {
  if (!any(lit)) return lit;
  const SurfacePacket surface = make_surface(rays, hit);
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    if (!lamps[i].casts_shadows()) continue;
    const LaneMask bit = LaneMask{} + (1 << (16 + i));
    const LaneMask wanted = (lit & bit) != 0;
    const LaneMask shaded = wanted & ~scene_.clear_of_moving(lamps[i].position(), surface, wanted);
    lit &= ~(shaded & bit);
  }
  return lit;
}

RgbLanes Shader::at(const Lanes3& point, float daylight_share) const {
  RgbLanes irradiance{};
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] = all_lanes(daylight_share * water_.ambient_w_m2[band]);
  const auto add = [&](const RgbLanes& light) {
    for (std::size_t band = 0; band < 3; ++band) irradiance[band] += light[band];
  };
  for (const SheetLight& sheet : sheets) add(sheet.at(point, water_));
  for (const SpotLight& lamp : lamps) add(lamp.at(point, water_));
  return irradiance;
}

Light Shader::stripes(const RayPacket& rays, const HitPacket& hit, float footprint, const RgbLanes* known_albedo, float blur_px) const {
  Light light;
  if (!any(hit.shape >= 0)) return light;
  const SurfacePacket surface = make_surface(rays, hit);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    StripePacket stripe = sheets[i].on_surface(surface, water_, footprint, blur_px);
    if (!any(stripe.reached | stripe.beside)) continue;
    const RgbLanes albedo = known_albedo != nullptr ? *known_albedo : look_.albedo(surface, hit.shape, footprint);
    if (any(stripe.beside)) reflect(albedo, stripe.skirt, surface.range, light.radiance, light.scattered);
    light.beside |= stripe.beside;
    if (!any(stripe.reached)) continue;
    const LaneMask lit = scene_.clear_of_all(sheets[i].emitter(), surface, stripe.reached);
    light.reached |= stripe.reached & (1 << i);
    light.lit |= lit & (1 << i);
    for (Lanes& band : stripe.irradiance) band = lit ? band : Lanes{};
    reflect(albedo, stripe.irradiance, surface.range, light.laser, light.scattered);
  }
  return light;
}

}  // namespace lf::optics
