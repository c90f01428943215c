#include "host_sim/optics/render_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lf::optics {

LiveView::LiveView(const Camera& camera, const Tiles& image_tiles) : tiles(image_tiles.count()) {
  pixels.resize(camera.width(), camera.height(), camera.channels());
  packets.assign(pixels.stride / lane_count * static_cast<std::size_t>(camera.height()), hidden);
}

RenderPass::RenderPass(const Camera& camera, const Tiles& tiles, const StillView& still, const Shader& shader, const BodyBounds& arm,
                       LiveView& live)
    : camera_(camera), tiles_(tiles), still_(still), shader_(shader), arm_(arm), live_(live) {}

// Says what moving bodies may do to each tile of the row, and what to any of them.
Changes RenderPass::judge_tiles(int tile_row) const {
  Changes in_row = 0;
  for (int column = 0; column < tiles_.columns(); ++column) {
    const std::size_t tile = tiles_.at(column * Tiles::width_px, tiles_.first_row(tile_row));
    const bool may_hide = arm_.may_meet(tiles_.view(tile)), may_shade = still_.may_be_shaded(tile, arm_);
    live_.tiles[tile] = static_cast<Changes>((may_hide ? hidden : 0) | (may_shade ? shaded : 0));
    in_row |= live_.tiles[tile];
  }
  return in_row;
}

void RenderPass::sample(int tile_row) const {
  const Changes possible = judge_tiles(tile_row);
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    const std::vector<float> haze = possible != 0 ? still_.haze_row(v) : std::vector<float>{};
    for (int u = 0; u < camera_.width(); u += lane_count) sample_packet(u, v, haze.empty() ? nullptr : &haze);
  }
}

void RenderPass::sample_packet(int u, int v, const std::vector<float>* haze_row) const {
  const std::size_t i = live_.pixels.index(u, v);
  const Changes possible = live_.tiles[tiles_.at(u, v)];
  Changes& changes = live_.packets[packet(u, v)];
  const Changes before = std::exchange(changes, Changes{0});
  if (possible == 0 && shader_.sheets.empty()) {
    live_.pixels.set_grey(i, still_.pixels().grey_at(i));
  } else if (possible == 0 && still_.open_water(u, v)) {
    GreyLanes grey = still_.pixels().grey_at(i);
    add_glow(camera_.lines(u, v), all_lanes(std::numeric_limits<float>::infinity()), grey);
    live_.pixels.set_grey(i, grey);
  } else {
    const RayPacket rays = camera_.row(u, v);
    Sample sample = still_.pixels().sample(i);
    changes = put_in_moving(rays, possible, 1.f, {haze_row, static_cast<float>(u), 1.f}, sample);
    if (add_stripes(rays, 1.f, sample)) changes |= striped;
    add_glow(rays, sample.hit.parameter, sample.grey);
    if (changes != 0) return live_.pixels.set(i, sample);
    live_.pixels.set_grey(i, sample.grey);
  }
  if (before != 0) live_.pixels.copy_surface(i, still_.pixels());
}

// Lanes that a moving body hides or shades get its base light instead. Returns what was changed.
Changes RenderPass::put_in_moving(const RayPacket& rays, Changes possible, float footprint, const HazePlace& haze, Sample& sample) const {
  const HitPacket hit = (possible & hidden) != 0 ? shader_.scene().nearest(rays, sample.hit) : sample.hit;
  const LaneMask behind = hit.parameter < sample.hit.parameter;
  const LaneMask in_shadow = (possible & shaded) != 0 ? shader_.unshaded(rays, sample.hit, sample.lit) != sample.lit : LaneMask{};
  const auto changes = static_cast<Changes>((any(behind) ? hidden : 0) | (any(in_shadow) ? shaded : 0));
  if (changes == 0) return changes;
  const Light base = shader_.base(rays, hit, footprint, haze, Casters::all);
  const LaneMask touched = behind | in_shadow;
  const GreyLanes grey = camera_.grey(base.radiance);
  for (std::size_t c = 0; c < camera_.channels(); ++c) sample.grey[c] = touched ? grey[c] : sample.grey[c];
  sample.reached = touched ? base.reached : sample.reached;
  sample.lit = touched ? base.lit : sample.lit;
  sample.hit = hit;
  return changes;
}

// Returns whether there were any.
bool RenderPass::add_stripes(const RayPacket& rays, float footprint, Sample& sample) const {
  if (shader_.sheets.empty()) return false;
  const Light light = shader_.stripes(rays, sample.hit, footprint, camera_.blur_px());
  if (!any(light.reached)) return false;
  const GreyLanes grey = camera_.grey(light.radiance);
  for (std::size_t c = 0; c < camera_.channels(); ++c) sample.grey[c] += grey[c];
  sample.reached |= light.reached;
  sample.lit |= light.lit;
  return true;
}

void RenderPass::add_glow(const RayLines& rays, Lanes surface_parameter, GreyLanes& grey) const {
  for (const SheetLight& sheet : shader_.sheets) {
    const Glow glow = sheet.glow(rays, shader_.water());
    const GreyLanes values = camera_.grey(glow.radiance);
    for (std::size_t c = 0; c < camera_.channels(); ++c) grey[c] += glow.parameter < surface_parameter ? values[c] : Lanes{};
  }
}

// What has changed in the packet or in one of the eight about it.
Changes RenderPass::changes_about(int u, int v) const {
  const int first_u = std::max(0, u - lane_count), last_u = std::min(camera_.width() - 1, u + lane_count);
  Changes changes = 0;
  for (int row = std::max(0, v - 1); row <= std::min(camera_.height() - 1, v + 1); ++row) {
    for (std::size_t p = packet(first_u, row); p <= packet(last_u, row); ++p) changes |= live_.packets[p];
  }
  return changes;
}

void RenderPass::resample_edges(int tile_row) const {
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    std::vector<float> haze;
    std::vector<Glow> glows;
    for (int u = 0; u < camera_.width(); u += lane_count) {
      const Changes changes = changes_about(u, v);
      const LaneMask edge = changes != 0 ? live_.pixels.edges(u, v) : still_.edges(u, v);
      if (!any(edge)) continue;
      if (changes != 0 && haze.empty()) haze = still_.haze_row(v);
      glows.clear();
      for (const SheetLight& sheet : shader_.sheets) glows.push_back(sheet.glow(camera_.lines(u, v), shader_.water()));
      for (int lane = 0; lane < lane_count; ++lane) {
        if (edge[lane] != 0) resample(u + lane, v, changes, glows, haze.empty() ? nullptr : &haze);
      }
    }
  }
}

// The mean of the sub-pixels. A sheet's glow is even over a pixel: the sub-pixels count that meet no surface before it.
void RenderPass::resample(int u, int v, Changes changes, const std::vector<Glow>& glows, const std::vector<float>* haze_row) const {
  const SubPixels* pixel = still_.sub_pixels(u, v);
  SubPixels sampled;
  if (changes != 0 || pixel == nullptr) {
    sampled = sample_sub_pixels(u, v, changes, haze_row);
    pixel = &sampled;
  }
  std::array<float, 3> grey = pixel->grey;
  for (const Glow& glow : glows) {
    const auto lane = static_cast<std::size_t>(u % lane_count);
    const LaneMask behind = (pixel->half[0].hit.parameter > glow.parameter[lane]) + (pixel->half[1].hit.parameter > glow.parameter[lane]);
    std::int32_t count = 0;
    for (int i = 0; i < lane_count; ++i) count -= behind[i];
    const GreyLanes values = camera_.grey(glow.radiance);
    for (std::size_t c = 0; c < camera_.channels(); ++c) grey[c] += values[c][lane] * static_cast<float>(count) / (2 * lane_count);
  }
  PixelStore& pixels = live_.pixels;
  for (std::size_t c = 0; c < camera_.channels(); ++c) pixels.grey[c * pixels.plane + pixels.index(u, v)] = grey[c];
}

// Without the glow. Whether to look for the arm, its shadows and stripes the samples about the pixel have told.
SubPixels RenderPass::sample_sub_pixels(int u, int v, Changes changes, const std::vector<float>* haze_row) const {
  const HazePlace haze{haze_row, static_cast<float>(u), 0.f};
  const SubPixels* kept = still_.sub_pixels(u, v);
  SubPixels pixel;
  if (kept != nullptr) pixel = *kept;
  for (int half = 0; half < 2; ++half) {
    const RayPacket rays = camera_.sub_pixels(u, v, half);
    Sample& sample = pixel.half[static_cast<std::size_t>(half)];
    if (kept != nullptr) {
      put_in_moving(rays, changes, 0.25f, haze, sample);
    } else {
      sample.hit = shader_.scene().all(rays);
      sample.grey = camera_.grey(shader_.base(rays, sample.hit, 0.25f, haze, Casters::all).radiance);
    }
    if ((changes & striped) != 0) add_stripes(rays, 0.25f, sample);
  }
  pixel.average(camera_.channels());
  return pixel;
}

void RenderPass::expose(int tile_row, std::uint64_t key, Frame& frame) const {
  const PixelStore& pixels = live_.pixels;
  const std::size_t width = static_cast<std::size_t>(camera_.width()), channels = camera_.channels();
  std::vector<float> interleaved(channels > 1 ? width * channels : 0);
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * width * channels;
    const float* values = pixels.grey.data() + pixels.index(0, v);
    if (channels > 1) {
      for (std::size_t u = 0; u < width; ++u) {
        for (std::size_t c = 0; c < channels; ++c) interleaved[u * channels + c] = values[c * pixels.plane + u];
      }
      values = interleaved.data();
    }
    camera_.sensor.expose(values, frame.pixels.data() + first, width * channels, static_cast<std::uint32_t>(first), key);
  }
}

void RenderPass::write_geometry(int tile_row, const std::vector<std::uint16_t>& object_of_shape, Frame& frame) const {
  const PixelStore& pixels = live_.pixels;
  const auto width = static_cast<std::size_t>(frame.width);
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    const std::size_t from = pixels.index(0, v), to = static_cast<std::size_t>(v) * width;
    const float ahead_m = camera_.rays.origin_depth_m();
    for (std::size_t u = 0; u < width; ++u) frame.depth_m[to + u] = pixels.depth_m[from + u] + ahead_m;
    for (std::size_t u = 0; u < width; ++u) frame.object[to + u] = object_of_shape[static_cast<std::size_t>(1L + pixels.shape[from + u])];
  }
}

// Newton's method down the column on the surfaces that the rays really meet; what does not settle on a lit surface is no centre.
void RenderPass::refine_stripe(std::size_t laser, int u, int v, Lanes offset_v, LaneMask wanted, std::vector<StripeCentre>& centres) const {
  const SheetLight& sheet = shader_.sheets[laser];
  SurfacePacket surface;
  StripePacket stripe;
  HitPacket hit;
  for (int i = 0; i < 4 && (i == 0 || any(wanted & (abs(stripe.offset_px) > 1e-4f))); ++i) {
    if (i > 0) offset_v = clamp(offset_v - stripe.offset_px / (abs(stripe.slope_v) > 0.02f ? stripe.slope_v : all_lanes(0.02f)), -1.f, 1.f);
    const RayPacket rays = camera_.rays.shifted_row(camera_.place, u, v, offset_v);
    hit = shader_.scene().all(rays);
    surface = make_surface(rays, hit);
    stripe = sheet.on_surface(surface, shader_.water(), 1.f, camera_.blur_px());
  }
  const LaneMask settled = wanted & stripe.reached & (abs(stripe.offset_px) < 2e-3f) & (abs(offset_v) <= 0.75f);
  const LaneMask lit = shader_.scene().clear_of_all(sheet.emitter(), surface, settled);
  const RgbLanes albedo = shader_.look().albedo(surface, hit.shape, 1.f);
  RgbLanes radiance;
  for (std::size_t band = 0; band < 3; ++band) radiance[band] = albedo[band] * static_cast<float>(1 / pi) * stripe.irradiance[band];
  const GreyLanes grey = camera_.grey(radiance);
  const Lanes height = max(grey[0], max(grey[1], grey[2]));
  for (int lane = 0; lane < lane_count && u + lane < camera_.width(); ++lane) {
    if (lit[lane] != 0) centres.push_back({u + lane, static_cast<float>(v) + offset_v[lane], height[lane]});
  }
}

std::vector<RenderPass::StripeCentre> RenderPass::stripe_centres(int tile_row, std::size_t laser) const {
  std::vector<StripeCentre> centres;
  const PixelStore& pixels = live_.pixels;
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    for (int u = 0; u < camera_.width(); u += lane_count) {
      if ((live_.packets[packet(u, v)] & striped) == 0) continue;
      const Sample sample = pixels.sample(pixels.index(u, v));
      if (!any(sample.reached & (1 << laser))) continue;
      const SurfacePacket surface = make_surface(camera_.row(u, v), sample.hit);
      const StripePacket stripe = shader_.sheets[laser].on_surface(surface, shader_.water(), 1.f, camera_.blur_px());
      const Lanes offset_v = -stripe.offset_px / (abs(stripe.slope_v) > 0.02f ? stripe.slope_v : all_lanes(0.02f));
      const LaneMask near = stripe.reached & (abs(offset_v) < 0.75f);
      if (any(near)) refine_stripe(laser, u, v, offset_v, near, centres);
    }
  }
  return centres;
}

}  // namespace lf::optics
