#include "host_sim/optics/render_pass.hpp"

#include <algorithm>
#include <cmath>

namespace lf::optics {
namespace {

constexpr float crease_cosine = 0.97f;  // 14 degrees: beyond the facets of any tessellated curve
constexpr float depth_step = 0.04f;     // of the depth; a plane seen at 45 degrees changes by 0.003 a pixel

void store_mask(std::int32_t* to, LaneMask lanes) { std::memcpy(to, &lanes, sizeof lanes); }

LaneMask load_mask(const std::int32_t* from) {
  LaneMask lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

}  // namespace

void PixelStore::resize(int width, int height, int channels) {
  stride = static_cast<std::size_t>((width + lane_count - 1) / lane_count * lane_count);
  plane = stride * static_cast<std::size_t>(height) + 2 * lane_count;
  for (auto* values : {&depth_m, &normal_x, &normal_y, &normal_z}) values->resize(plane);
  for (auto* values : {&shape, &reached, &lit}) values->resize(plane);
  grey.resize(plane * static_cast<std::size_t>(channels));
}

RenderPass::RenderPass(const CameraConfig& camera, const CameraRays& rays, const Sensor& sensor, const Shader& shader, const LampHaze* haze,
                       PixelStore& store)
    : camera_(camera),
      place_(camera.base_from_camera),
      rays_(rays),
      sensor_(sensor),
      shader_(shader),
      haze_(haze),
      store_(store),
      channel_count_(camera.colour ? 3 : 1) {}

std::array<Lanes, 3> RenderPass::channels(const RgbLanes& radiance) const {
  const float scale = sensor_.grey_per_radiance();
  if (camera_.colour) return {radiance[0] * scale, radiance[1] * scale, radiance[2] * scale};
  return {scale * (camera_.response[0] * radiance[0] + camera_.response[1] * radiance[1] + camera_.response[2] * radiance[2]), Lanes{},
          Lanes{}};
}

void RenderPass::sample_block(int block) const {
  const auto blur = static_cast<float>(camera_.blur_px);
  for (int v = first_row(block); v < end_row(block); ++v) {
    const std::vector<float> haze_row = haze_ != nullptr ? haze_->row(v) : std::vector<float>{};
    for (int u = 0; u < camera_.intrinsics.width; u += lane_count) {
      const RayPacket rays = rays_.row(place_, u, v);
      const Sample sample = shader_.sample(rays, 1.f, blur, haze_ != nullptr ? &haze_row : nullptr, static_cast<float>(u), 1.f);
      const std::size_t i = store_.index(u, v);
      store_lanes(&store_.depth_m[i], sample.hit.parameter);
      store_lanes(&store_.normal_x[i], sample.hit.normal.x);
      store_lanes(&store_.normal_y[i], sample.hit.normal.y);
      store_lanes(&store_.normal_z[i], sample.hit.normal.z);
      store_mask(&store_.shape[i], sample.hit.shape);
      store_mask(&store_.reached[i], sample.reached);
      store_mask(&store_.lit[i], sample.lit);
      const auto values = channels(sample.radiance);
      for (int c = 0; c < channel_count_; ++c)
        store_lanes(&store_.grey[static_cast<std::size_t>(c) * store_.plane + i], values[static_cast<std::size_t>(c)]);
    }
  }
}

LaneMask RenderPass::edge_between(std::size_t a, std::size_t b) const {
  const PixelStore& s = store_;
  const LaneMask shape = load_mask(&s.shape[a]), other_shape = load_mask(&s.shape[b]);
  const LaneMask shadow = (load_mask(&s.lit[a]) ^ load_mask(&s.lit[b])) & load_mask(&s.reached[a]) & load_mask(&s.reached[b]);
  const Lanes cosine = load_lanes(&s.normal_x[a]) * load_lanes(&s.normal_x[b]) + load_lanes(&s.normal_y[a]) * load_lanes(&s.normal_y[b]) +
                       load_lanes(&s.normal_z[a]) * load_lanes(&s.normal_z[b]);
  const Lanes depth = load_lanes(&s.depth_m[a]), other_depth = load_lanes(&s.depth_m[b]);
  const LaneMask bend = (cosine < crease_cosine) | (abs(depth - other_depth) > depth_step * min(depth, other_depth));
  return (shape != other_shape) | ((shape >= 0) & ((shadow != 0) | bend));
}

// Which of eight pixels differ from a neighbour in the image.
LaneMask RenderPass::edges(int u, int v) const {
  const std::size_t i = store_.index(u, v);
  LaneMask column;
  for (int lane = 0; lane < lane_count; ++lane) column[lane] = u + lane;
  const int width = camera_.intrinsics.width;
  LaneMask edge = (edge_between(i, i - 1) & (column > 0)) | (edge_between(i, i + 1) & (column < width - 1));
  if (v > 0) edge |= edge_between(i, i - store_.stride);
  if (v + 1 < camera_.intrinsics.height) edge |= edge_between(i, i + store_.stride);
  return edge & (column < width);
}

void RenderPass::resample_edges(int block, std::vector<float>& grey) const {
  for (int v = first_row(block); v < end_row(block); ++v) {
    const std::vector<float> haze_row = haze_ != nullptr ? haze_->row(v) : std::vector<float>{};
    for (int c = 0; c < channel_count_; ++c) {
      const std::size_t from = static_cast<std::size_t>(c) * store_.plane + store_.index(0, v);
      std::copy_n(store_.grey.begin() + static_cast<std::ptrdiff_t>(from), store_.stride, grey.begin() + static_cast<std::ptrdiff_t>(from));
    }
    for (int u = 0; u < camera_.intrinsics.width; u += lane_count) {
      const LaneMask edge = edges(u, v);
      for (int lane = 0; lane < lane_count; ++lane) {
        if (edge[lane] != 0) resample(u + lane, v, haze_ != nullptr ? &haze_row : nullptr, grey);
      }
    }
  }
}

void RenderPass::resample(int u, int v, const std::vector<float>* haze_row, std::vector<float>& grey) const {
  Lanes offset_u, offset_v;  // the upper eight of 4x4 sub-pixels; the lower ones lie half a pixel further down
  for (int i = 0; i < lane_count; ++i) {
    offset_u[i] = 0.25f * static_cast<float>(i % 4) - 0.375f;
    offset_v[i] = 0.25f * static_cast<float>(i / 4) - 0.375f;
  }
  std::array<float, 3> sum{};
  for (int half = 0; half < 2; ++half) {
    const RayPacket rays = rays_.around(place_, u, v, offset_u, offset_v + 0.5f * static_cast<float>(half));
    const Sample sample = shader_.sample(rays, 0.25f, static_cast<float>(camera_.blur_px), haze_row, static_cast<float>(u), 0.f);
    const auto values = channels(sample.radiance);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int lane = 0; lane < lane_count; ++lane) sum[c] += values[c][lane];
    }
  }
  for (int c = 0; c < channel_count_; ++c)
    grey[static_cast<std::size_t>(c) * store_.plane + store_.index(u, v)] = sum[static_cast<std::size_t>(c)] / 16.f;
}

void RenderPass::expose_block(int block, const std::vector<float>& grey, std::uint64_t key, Frame& frame) const {
  const auto width = static_cast<std::size_t>(camera_.intrinsics.width), channel_count = static_cast<std::size_t>(channel_count_);
  std::vector<float> interleaved(width * channel_count);
  for (int v = first_row(block); v < end_row(block); ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * width * channel_count;
    const float* values = grey.data() + store_.index(0, v);
    if (channel_count > 1) {
      for (std::size_t u = 0; u < width; ++u) {
        for (std::size_t c = 0; c < channel_count; ++c) interleaved[u * channel_count + c] = values[c * store_.plane + u];
      }
      values = interleaved.data();
    }
    sensor_.expose(values, frame.pixels.data() + first, width * channel_count, static_cast<std::uint32_t>(first), key);
  }
}

void RenderPass::write_geometry(int block, const std::vector<std::uint16_t>& object_of_shape, Frame& frame) const {
  for (int v = first_row(block); v < end_row(block); ++v) {
    for (int u = 0; u < camera_.intrinsics.width; ++u) {
      const std::size_t from = store_.index(u, v),
                        to = static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(u);
      const std::int32_t shape = store_.shape[from];
      frame.depth_m[to] = store_.depth_m[from] + rays_.origin_depth_m();
      frame.object[to] = shape < 0 ? std::uint16_t{0} : object_of_shape[static_cast<std::size_t>(shape)];
    }
  }
}

SurfacePacket RenderPass::stored_surface(const RayPacket& rays, int u, int v, HitPacket& hit) const {
  const std::size_t i = store_.index(u, v);
  hit.parameter = load_lanes(&store_.depth_m[i]);
  hit.normal = {load_lanes(&store_.normal_x[i]), load_lanes(&store_.normal_y[i]), load_lanes(&store_.normal_z[i])};
  hit.shape = load_mask(&store_.shape[i]);
  return make_surface(rays, hit);
}

// Newton's method down the column on the surfaces that the rays really meet; what does not settle on a lit surface is no centre.
void RenderPass::refine_stripe(std::size_t laser, int u, int v, Lanes offset_v, LaneMask wanted, std::vector<StripeCentre>& centres) const {
  const SheetLight& sheet = shader_.sheets[laser];
  SurfacePacket surface;
  StripePacket stripe;
  HitPacket hit;
  for (int i = 0; i < 4; ++i) {
    const RayPacket rays = rays_.shifted_row(place_, u, v, offset_v);
    hit = shader_.scene().intersect(rays.origin, rays.direction, near_m);
    surface = make_surface(rays, hit);
    stripe = sheet.on_surface(surface, shader_.water(), 1.f, static_cast<float>(camera_.blur_px));
    if (i < 3) offset_v = clamp(offset_v - stripe.offset_px / (abs(stripe.slope_v) > 0.02f ? stripe.slope_v : all_lanes(0.02f)), -1.f, 1.f);
  }
  const LaneMask settled = wanted & stripe.reached & (abs(stripe.offset_px) < 2e-3f) & (abs(offset_v) <= 0.75f);
  const LaneMask lit = shader_.visible_from(sheet.emitter(), surface, settled);
  const RgbLanes albedo = shader_.look().albedo(surface, hit.shape, 1.f);
  RgbLanes radiance;
  for (std::size_t band = 0; band < 3; ++band) radiance[band] = albedo[band] * static_cast<float>(1 / pi) * stripe.irradiance[band];
  const auto grey = channels(radiance);
  const Lanes height = max(grey[0], max(grey[1], grey[2]));
  for (int lane = 0; lane < lane_count && u + lane < camera_.intrinsics.width; ++lane) {
    if (lit[lane] != 0) centres.push_back({u + lane, static_cast<float>(v) + offset_v[lane], height[lane]});
  }
}

std::vector<RenderPass::StripeCentre> RenderPass::stripe_centres(int block, std::size_t laser) const {
  std::vector<StripeCentre> centres;
  for (int v = first_row(block); v < end_row(block); ++v) {
    for (int u = 0; u < camera_.intrinsics.width; u += lane_count) {
      if (!any(load_mask(&store_.reached[store_.index(u, v)]) & (1 << laser))) continue;
      HitPacket hit;
      const SurfacePacket surface = stored_surface(rays_.row(place_, u, v), u, v, hit);
      const StripePacket stripe = shader_.sheets[laser].on_surface(surface, shader_.water(), 1.f, static_cast<float>(camera_.blur_px));
      const Lanes offset_v = -stripe.offset_px / (abs(stripe.slope_v) > 0.02f ? stripe.slope_v : all_lanes(0.02f));
      const LaneMask near = stripe.reached & (abs(offset_v) < 0.75f);
      if (any(near)) refine_stripe(laser, u, v, offset_v, near, centres);
    }
  }
  return centres;
}

}  // namespace lf::optics
