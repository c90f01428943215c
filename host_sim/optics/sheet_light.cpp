#include "host_sim/optics/sheet_light.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

constexpr float root_two_pi = 2.50662827f;
constexpr float fan_edge = 0.01f;              // the fan's ends fade over this much of tan(angle)
constexpr float core_reach = 4.5f;             // standard deviations: 4e-5 of the peak
constexpr float lobe_reach = 3.6f;             // the same of a lobe of 3 %
constexpr float skirt_reach_rad = 3 * 0.088f;  // the widest Gaussian but one; of the widest 5e-4 of the peak is left there at 0.8 1/m
constexpr int end_count = 512;
constexpr float least_range_m = 0.02f;  // nothing is lit closer to the emitter

// A Gaussian of unit height, integrated over a pixel (box) of the given extents along and across its gradient.
// The wide side is integrated exactly, the narrow one by its variance; `sigma` includes all blur, `height` undoes the widening.
Lanes box_gaussian(Lanes offset, Lanes own_sigma, Lanes sigma, Lanes box) {
  const Lanes half = max(0.5f * box, all_lanes(1e-3f));
  return root_two_pi * own_sigma * (normal_cdf((offset + half) / sigma) - normal_cdf((offset - half) / sigma)) / (2.f * half);
}

}  // namespace

SheetLight::SheetLight(const LaserConfig& config, const Pose& base_from_body, const std::optional<PatternTable>& pattern, float share)
    : tan_half_fan_(static_cast<float>(std::tan(config.fan_half_angle_rad))),
      w_per_rad_(share * static_cast<float>(config.power_w / (2 * config.fan_half_angle_rad))),
      waist_m_(static_cast<float>(config.waist_sigma_m)),
      divergence_rad_(static_cast<float>(config.divergence_rad)),
      waist_at_m_(static_cast<float>(config.waist_at_m)),
      lobe_share_(static_cast<float>(config.lobe_share)),
      lobe_sigmas_(static_cast<float>(config.lobe_sigmas)),
      reach_sigmas_(config.lobe_share > 0 ? std::max(core_reach, std::abs(lobe_sigmas_) + lobe_reach) : core_reach),
      tan_cone_(static_cast<float>(std::tan(config.cone_rad))),
      cos_cone_(static_cast<float>(std::cos(config.cone_rad))),
      power_w_(share * config.power_w),
      band_(config.band),
      pattern_(pattern),
      fan_profile_(config.fan_profile) {
  const Pose base_from_laser = base_from_body * config.body_from_laser;
  base_from_laser_ = Rotation(base_from_laser.linear());
  emitter_m_ = base_from_laser.translation();
  emitter_ = Lanes3(emitter_m_);
  laser_from_base_ = base_from_laser.inverse();
}

void SheetLight::meet(const SplitScene& scene) {
  if (pattern_.has_value()) return;
  ends_m_.resize(end_count);
  for (int first = 0; first < end_count; first += lane_count) {
    Lanes tangent;
    for (int lane = 0; lane < lane_count; ++lane)
      tangent[lane] = tan_half_fan_ * (2.f * static_cast<float>(first + lane) / (end_count - 1) - 1.f);
    const Lanes radius = sqrt(1.f + tangent * tangent);
    const RayLines rays{emitter_, base_from_laser_ * Lanes3(tan_cone_ * radius, tangent, all_lanes(1.f))};
    store_lanes(ends_m_.data() + first, scene.all(rays).parameter * CameraRays::slope(rays));
  }
}

double SheetLight::off_m(const Vec3& place) const { return place.x() - static_cast<double>(tan_cone_) * std::hypot(place.y(), place.z()); }

double SheetLight::sigma_m(const Vec3& place) const {
  return std::sqrt(static_cast<double>(sigma2_m2(all_lanes(static_cast<float>(place.norm())))[0]));
}

bool SheetLight::reaches(const Vec3& point, double margin_m) const {
  const Vec3 place = laser_from_base_ * point;
  const double off = std::abs(off_m(place)) - margin_m;
  return off < 0 || off < static_cast<double>(core_reach) * sigma_m(place);
}

void SheetLight::shade_by(const std::vector<Speck>& specks) {
  if (pattern_.has_value()) return;
  std::vector<SheetShadows::Caster> casters;
  for (const Speck& speck : specks) {
    const Vec3 place = laser_from_base_ * speck.place_m;
    if (place.z() < static_cast<double>(least_range_m)) continue;
    const double sigma = sigma_m(place), radius = 0.5 * speck.diameter_m;
    casters.push_back({static_cast<float>(place.y() / place.z()), static_cast<float>(off_m(place) / sigma),
                       static_cast<float>(radius / place.z()), static_cast<float>(radius / sigma), static_cast<float>(place.norm())});
  }
  shadows_.emplace(std::move(casters), tan_half_fan_);
}

Lanes SheetLight::end_m(Lanes y, Lanes z) const {
  constexpr float endless_m = 1e6f;
  if (ends_m_.empty()) return all_lanes(endless_m);
  const Lanes share = 0.5f + 0.5f * y / (max(z, all_lanes(1e-4f)) * tan_half_fan_);
  const LaneMask place = __builtin_convertvector(clamp(share, 0.f, 1.f) * (end_count - 1) + 0.5f, LaneMask);
  Lanes end;
  for (int lane = 0; lane < lane_count; ++lane) end[lane] = ends_m_[static_cast<std::size_t>(place[lane])];
  return end;
}

Lanes SheetLight::fan_weight(Lanes y, Lanes z) const {
  const Lanes tangent = abs(y) / max(z, all_lanes(1e-4f));
  const Lanes weight = clamp((tan_half_fan_ - tangent) / fan_edge + 0.5f, 0.f, 1.f);
  if (fan_profile_.empty()) return z > 1e-3f ? weight : Lanes{};
  return z > 1e-3f ? weight * fan_power(y / max(z, all_lanes(1e-4f))) : Lanes{};
}

// By straight lines between the profile's places.
Lanes SheetLight::fan_power(Lanes tangent) const {
  const auto last = static_cast<float>(fan_profile_.size() - 1);
  const Lanes place = clamp((0.5f + 0.5f * tangent / tan_half_fan_) * last, 0.f, last);
  const LaneMask left = __builtin_convertvector(min(place, all_lanes(last - 1)), LaneMask);
  Lanes power, next;
  for (int lane = 0; lane < lane_count; ++lane) {
    const auto at = static_cast<std::size_t>(left[lane]);
    power[lane] = fan_profile_[at], next[lane] = fan_profile_[at + 1];
  }
  return power + (place - __builtin_convertvector(left, Lanes)) * (next - power);
}

Lanes SheetLight::sigma2_m2(Lanes range) const {
  const Lanes widening = divergence_rad_ * (range - waist_at_m_);
  return waist_m_ * waist_m_ + widening * widening;
}

StripePacket SheetLight::on_surface(const SurfacePacket& surface, const Water& water, float footprint, float blur_px) const {
  if (pattern_.has_value()) return picture(surface, water, footprint);
  return line(surface, water, footprint, blur_px);
}

// Distance to the stripe in the image: w = distance * facing is linear in the image plane for a pinhole.
SheetLight::ImageDistance SheetLight::image_distance(const SurfacePacket& s) const {
  ImageDistance d;
  const Lanes3 place = base_from_laser_.transposed_times(s.point - emitter_);
  d.place = place;
  d.range2 = dot(place, place);
  // The sheet's distance and its normal at this place: of the plane, or of the cone's tangent plane.
  d.distance = place.x;
  d.normal = base_from_laser_.column_x;
  if (tan_cone_ != 0.f) {
    const Lanes radius = max(sqrt(place.y * place.y + place.z * place.z), all_lanes(1e-4f));
    const Lanes3 outward = base_from_laser_.column_y * (place.y / radius) + base_from_laser_.column_z * (place.z / radius);
    d.normal = (d.normal - outward * all_lanes(tan_cone_)) * all_lanes(cos_cone_);
    d.distance = (place.x - tan_cone_ * radius) * cos_cone_;
  }
  d.w = d.distance * s.facing;
  d.w_du = s.facing * dot(d.normal, s.point_du) + d.distance * dot(s.normal, s.direction_du);
  d.w_dv = s.facing * dot(d.normal, s.point_dv) + d.distance * dot(s.normal, s.direction_dv);
  d.gradient2 = d.w_du * d.w_du + d.w_dv * d.w_dv;
  return d;
}

// Lanes that the line reaches, as wide as it is at this place; compared as squares.
LaneMask SheetLight::within_reach(const SurfacePacket& s, const ImageDistance& d, float blur_px) const {
  const Lanes facing2 = s.facing * s.facing;
  const Lanes spot = sigma2_m2(sqrt(d.range2)) * facing2 + (blur_px * blur_px + 1.f) * d.gradient2;
  return s.met & (d.w * d.w < reach_sigmas_ * reach_sigmas_ * spot);
}

void SheetLight::add_skirt(const SurfacePacket& s, const ImageDistance& d, const Water& water, StripePacket& stripe) const {
  constexpr float past_end_m = 0.005f;  // the surface that ends the sheet is lit itself
  LaneMask beside = s.met & (d.distance * d.distance < skirt_reach_rad * skirt_reach_rad * d.range2);
  if (!any(beside)) return;
  const Lanes range = max(sqrt(d.range2), all_lanes(least_range_m));
  const Lanes incidence = max(-dot(s.normal, s.point - emitter_) / range, Lanes{});
  const Lanes weight = fan_weight(d.place.y, d.place.z) * incidence;
  beside &= (weight > 0.f) & (range < end_m(d.place.y, d.place.z) * (1.f + skirt_reach_rad) + past_end_m);
  if (!any(beside)) return;
  const Lanes distance2 = d.distance * d.distance;
  const Lanes sigma2 = sigma2_m2(range);
  Lanes bells{};
  for (const ScatterTerm& term : water.forward.terms) {
    const Lanes per_width2 = 1.f / (sigma2 + term.angle_rad * term.angle_rad * range * range);
    bells += term.weight * sqrt(per_width2) * exp(-0.5f * distance2 * per_width2);
  }
  const Lanes light = w_per_rad_ / (range * root_two_pi) * weight * water.scattered(range) * bells;
  stripe.beside = beside;
  for (std::size_t band = 0; band < 3; ++band) {
    if (band_[band] == 0.f) continue;
    stripe.skirt[band] = beside ? light * band_[band] * water.transmission(band, range + s.range) : Lanes{};
  }
}

// The beam's light that specks take from these surface points, over its middle's.
Lanes SheetLight::shadow(const SurfacePacket& s, const ImageDistance& d, LaneMask wanted, float footprint) const {
  const Lanes range = max(sqrt(d.range2), all_lanes(least_range_m)), depth = max(d.place.z, all_lanes(least_range_m));
  const Lanes sigma = sqrt(sigma2_m2(range));
  const auto side = [&](const Lanes3& axis) { return footprint * (abs(dot(axis, s.point_du)) + abs(dot(axis, s.point_dv))); };
  return shadows_->taken(wanted, d.place.y / depth, d.distance / sigma, range, side(base_from_laser_.column_y) / depth,
                         side(d.normal) / sigma);
}

StripePacket SheetLight::line(const SurfacePacket& s, const Water& water, float footprint, float blur_px) const {
  StripePacket stripe;
  const ImageDistance d = image_distance(s);
  if (water.scatters()) add_skirt(s, d, water, stripe);
  const LaneMask near = within_reach(s, d, blur_px);
  if (!any(near)) return stripe;
  const Lanes w_du = d.w_du, w_dv = d.w_dv, distance = d.distance;
  const Lanes gradient = max(sqrt(d.gradient2), all_lanes(1e-9f));
  stripe.offset_px = d.w / gradient;
  stripe.slope_v = w_dv / gradient;

  // The stripe's centre in this pixel's column (its row, if the stripe is steep): there on the tangent plane, exactly.
  const LaneMask down = abs(w_dv) >= abs(w_du);
  const Lanes3 step = {down ? s.point_dv.x : s.point_du.x, down ? s.point_dv.y : s.point_du.y, down ? s.point_dv.z : s.point_du.z};
  const Lanes approach = dot(d.normal, step);
  const Lanes3 centre = s.point - step * (distance / (abs(approach) > 1e-9f ? approach : all_lanes(1e-9f)));
  const Lanes w_step = down ? w_dv : w_du;
  const Lanes turn = dot(s.normal, {down ? s.direction_dv.x : s.direction_du.x, down ? s.direction_dv.y : s.direction_du.y,
                                    down ? s.direction_dv.z : s.direction_du.z});
  const Lanes facing = s.facing - turn * distance * s.facing / (abs(w_step) > 1e-9f ? w_step : all_lanes(1e-9f));
  const Lanes px_per_m = max(-facing, all_lanes(1e-4f)) / gradient;
  const Lanes3 beam = centre - emitter_;
  const Lanes3 centre_place = base_from_laser_.transposed_times(beam);
  const Lanes range = max(norm(beam), all_lanes(least_range_m));
  const Lanes camera_range = norm(centre - s.origin);
  const Lanes incidence = max(-dot(s.normal, beam) / range, Lanes{});
  const Lanes weight = fan_weight(centre_place.y, centre_place.z) * incidence;
  const Lanes sigma_m = sqrt(sigma2_m2(range));
  const Lanes sigma_px = sigma_m * px_per_m;

  const Lanes box_u = footprint * abs(w_du) / gradient, box_v = footprint * abs(w_dv) / gradient;
  const Lanes wide = max(box_u, box_v), narrow = min(box_u, box_v);
  const Lanes sigma = sqrt(sigma_px * sigma_px + blur_px * blur_px + narrow * narrow * (1.f / 12.f));
  stripe.sigma_px = sigma;
  stripe.reached = near & (weight > 0.f);
  if (!any(stripe.reached)) return stripe;

  const Lanes peak = w_per_rad_ / (range * root_two_pi * sigma_m) * weight;
  // A surface that faces the camera shows the laser's +x at negative offsets.
  const Lanes first = stripe.offset_px - lobe_share_ / (1.f + lobe_share_) * lobe_sigmas_ * sigma_px;
  Lanes core = box_gaussian(first, sigma_px, sigma, wide);
  if (lobe_share_ > 0.f) {
    const Lanes lobe = box_gaussian(first + lobe_sigmas_ * sigma_px, sigma_px, sigma, wide);
    core = (core + lobe_share_ * lobe) / (1.f + lobe_share_);
  }
  if (shadows_) core = max(core - shadow(s, d, stripe.reached, footprint) / (1.f + lobe_share_), Lanes{});
  for (std::size_t band = 0; band < 3; ++band) {
    if (band_[band] == 0.f) continue;
    const Lanes path = range + camera_range;
    const Lanes light = peak * band_[band] * water.transmission(band, path) * core * water.direct(range);
    stripe.irradiance[band] = stripe.reached ? light : Lanes{};
  }
  return stripe;
}

RgbLanes SheetLight::at(const Lanes3& point, const Water& water) const {
  RgbLanes irradiance{};
  if (pattern_.has_value()) return irradiance;
  const Lanes3 place = base_from_laser_.transposed_times(point - emitter_);
  const Lanes range = max(norm(place), all_lanes(least_range_m));
  const Lanes lit = range < end_m(place.y, place.z) ? fan_weight(place.y, place.z) : Lanes{};
  const Lanes off_m = place.x - tan_cone_ * sqrt(place.y * place.y + place.z * place.z);
  const Lanes sigma2 = sigma2_m2(range);
  const Lanes light = lit * w_per_rad_ / (range * root_two_pi * sqrt(sigma2)) * exp(-0.5f * off_m * off_m / sigma2);
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] = light * band_[band] * water.transmission(band, range);
  return irradiance;
}

StripePacket SheetLight::picture(const SurfacePacket& s, const Water& water, float footprint) const {
  const PatternTable& table = *pattern_;
  const Pattern& g = table.geometry();
  const Lanes3 beam = s.point - emitter_;
  const Lanes3 place = base_from_laser_.transposed_times(beam);
  const Lanes3 place_du = base_from_laser_.transposed_times(s.point_du), place_dv = base_from_laser_.transposed_times(s.point_dv);
  const Lanes range = norm(beam);
  const Lanes facing = max(-dot(s.normal, beam), Lanes{});
  const Lanes depth = max(place.z, all_lanes(least_range_m));
  const auto fx = static_cast<float>(g.fx), fy = static_cast<float>(g.fy);
  const Lanes x = place.x / depth, y = place.y / depth;
  const Lanes extent_u = footprint * fx / depth * (abs(place_du.x - x * place_du.z) + abs(place_dv.x - x * place_dv.z));
  const Lanes extent_v = footprint * fy / depth * (abs(place_du.y - y * place_du.z) + abs(place_dv.y - y * place_dv.z));
  StripePacket stripe;
  Lanes share{};
  for (int i = 0; i < lane_count; ++i) {
    if (s.met[i] == 0 || place.z[i] <= least_range_m || facing[i] <= 0) continue;
    share[i] = table.lit_share(x[i] * fx + static_cast<float>(g.cx), y[i] * fy + static_cast<float>(g.cy), extent_u[i], extent_v[i]);
  }
  stripe.reached = share > 0.f;
  // Power even over the image plane: what a surface element takes of it is |normal . beam| / depth^3.
  const Lanes irradiance = share * static_cast<float>(power_w_ / table.unit_plane_area()) * facing / (depth * depth * depth);
  for (std::size_t band = 0; band < 3; ++band)
    stripe.irradiance[band] = irradiance * band_[band] * water.transmission(band, range + s.range);
  return stripe;
}

Glow SheetLight::glow(const RayLines& rays, const Water& water) const {
  Glow glow;
  if (pattern_.has_value()) return glow;
  // In the laser's frame; x is zero where the rays cross.
  const Lanes3 start = base_from_laser_.transposed_times(rays.origin - emitter_);
  const Lanes3 direction = base_from_laser_.transposed_times(rays.direction);
  const Lanes per_approach = 1.f / (abs(direction.x) > 1e-4f ? direction.x : all_lanes(1e-4f));
  glow.parameter = -start.x * per_approach;
  const Lanes y = start.y + glow.parameter * direction.y, z = start.z + glow.parameter * direction.z;
  const Lanes range = max(sqrt(y * y + z * z), all_lanes(least_range_m));
  Lanes weight = glow.parameter > 0.f ? fan_weight(y, z) : Lanes{};
  if (!water.scatters() || !any(weight > 0.f)) return glow;
  weight = range < end_m(y, z) ? weight : Lanes{};
  if (!any(weight > 0.f)) return glow;
  const Lanes slope2 = dot(direction, direction), slope = sqrt(slope2);
  const Lanes per_length2 = 1.f / (range * slope);
  // Light flows along the beam and turns back along the ray.
  const Lanes cosine = -(y * direction.y + z * direction.z) * per_length2;
  const Lanes crossing = w_per_rad_ * weight * slope2 * per_length2 * abs(per_approach);
  for (std::size_t band = 0; band < 3; ++band) {
    if (band_[band] == 0.f) continue;
    glow.radiance[band] = crossing * band_[band] * water.scattering(cosine) * water.transmission(band, range + glow.parameter * slope);
  }
  return glow;
}

}  // namespace lf::optics
