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

RenderPass::RenderPass(const Camera& camera, const LensSpot& lens, const Tiles& tiles, const StillView& still, const Shader& shader,
                       const BodyBounds& arm, LiveView& live)
    : camera_(camera), lens_(lens), tiles_(tiles), still_(still), shader_(shader), arm_(arm), live_(live) {}

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
    live_.pixels.copy_light(i, still_.pixels());
  } else if (possible == 0 && still_.open_water(u, v)) {
    Sample water;
    water.grey = still_.pixels().at(still_.pixels().grey, i);
    add_glow(camera_.lines(u, v), all_lanes(std::numeric_limits<float>::infinity()), water.grey);
    live_.pixels.set_light(i, water);
  } else {
    const RayPacket rays = camera_.row(u, v);
    Sample sample = still_.pixels().sample(i);
    changes = put_in_moving(rays, possible, 1.f, {haze_row, static_cast<float>(u), 1.f}, sample);
    const RgbLanes albedo = still_.albedo(u, v);
    changes |= add_stripes(rays, 1.f, (changes & hidden) != 0 ? nullptr : &albedo, sample);
    add_glow(rays, sample.hit.parameter, sample.grey);
    if (changes != 0) return live_.pixels.set(i, sample);
    live_.pixels.set_light(i, sample);
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
  const GreyLanes grey = camera_.grey(base.radiance), scattered = camera_.grey(base.scattered);
  for (std::size_t c = 0; c < camera_.channels(); ++c) {
    sample.grey[c] = touched ? grey[c] : sample.grey[c];
    sample.scattered[c] = touched ? scattered[c] : sample.scattered[c];
  }
  sample.reached = touched ? base.reached : sample.reached;
  sample.lit = touched ? base.lit : sample.lit;
  sample.hit = hit;
  return changes;
}

// Returns whether there were any, or their skirts.
Changes RenderPass::add_stripes(const RayPacket& rays, float footprint, const RgbLanes* albedo, Sample& sample) const {
  if (shader_.sheets.empty()) return 0;
  const Light light = shader_.stripes(rays, sample.hit, footprint, albedo);
  if (!any(light.reached | light.beside)) return 0;
  const GreyLanes grey = camera_.grey(light.radiance), scattered = camera_.grey(light.scattered), laser = camera_.grey(light.laser);
  for (std::size_t c = 0; c < camera_.channels(); ++c)
    sample.grey[c] += grey[c], sample.scattered[c] += scattered[c], sample.laser[c] += laser[c];
  sample.reached |= light.reached;
  sample.lit |= light.lit;
  return static_cast<Changes>((any(light.reached) ? striped : 0) | (any(light.beside) ? skirted : 0));
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

std::vector<Glow> RenderPass::glows(int u, int v) const {
  std::vector<Glow> all;
  for (const SheetLight& sheet : shader_.sheets) all.push_back(sheet.glow(camera_.lines(u, v), shader_.water()));
  return all;
}

void RenderPass::resample_edges(int tile_row) const {
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    std::vector<float> haze;
    for (int u = 0; u < camera_.width(); u += lane_count) {
      const Changes changes = changes_about(u, v);
      const bool changed = (changes & ~skirted) != 0;
      const LaneMask edge = changed ? live_.pixels.edges(u, v) : still_.edges(u, v);
      if (!any(edge)) continue;
      if (changed && haze.empty()) haze = still_.haze_row(v);
      const std::vector<Glow> glow = changed ? glows(u, v) : std::vector<Glow>{};
      for (int lane = 0; lane < lane_count; ++lane) {
        if (edge[lane] == 0) continue;
        if (changed)
          resample(u + lane, v, changes, glow, haze.empty() ? nullptr : &haze);
        else
          add_even_light(u + lane, v, *still_.sub_pixels(u + lane, v));
      }
    }
  }
}

LaneMask RenderPass::marks_under_stripe(int u, int v) const {
  if ((live_.packets[packet(u, v)] & striped) == 0) return LaneMask{};
  const Sample sample = live_.pixels.sample(live_.pixels.index(u, v));
  Lanes light{};
  for (const Lanes& channel : sample.laser) light += channel;
  const LaneMask column = LaneMask{0, 1, 2, 3, 4, 5, 6, 7} + u;
  const LaneMask lit = (light > 0.f) & (column < camera_.width());
  return any(lit) ? lit & shader_.look().marks_edges(make_surface(camera_.row(u, v), sample.hit), sample.hit.shape, lit) : lit;
}

void RenderPass::resample_marks(int tile_row) const {
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    std::vector<float> haze;
    for (int u = 0; u < camera_.width(); u += lane_count) {
      const LaneMask mixed = marks_under_stripe(u, v);
      if (!any(mixed)) continue;
      if (haze.empty()) haze = still_.haze_row(v);
      const std::vector<Glow> glow = glows(u, v);
      for (int lane = 0; lane < lane_count; ++lane) {
        if (mixed[lane] != 0) resample(u + lane, v, changes_about(u, v), glow, haze.empty() ? nullptr : &haze);
      }
    }
  }
}

// Of a pixel whose edges are the still view's: skirt and glow are even over it, so that they add to its mean what they add at its centre.
void RenderPass::add_even_light(int u, int v, const SubPixels& kept) const {
  PixelStore& pixels = live_.pixels;
  for (std::size_t c = 0; c < camera_.channels(); ++c) {
    const std::size_t at = c * pixels.plane + pixels.index(u, v);
    pixels.grey[at] += kept.grey[c] - still_.pixels().grey[at];
    pixels.scattered[at] += kept.scattered[c] - still_.pixels().scattered[at];
  }
}

void RenderPass::put(int u, int v, const SubPixels& mean) const {
  PixelStore& pixels = live_.pixels;
  for (std::size_t c = 0; c < camera_.channels(); ++c) {
    const std::size_t at = c * pixels.plane + pixels.index(u, v);
    pixels.grey[at] = mean.grey[c], pixels.scattered[at] = mean.scattered[c], pixels.laser[at] = mean.laser[c];
  }
}

// The mean of the sub-pixels. A sheet's glow is even over a pixel: the sub-pixels count that meet no surface before it.
void RenderPass::resample(int u, int v, Changes changes, const std::vector<Glow>& glows, const std::vector<float>* haze_row) const {
  SubPixels pixel = sample_sub_pixels(u, v, changes, haze_row);
  for (const Glow& glow : glows) {
    const auto lane = static_cast<std::size_t>(u % lane_count);
    const LaneMask behind = (pixel.half[0].hit.parameter > glow.parameter[lane]) + (pixel.half[1].hit.parameter > glow.parameter[lane]);
    std::int32_t count = 0;
    for (int i = 0; i < lane_count; ++i) count -= behind[i];
    const GreyLanes values = camera_.grey(glow.radiance);
    for (std::size_t c = 0; c < camera_.channels(); ++c) pixel.grey[c] += values[c][lane] * static_cast<float>(count) / (2 * lane_count);
  }
  put(u, v, pixel);
}

// Without the glow. Whether to look for the arm, its shadows and stripes the samples about the pixel have told. Where the first eight see one surface in one light,
// the other eight are taken to see the same.
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
      sample.set(shader_.base(rays, sample.hit, 0.25f, haze, Casters::all), camera_);
    }
    if ((changes & (striped | skirted)) != 0) add_stripes(rays, 0.25f, nullptr, sample);
    if (half == 0 && kept == nullptr && sample.is_even()) {
      pixel.half[1] = sample;
      break;
    }
  }
  pixel.average(camera_.channels());
  return pixel;
}

std::vector<std::uint8_t> RenderPass::lines() const {
  std::vector<std::uint8_t> lines(live_.packets.size());
  std::transform(live_.packets.begin(), live_.packets.end(), lines.begin(),
                 [](Changes changes) { return static_cast<std::uint8_t>(changes & striped); });
  return lines;
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

// Of the lens's spot in the middle of a packet.
float RenderPass::blur_px(int u, int v) const { return static_cast<float>(lens_.sigma_px(u + 0.5 * (lane_count - 1), v)); }

RgbLanes RenderPass::albedo(int u, int v) const {
  if ((live_.packets[packet(u, v)] & hidden) == 0) return still_.albedo(u, v);
  const HitPacket hit = live_.pixels.sample(live_.pixels.index(u, v)).hit;
  return shader_.look().albedo(make_surface(camera_.row(u, v), hit), hit.shape, 1.f);
}

// Whether paint as far up or down as a stripe of this width reaches, or its spot beside, reflects otherwise than that of pixel (u + lane, v). Grain does by a fifth at most.
LaneMask RenderPass::near_marks(int u, int v, float sigma_px) const {
  constexpr int least_px = 5, most_px = 24, beside_px = 2;
  constexpr float reach_sigmas = 3.5f, most_change = 1.3f;
  const auto grey_of = [&](int at_u, int at_v) {
    if (at_u < 0 || at_u >= camera_.width() || at_v < 0 || at_v >= camera_.height()) return all_lanes(-1);
    const LaneMask shape = load_mask(&live_.pixels.shape[live_.pixels.index(at_u, at_v)]);
    const GreyLanes grey = camera_.grey(albedo(at_u, at_v));
    return select(shape >= 0, max(grey[0], max(grey[1], grey[2])), all_lanes(-1));
  };
  const Lanes here = grey_of(u, v);
  LaneMask near{};
  const auto compare = [&](Lanes there) { near |= (there >= 0.f) & ((there > most_change * here) | (most_change * there < here)); };
  const int reach_px = std::clamp(static_cast<int>(std::ceil(reach_sigmas * sigma_px)), least_px, most_px);
  for (int off = 1; off <= reach_px; ++off) compare(grey_of(u, v - off)), compare(grey_of(u, v + off));
  std::array<float, 3 * lane_count> row;
  for (int packet = 0; packet < 3; ++packet) store_lanes(row.data() + packet * lane_count, grey_of(u + (packet - 1) * lane_count, v));
  for (int off = -beside_px; off <= beside_px; ++off) compare(load_lanes(row.data() + lane_count + off));
  return near;
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
    stripe = sheet.on_surface(surface, shader_.water(), 1.f, blur_px(u, v));
  }
  const LaneMask settled = wanted & stripe.reached & (abs(stripe.offset_px) < 2e-3f) & (abs(offset_v) <= 0.75f);
  const LaneMask lit = shader_.scene().clear_of_all(sheet.emitter(), surface, settled);
  const RgbLanes albedo = shader_.look().albedo(surface, hit.shape, 1.f);
  const auto height_of = [&](const RgbLanes& irradiance) {
    RgbLanes radiance;
    for (std::size_t band = 0; band < 3; ++band) radiance[band] = albedo[band] * static_cast<float>(1 / pi) * irradiance[band];
    const GreyLanes grey = camera_.grey(radiance);
    return max(grey[0], max(grey[1], grey[2]));
  };
  const Lanes height = height_of(stripe.irradiance), scattered = height_of(stripe.skirt);
  // The other side of the pixel is of another direction: here the whole square counts.
  const Lanes sigma_v = sqrt(stripe.sigma_px * stripe.sigma_px + 1.f / 12.f) / max(abs(stripe.slope_v), all_lanes(0.02f));
  float widest = 0;
  for (int lane = 0; lane < lane_count; ++lane) widest = lit[lane] != 0 ? std::max(widest, sigma_v[lane]) : widest;
  const LaneMask by_mark = any(lit) ? near_marks(u, v, widest) : LaneMask{};
  for (int lane = 0; lane < lane_count && u + lane < camera_.width(); ++lane) {
    const float place = static_cast<float>(v) + offset_v[lane];
    if (lit[lane] != 0)
      centres.push_back({u + lane, place, height[lane], sigma_v[lane], by_mark[lane] != 0, false});
    else if (settled[lane] != 0 && scattered[lane] > 0.f)
      centres.push_back({u + lane, place, scattered[lane], 0, false, true});
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
      const StripePacket stripe = shader_.sheets[laser].on_surface(surface, shader_.water(), 1.f, blur_px(u, v));
      const Lanes offset_v = -stripe.offset_px / (abs(stripe.slope_v) > 0.02f ? stripe.slope_v : all_lanes(0.02f));
      const LaneMask near = stripe.reached & (abs(offset_v) < 0.75f);
      if (any(near)) refine_stripe(laser, u, v, offset_v, near, centres);
    }
  }
  return centres;
}

}  // namespace lf::optics
