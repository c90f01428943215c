#include "host_sim/optics/shader.hpp"

#include <limits>

namespace lf::optics {
namespace {

constexpr float one_over_pi = 0.318309886f;
const Vec3 up_in_base(0, 0, -1);

}  // namespace

LaneMask Shader::visible_from(const Lanes3& light, const SurfacePacket& surface, LaneMask wanted) const {
  if (!any(wanted)) return wanted;
  const Lanes3 start = off_surface(surface);
  const Lanes3 way = light - start;
  const Lanes far = max(1.f - near_m / max(norm(way), all_lanes(1e-3f)), Lanes{});
  return wanted & ~scene_.occluded(wanted, start, way, far);
}

// Downwelling light as a bright hemisphere above and a dim one below.
void Shader::add_ambient(const SurfacePacket& surface, RgbLanes& irradiance) const {
  const Lanes sky = 0.5f + 0.5f * dot(surface.normal, Lanes3(up_in_base));
  const Lanes weight = 0.1f + 0.9f * sky;
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] += water_.ambient_w_m2[band] * weight;
}

void Shader::add_lamps(const SurfacePacket& surface, RgbLanes& irradiance, Sample& sample) const {
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const RgbLanes light = lamps[i].on_surface(surface, water_);
    const LaneMask reached = surface.met & ((light[0] + light[1] + light[2]) > 0.f);
    const LaneMask lit = lamps[i].casts_shadows() ? visible_from(lamps[i].position(), surface, reached) : reached;
    sample.reached |= reached & (1 << (16 + i));
    sample.lit |= lit & (1 << (16 + i));
    for (std::size_t band = 0; band < 3; ++band) irradiance[band] += lit ? light[band] : Lanes{};
  }
}

void Shader::add_sheets(const SurfacePacket& surface, const RgbLanes& albedo, float footprint, float blur_px, Sample& sample) const {
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const StripePacket stripe = sheets[i].on_surface(surface, water_, footprint, blur_px);
    if (!any(stripe.reached)) continue;
    const LaneMask lit = visible_from(sheets[i].emitter(), surface, stripe.reached);
    sample.reached |= stripe.reached & (1 << i);
    sample.lit |= lit & (1 << i);
    for (std::size_t band = 0; band < 3; ++band) {
      const Lanes light = albedo[band] * one_over_pi * stripe.irradiance[band];
      sample.radiance[band] += lit ? light : Lanes{};
    }
  }
}

// The light of the open water that gathers along the ray, brighter upward.
void Shader::add_water(const RayPacket& rays, Lanes range, RgbLanes& radiance) const {
  const Lanes height = dot(rays.direction, Lanes3(up_in_base)) / CameraRays::slope(rays);
  const Lanes gradient = 1.f + 0.6f * height;
  for (std::size_t band = 0; band < 3; ++band)
    radiance[band] += water_.water_w_m2_sr[band] * gradient * (1.f - water_.transmission(band, range));
}

Sample Shader::sample(const RayPacket& rays, float footprint, float blur_px, const std::vector<float>* haze_row, float u,
                      float u_step) const {
  Sample sample;
  sample.hit = scene_.intersect(rays.origin, rays.direction, near_m);
  const SurfacePacket surface = make_surface(rays, sample.hit);
  const RgbLanes albedo = look_.albedo(surface, sample.hit.shape, footprint);
  if (any(surface.met)) {
    RgbLanes irradiance{};
    add_ambient(surface, irradiance);
    add_lamps(surface, irradiance, sample);
    for (std::size_t band = 0; band < 3; ++band) {
      sample.radiance[band] = albedo[band] * one_over_pi * irradiance[band] * water_.transmission(band, surface.range);
    }
    add_sheets(surface, albedo, footprint, blur_px, sample);
  }
  const Lanes range = surface.met ? surface.range : all_lanes(1e6f);
  add_water(rays, range, sample.radiance);
  for (const SheetLight& sheet : sheets) sheet.add_backscatter(rays, range, water_, sample.radiance);
  if (haze_row != nullptr) LampHaze::add(*haze_row, u, u_step, range, sample.radiance);
  return sample;
}

}  // namespace lf::optics
