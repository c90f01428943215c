#include "host_sim/optics/still_view.hpp"

#include <algorithm>
#include <bit>

namespace lf::optics {
namespace {

bool same(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }

const std::vector<float>* if_any(const std::vector<float>& row) { return row.empty() ? nullptr : &row; }

}  // namespace

void SubPixels::average(std::size_t channels) {
  const auto mean = [this](GreyLanes Sample::*of, std::size_t c) {
    float sum = 0;
    for (const Sample& samples : half) {
      for (int i = 0; i < lane_count; ++i) sum += (samples.*of)[c][i];
    }
    return sum / (2 * lane_count);
  };
  for (std::size_t c = 0; c < channels; ++c) {
    grey[c] = mean(&Sample::grey, c);
    scattered[c] = mean(&Sample::scattered, c);
    laser[c] = mean(&Sample::laser, c);
  }
}

StillView::StillView(const Camera& camera, const Tiles& tiles, const scene::Scene& scene, bool edge_sampling)
    : camera_(camera),
      tiles_(tiles),
      edge_sampling_(edge_sampling),
      packets_a_row_(static_cast<std::size_t>((camera.width() + lane_count - 1) / lane_count)),
      stale_(tiles.count()),
      packets_(packets_a_row_ * static_cast<std::size_t>(camera.height())),
      kept_(tiles.count()),
      lamp_cones_(tiles.count()) {
  pixels_.resize(camera.width(), camera.height(), camera.channels());
  for (std::vector<float>& band : albedo_) band.resize(pixels_.plane);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (fixed(scene[i])) fixed_.push_back(i);
    if (!yields(scene[i])) continue;
    yielding_.push_back({i, BodyBounds(scene, [&](const scene::Body& body) { return &body == &scene[i]; }), Pose::Identity()});
  }
}

// Marks what is no longer true and takes note of what will be. Returns whether there is any.
bool StillView::find_stale(const scene::BodyPoses& poses, const std::vector<scene::BodyId>& lamp_bodies, float lamp_share) {
  std::vector<Pose> fixed_poses;
  for (const std::size_t body : fixed_) fixed_poses.push_back(poses[body]);
  for (const scene::BodyId body : lamp_bodies) fixed_poses.push_back(poses[body]);
  const bool all = lamp_bodies != lamp_bodies_ || lamp_share != lamp_share_ ||
                   !std::equal(fixed_poses.begin(), fixed_poses.end(), fixed_poses_.begin(), fixed_poses_.end(), same);
  lamp_bodies_ = lamp_bodies;
  lamp_share_ = lamp_share;
  fixed_poses_ = std::move(fixed_poses);
  std::fill(stale_.begin(), stale_.end(), std::uint8_t{all});
  bool any_stale = all;
  for (Yielding& part : yielding_) {
    if (same(part.pose, poses[part.body]) && !all) continue;
    if (!all) mark(part.bounds);
    part.pose = poses[part.body];
    part.bounds.set_poses(poses);
    if (!all) mark(part.bounds);
    any_stale = true;
  }
  return any_stale;
}

void StillView::mark(const BodyBounds& bodies) {
  for (std::size_t tile = 0; tile < stale_.size(); ++tile) {
    if (stale_[tile] == 0 && (bodies.may_meet(tiles_.view(tile)) || may_be_shaded(tile, bodies))) stale_[tile] = 1;
  }
}

bool StillView::update(const Shader& shader, const scene::BodyPoses& poses, const std::vector<scene::BodyId>& lamp_bodies, float lamp_share,
                       WorkerPool& pool) {
  if (!find_stale(poses, lamp_bodies, lamp_share)) return false;
  haze_.reset();
  if (!shader.lamps.empty()) {
    haze_.emplace(camera_.rays, camera_.place, camera_.width(), camera_.height(), shader.lamps, shader.water());
  }
  pool.run(tiles_.rows(), [&](int tile_row) { sample_tiles(shader, tile_row); });
  pool.run(tiles_.rows(), [&](int tile_row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      if (!stale_about(column, tile_row)) continue;
      if (edge_sampling_) keep_edges(shader, column, tile_row);
      bound_reached_points(shader, column, tile_row);
    }
  });
  return true;
}

// A tile's edges look at the pixels round it.
bool StillView::stale_about(int column, int tile_row) const {
  for (int row = std::max(0, tile_row - 1); row <= std::min(tiles_.rows() - 1, tile_row + 1); ++row) {
    for (int c = std::max(0, column - 1); c <= std::min(tiles_.columns() - 1, column + 1); ++c) {
      if (stale_[tiles_.at(c * Tiles::width_px, row * Tiles::height_px)] != 0) return true;
    }
  }
  return false;
}

void StillView::sample_tiles(const Shader& shader, int tile_row) {
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    std::vector<float> haze;
    for (int u = 0; u < camera_.width(); u += lane_count) {
      if (stale_[tiles_.at(u, v)] == 0) continue;
      if (haze.empty()) haze = haze_row(v);
      sample_packet(shader, u, v, if_any(haze));
    }
  }
}

void StillView::sample_packet(const Shader& shader, int u, int v, const std::vector<float>* haze_row) {
  const RayPacket rays = camera_.row(u, v);
  Sample sample;
  sample.hit = shader.scene().resting(rays);
  const Light light = shader.base(rays, sample.hit, 1.f, {haze_row, static_cast<float>(u), 1.f}, Casters::resting);
  sample.set(light, camera_);
  const std::size_t i = pixels_.index(u, v);
  pixels_.set(i, sample);
  for (std::size_t band = 0; band < albedo_.size(); ++band) store_lanes(&albedo_[band][i], light.albedo[band]);
  packets_[packet(u, v)] = {!any(sample.hit.shape >= 0), 0, 0};
}

void StillView::keep_edges(const Shader& shader, int column, int tile_row) {
  const int first_u = column * Tiles::width_px, end_u = std::min(first_u + Tiles::width_px, camera_.width());
  std::vector<SubPixels>& kept = kept_[tiles_.at(first_u, tiles_.first_row(tile_row))];
  kept.clear();
  for (int v = tiles_.first_row(tile_row); v < tiles_.end_row(tile_row); ++v) {
    std::vector<float> haze;
    for (int u = first_u; u < end_u; u += lane_count) {
      const LaneMask edge = pixels_.edges(u, v);
      Packet& p = packets_[packet(u, v)];
      p.edges = 0, p.first_kept = static_cast<std::uint32_t>(kept.size());
      for (int lane = 0; lane < lane_count; ++lane) {
        if (edge[lane] == 0) continue;
        if (haze.empty()) haze = haze_row(v);
        p.edges |= static_cast<std::uint8_t>(1 << lane);
        kept.push_back(trace_sub_pixels(shader, u + lane, v, if_any(haze)));
      }
    }
  }
}

SubPixels StillView::trace_sub_pixels(const Shader& shader, int u, int v, const std::vector<float>* haze_row) const {
  SubPixels pixel;
  for (int half = 0; half < 2; ++half) {
    const RayPacket rays = camera_.sub_pixels(u, v, half);
    Sample& sample = pixel.half[static_cast<std::size_t>(half)];
    sample.hit = shader.scene().resting(rays);
    const Light light = shader.base(rays, sample.hit, 0.25f, {haze_row, static_cast<float>(u), 0.f}, Casters::resting);
    sample.set(light, camera_);
  }
  pixel.average(camera_.channels());
  return pixel;
}

// From each lamp a cone about what it reaches of the tile and of a ring of packets and rows round it, which holds the tile's sub-pixels too.
void StillView::bound_reached_points(const Shader& shader, int column, int tile_row) {
  const int first_v = std::max(0, tiles_.first_row(tile_row) - 1), end_v = std::min(camera_.height(), tiles_.end_row(tile_row) + 1);
  const int tile_u = column * Tiles::width_px;
  const int first_u = std::max(0, tile_u - lane_count), end_u = std::min(camera_.width(), tile_u + Tiles::width_px + lane_count);
  std::vector<Cone>& cones = lamp_cones_[tiles_.at(tile_u, tiles_.first_row(tile_row))];
  cones.clear();
  for (std::size_t lamp = 0; lamp < shader.lamps.size(); ++lamp) {
    if (!shader.lamps[lamp].casts_shadows()) continue;
    Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
    for (int v = first_v; v < end_v; ++v) {
      for (int u = first_u; u < end_u; u += lane_count) {
        const Sample sample = pixels_.sample(pixels_.index(u, v));
        const RayLines rays = camera_.lines(u, v);
        const Lanes3 point = rays.origin + rays.direction * sample.hit.parameter;
        for (int lane = 0; lane < lane_count; ++lane) {
          if ((sample.reached[lane] >> (16 + lamp) & 1) == 0) continue;
          const Vec3 p(point.x[lane], point.y[lane], point.z[lane]);
          low = low.cwiseMin(p), high = high.cwiseMax(p);
        }
      }
    }
    if (high.x() < low.x()) continue;
    cones.push_back(Cone::about_sphere(shader.lamps[lamp].place_m(), 0.5 * (low + high), 0.5 * (high - low).norm()));
  }
}

RgbLanes StillView::albedo(int u, int v) const {
  const std::size_t i = pixels_.index(u, v);
  return {load_lanes(&albedo_[0][i]), load_lanes(&albedo_[1][i]), load_lanes(&albedo_[2][i])};
}

LaneMask StillView::edges(int u, int v) const {
  constexpr LaneMask bit{1, 2, 4, 8, 16, 32, 64, 128};
  return (bit & static_cast<std::int32_t>(packets_[packet(u, v)].edges)) != 0;
}

const SubPixels* StillView::sub_pixels(int u, int v) const {
  const Packet& p = packets_[packet(u, v)];
  const unsigned lane = static_cast<unsigned>(u % lane_count);
  if ((p.edges >> lane & 1) == 0) return nullptr;
  const auto before = static_cast<std::uint32_t>(std::popcount(p.edges & ((1u << lane) - 1)));
  return &kept_[tiles_.at(u, v)][p.first_kept + before];
}

std::vector<float> StillView::haze_row(int v) const { return haze_ ? haze_->row(v) : std::vector<float>{}; }

bool StillView::may_be_shaded(std::size_t tile, const BodyBounds& bodies) const {
  return std::any_of(lamp_cones_[tile].begin(), lamp_cones_[tile].end(), [&](const Cone& cone) { return bodies.may_meet(cone); });
}

}  // namespace lf::optics
