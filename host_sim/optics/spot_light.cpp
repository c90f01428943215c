#include "host_sim/optics/spot_light.hpp"

#include <algorithm>

namespace lf::optics {
namespace {

constexpr float least_range_m = 0.02f;
constexpr float range_scale_m = 0.3f;  // knots are even in range / (range + scale): dense where haze is
constexpr float last_share = 0.94f;    // 4.7 m: nothing comes from further
constexpr std::size_t node_size = 3 * LampHaze::knots;

float knot_range(float knot) {
  const float x = last_share * knot / (LampHaze::knots - 1);
  return range_scale_m * x / (1 - x);
}

}  // namespace

SpotLight::SpotLight(const LampConfig& config, const Pose& base_from_body, float share)
    : intensity_w_sr_(config.intensity_w_sr),
      cos_outer_(static_cast<float>(std::cos(std::min(config.cone_half_angle_rad + 0.5 * config.edge_rad, pi)))),
      cos_inner_(static_cast<float>(std::cos(std::max(config.cone_half_angle_rad - 0.5 * config.edge_rad, 0.0)))),
      casts_shadows_(config.casts_shadows) {
  const Pose base_from_lamp = base_from_body * config.body_from_lamp;
  position_ = Lanes3(base_from_lamp.translation());
  axis_ = Lanes3(Vec3(base_from_lamp.linear().col(2)));
  for (float& band : intensity_w_sr_) band *= share;
}

Lanes SpotLight::cone_weight(const Lanes3& beam, Lanes range_m) const {
  const Lanes cosine = dot(beam, axis_) / range_m;
  const Lanes x = clamp((cosine - cos_outer_) / std::max(cos_inner_ - cos_outer_, 1e-6f), 0.f, 1.f);
  return x * x * (3.f - 2.f * x);
}

RgbLanes SpotLight::on_surface(const SurfacePacket& surface, const Water& water) const {
  const Lanes3 beam = surface.point - position_;
  const Lanes range = max(norm(beam), all_lanes(least_range_m));
  const Lanes incidence = max(-dot(surface.normal, beam) / range, Lanes{});
  const Lanes weight = cone_weight(beam, range) * incidence / (range * range);
  RgbLanes irradiance;
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] = intensity_w_sr_[band] * weight * water.broad_transmission(band, range);
  return irradiance;
}

RgbLanes SpotLight::at(const Lanes3& point, const Water& water) const {
  const Lanes3 beam = point - position_;
  const Lanes range = max(norm(beam), all_lanes(least_range_m));
  const Lanes weight = cone_weight(beam, range) / (range * range);
  RgbLanes irradiance;
  for (std::size_t band = 0; band < 3; ++band) irradiance[band] = intensity_w_sr_[band] * weight * water.broad_transmission(band, range);
  return irradiance;
}

RgbLanes SpotLight::scattered(const Lanes3& point, const Lanes3& unit_direction, Lanes camera_range_m, const Water& water) const {
  const Lanes3 beam = point - position_;
  const Lanes range = max(norm(beam), all_lanes(least_range_m));
  const Lanes cosine = -dot(beam, unit_direction) / range;
  const Lanes weight = cone_weight(beam, range) / (range * range);
  RgbLanes radiance;
  for (std::size_t band = 0; band < 3; ++band) {
    radiance[band] = intensity_w_sr_[band] * weight * water.scattering(cosine) * water.broad_transmission(band, range + camera_range_m);
  }
  return radiance;
}

LampHaze::LampHaze(const CameraRays& rays, const CameraPlace& place, int width, int height, const std::vector<SpotLight>& lamps,
                   const Water& water)
    : columns_((width + spacing_px - 1) / spacing_px + 1), rows_((height + spacing_px - 1) / spacing_px + 1) {
  sums_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) * node_size, 0.f);
  for (int node_row = 0; node_row < rows_; ++node_row) {
    for (int node = 0; node < columns_; ++node) {
      float* sums = sums_.data() +
                    (static_cast<std::size_t>(node_row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(node)) * node_size;
      // The last nodes lie past the image's edge, where the rays go on smoothly.
      const int u = std::min(node * spacing_px, width - 1), v = std::min(node_row * spacing_px, height - 1);
      const RayPacket ray = rays.around(place, u, v, all_lanes(static_cast<float>(node * spacing_px - u)),
                                        all_lanes(static_cast<float>(node_row * spacing_px - v)));
      const Lanes slope = CameraRays::slope(ray);
      // Eight knot intervals at a time, each by its middle.
      for (int first = 0; first + 1 < knots; first += lane_count) {
        Lanes middle, length;
        for (int i = 0; i < lane_count; ++i) {
          const float near = knot_range(static_cast<float>(std::min(first + i, knots - 1)));
          const float far = knot_range(static_cast<float>(std::min(first + i + 1, knots - 1)));
          middle[i] = 0.5f * (near + far), length[i] = far - near;
        }
        const Lanes3 direction = ray.direction * (1.f / slope);
        for (const SpotLight& lamp : lamps) {
          const RgbLanes light = lamp.scattered(ray.origin + direction * middle, direction, middle, water);
          for (std::size_t band = 0; band < 3; ++band) {
            for (int i = 0; i < lane_count && first + i + 1 < knots; ++i) {
              sums[band * knots + static_cast<std::size_t>(first + i + 1)] += light[band][i] * length[i];
            }
          }
        }
      }
      for (std::size_t band = 0; band < 3; ++band) {
        for (std::size_t k = 1; k < knots; ++k) sums[band * knots + k] += sums[band * knots + k - 1];
      }
    }
  }
}

std::vector<float> LampHaze::row(int v) const {
  const int above = std::min(v / spacing_px, rows_ - 2);
  const float share = static_cast<float>(v - above * spacing_px) / spacing_px;
  const std::size_t size = static_cast<std::size_t>(columns_) * node_size;
  const float* a = sums_.data() + static_cast<std::size_t>(above) * size;
  std::vector<float> row(size);
  for (std::size_t i = 0; i < size; ++i) row[i] = a[i] + share * (a[size + i] - a[i]);
  return row;
}

void LampHaze::add(const std::vector<float>& row, float u, float step, Lanes range_m, RgbLanes& radiance) {
  const Lanes knot = clamp(range_m / (range_m + range_scale_m) * ((knots - 1) / last_share), 0.f, knots - 1.001f);
  for (int i = 0; i < lane_count; ++i) {
    const std::size_t nodes = row.size() / node_size;
    const float place = std::clamp((u + step * static_cast<float>(i)) / spacing_px, 0.f, static_cast<float>(nodes) - 1.001f);
    const auto node = static_cast<std::size_t>(place), k = static_cast<std::size_t>(knot[i]);
    const float right = place - static_cast<float>(node), on = knot[i] - static_cast<float>(k);
    for (std::size_t band = 0; band < 3; ++band) {
      const float* left_node = row.data() + node * node_size + band * knots + k;
      const float* right_node = left_node + node_size;
      const float near = left_node[0] + right * (right_node[0] - left_node[0]);
      const float far = left_node[1] + right * (right_node[1] - left_node[1]);
      radiance[band][i] += near + on * (far - near);
    }
  }
}

}  // namespace lf::optics
