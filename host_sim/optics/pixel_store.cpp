#include "host_sim/optics/pixel_store.hpp"

#include <cmath>
#include <utility>

namespace lf::optics {
namespace {

constexpr float crease_cosine = 0.97f;  // 14 degrees: beyond the facets of any tessellated curve
constexpr float plane_step = 0.002f;    // of the inverse depth: 1.4 mm at 0.7 m
constexpr float depth_step = 0.04f;     // of the depth; a plane seen at 45 degrees changes by 0.003 a pixel

}  // namespace

void Sample::set(const Light& light, const Camera& camera) {
  reached = light.reached, lit = light.lit;
  grey = camera.grey(light.radiance);
  scattered = camera.grey(light.scattered);
  laser = camera.grey(light.laser);
}

bool Sample::is_even() const {
  constexpr LaneMask lasers = LaneMask{} + 0xFFFF;
  const Lanes cosine = hit.normal.x * hit.normal.x[0] + hit.normal.y * hit.normal.y[0] + hit.normal.z * hit.normal.z[0];
  const LaneMask bend = (cosine < crease_cosine) | (abs(hit.parameter - hit.parameter[0]) > depth_step * hit.parameter[0]);
  return !any((hit.shape != hit.shape[0]) | ((hit.shape >= 0) & bend) | (reached != reached[0]) | (lit != lit[0]) | (reached & lasers));
}

void PixelStore::resize(int image_width, int image_height, std::size_t channel_count) {
  width = image_width, height = image_height, channels = channel_count;
  stride = (static_cast<std::size_t>(width) + lane_count - 1) / lane_count * lane_count;
  plane = stride * static_cast<std::size_t>(height) + 2 * lane_count;
  for (auto* values : {&depth_m, &normal_x, &normal_y, &normal_z}) values->resize(plane);
  for (auto* values : {&shape, &reached, &lit}) values->resize(plane);
  for (GreyPlanes* planes : {&grey, &scattered, &laser}) planes->resize(plane * channels);
}

Sample PixelStore::sample(std::size_t i) const {
  Sample s;
  s.hit.parameter = load_lanes(&depth_m[i]);
  s.hit.normal = {load_lanes(&normal_x[i]), load_lanes(&normal_y[i]), load_lanes(&normal_z[i])};
  s.hit.shape = load_mask(&shape[i]);
  s.reached = load_mask(&reached[i]);
  s.lit = load_mask(&lit[i]);
  s.grey = at(grey, i), s.scattered = at(scattered, i), s.laser = at(laser, i);
  return s;
}

GreyLanes PixelStore::at(const GreyPlanes& planes, std::size_t i) const {
  GreyLanes values{};
  for (std::size_t c = 0; c < channels; ++c) values[c] = load_lanes(&planes[c * plane + i]);
  return values;
}

void PixelStore::set_surface(std::size_t i, const HitPacket& hit, LaneMask reached_lanes, LaneMask lit_lanes) {
  store_lanes(&depth_m[i], hit.parameter);
  store_lanes(&normal_x[i], hit.normal.x);
  store_lanes(&normal_y[i], hit.normal.y);
  store_lanes(&normal_z[i], hit.normal.z);
  store_mask(&shape[i], hit.shape);
  store_mask(&reached[i], reached_lanes);
  store_mask(&lit[i], lit_lanes);
}

void PixelStore::set_planes(GreyPlanes& planes, std::size_t i, const GreyLanes& values) const {
  for (std::size_t c = 0; c < channels; ++c) store_lanes(&planes[c * plane + i], values[c]);
}

void PixelStore::set_light(std::size_t i, const Sample& sample) {
  set_planes(grey, i, sample.grey);
  set_planes(scattered, i, sample.scattered);
  set_planes(laser, i, sample.laser);
}

void PixelStore::copy_light(std::size_t i, const PixelStore& from) {
  set_planes(grey, i, at(from.grey, i));
  set_planes(scattered, i, at(from.scattered, i));
  set_planes(laser, i, {});
}

void PixelStore::set(std::size_t i, const Sample& sample) {
  set_surface(i, sample.hit, sample.reached, sample.lit);
  set_light(i, sample);
}

void PixelStore::copy_surface(std::size_t i, const PixelStore& from) {
  const Sample s = from.sample(i);
  set_surface(i, s.hit, s.reached, s.lit);
}

LaneMask PixelStore::edge_between(std::size_t a, std::size_t b) const {
  const LaneMask own_shape = load_mask(&shape[a]), other_shape = load_mask(&shape[b]);
  const LaneMask shadow = (load_mask(&lit[a]) ^ load_mask(&lit[b])) & load_mask(&reached[a]) & load_mask(&reached[b]);
  const Lanes cosine = load_lanes(&normal_x[a]) * load_lanes(&normal_x[b]) + load_lanes(&normal_y[a]) * load_lanes(&normal_y[b]) +
                       load_lanes(&normal_z[a]) * load_lanes(&normal_z[b]);
  const Lanes depth = load_lanes(&depth_m[a]), other_depth = load_lanes(&depth_m[b]);
  const LaneMask bend = (cosine < crease_cosine) | (abs(depth - other_depth) > depth_step * min(depth, other_depth));
  return (own_shape != other_shape) | ((own_shape >= 0) & ((shadow != 0) | bend));
}

bool PixelStore::on_one_plane(std::size_t a, std::size_t b) const {
  if (a > b) std::swap(a, b);
  const float cosine = normal_x[a] * normal_x[b] + normal_y[a] * normal_y[b] + normal_z[a] * normal_z[b];
  if (shape[a] < 0 || shape[b] < 0 || cosine < crease_cosine) return false;
  const auto inverse = [&](std::size_t i) { return 1 / depth_m[i]; };
  const std::size_t rows_apart = (b - a) / stride;
  const auto rows = static_cast<float>(rows_apart);
  // From either end, since the next pixel of one may lie beyond its plane's border.
  const float at_b = inverse(a) + rows * (inverse(a + stride) - inverse(a)), at_a = inverse(b) + rows * (inverse(b - stride) - inverse(b));
  return std::abs(at_b - inverse(b)) <= plane_step * inverse(b) || std::abs(at_a - inverse(a)) <= plane_step * inverse(a);
}

LaneMask PixelStore::edges(int u, int v) const {
  const std::size_t i = index(u, v);
  const LaneMask column = LaneMask{0, 1, 2, 3, 4, 5, 6, 7} + u;
  LaneMask edge = (edge_between(i, i - 1) & (column > 0)) | (edge_between(i, i + 1) & (column < width - 1));
  if (v > 0) edge |= edge_between(i, i - stride);
  if (v + 1 < height) edge |= edge_between(i, i + stride);
  return edge & (column < width);
}

}  // namespace lf::optics
