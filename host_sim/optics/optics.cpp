#include "host_sim/optics/optics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "host_sim/optics/config_check.hpp"
#include "host_sim/optics/formation/formation.hpp"
#include "host_sim/optics/formation/particles.hpp"
#include "host_sim/optics/render_pass.hpp"
#include "host_sim/optics/worker_pool.hpp"
#include "shared/input_error.hpp"
#include "shared/random.hpp"

namespace lf::optics {
namespace {

constexpr float grain = 0.05f;        // of the albedo: anodised plates and paint
constexpr float least_part_grey = 3;  // in the picture: with less no peak stands out of the noise

// A camera with all that is kept for it from frame to frame.
struct Viewer {
  Viewer(const CameraConfig& config, const OpticsConfig& optics)
      : camera(config),
        tiles(camera),
        dark(camera, tiles, optics.scene, optics.edge_sampling),
        lit(camera, tiles, optics.scene, optics.edge_sampling),
        live(camera, tiles),
        formation(camera, optics.water.forward),
        particles(camera, optics.water, optics.seed) {}
  Camera camera;
  Tiles tiles;
  StillView dark, lit;               // without and with lamps: a sweep's pictures take turns
  const StillView* shown = nullptr;  // the one that `live` holds
  LiveView live;
  Formation formation;
  Particles particles;
};

std::vector<std::uint16_t> objects_of_shapes(const scene::Scene& scene) {
  std::vector<std::uint16_t> objects{0};  // of open water, shape -1
  for (std::size_t body = 0; body < scene.size(); ++body)
    objects.insert(objects.end(), scene[body].shapes.size(), static_cast<std::uint16_t>(body + 1));
  return objects;
}

}  // namespace

struct Optics::Impl {
  explicit Impl(const OpticsConfig& config)
      : lasers(config.lasers),
        lamps(config.lamps),
        body_count(config.scene.size()),
        seed(config.seed),
        edge_sampling(config.edge_sampling),
        water(config.water),
        scene(config.scene),
        look(config.scene, grain),
        arm(config.scene, moves),
        object_of_shape(objects_of_shapes(config.scene)),
        pool(config.threads) {
    for (const CameraConfig& camera : config.cameras) viewers.push_back(std::make_unique<Viewer>(camera, config));
    for (const LaserConfig& laser : lasers) {
      patterns.push_back(laser.pattern ? std::optional<PatternTable>(*laser.pattern) : std::nullopt);
    }
  }

  void light(const Shot& shot, Shader& shader) const {
    if (shot.laser > 0) {
      for (std::size_t i = 0; i < lasers.size(); ++i) {
        shader.sheets.emplace_back(lasers[i], shot.poses[lasers[i].body], patterns[i], shot.laser);
        if (water.scatters()) shader.sheets.back().meet(scene);
      }
    }
    if (shot.lamps > 0) {
      for (const LampConfig& lamp : lamps) shader.lamps.emplace_back(lamp, shot.poses[lamp.body], shot.lamps);
    }
  }

  std::vector<scene::BodyId> lamp_bodies(const Shot& shot) const {
    std::vector<scene::BodyId> bodies;
    if (shot.lamps > 0) {
      for (const LampConfig& lamp : lamps) bodies.push_back(lamp.body);
    }
    return bodies;
  }

  void size(const Camera& camera, const Shot& shot, Frame& frame) const {
    frame.width = camera.width();
    frame.height = camera.height();
    frame.channels = static_cast<std::int32_t>(camera.channels());
    const auto count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    frame.pixels.resize(count * camera.channels());
    frame.depth_m.resize(shot.truth ? count : 0);
    frame.object.resize(shot.truth ? count : 0);
    const std::size_t stripes = shot.truth ? lasers.size() * static_cast<std::size_t>(frame.width) : 0;
    frame.stripe_v.assign(stripes, std::numeric_limits<float>::quiet_NaN());
    frame.stripe_grey.assign(stripes, 0.f);
    frame.pieces.clear();
  }

  Exposing exposing_of(const CameraConfig& camera, const Shot& shot) const {
    const double gain = camera.gain > 0 ? shot.gain.value_or(camera.gain) / camera.gain : 1;
    const double exposure = camera.exposure.s() > 0 ? shot.exposure.value_or(camera.exposure).s() / camera.exposure.s() : 1;
    const std::uint64_t key = noise_key(seed, shot.camera, shot.frame_number);
    const double jitter = 1 + camera.exposure_jitter * static_cast<double>(normal_deviate(0, key + 2));
    return {static_cast<float>(gain * exposure * jitter), static_cast<float>(gain), key};
  }

  // Of the first laser that is on: patterns overlay each other's grains anyway.
  Speckle speckle_of(const Shader& shader) const {
    const bool on = !shader.sheets.empty();
    return Speckle(on ? lasers.front().speckle : 0, splitmix64(seed), on ? shader.sheets.front().emitter_m() : Vec3::Zero());
  }

  // Of several centres in a column the brightest counts, as it does for a peak detector.
  void find_stripes(const RenderPass& pass, const Shader& shader, const Camera& camera, float light, int tile_rows, Frame& frame) {
    for (std::size_t laser = 0; laser < shader.sheets.size(); ++laser) {
      if (patterns[laser]) continue;
      std::vector<std::vector<RenderPass::StripeCentre>> found(static_cast<std::size_t>(tile_rows));
      pool.run(tile_rows, [&](int row) { found[static_cast<std::size_t>(row)] = pass.stripe_centres(row, laser); });
      for (const auto& centres : found) {
        for (const RenderPass::StripeCentre& centre : centres) {
          const std::size_t column = laser * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(centre.u);
          const float grey = centre.grey * light * camera.sensor.vignetting(centre.u, static_cast<int>(centre.v));
          if (centre.shaded && grey < least_part_grey) continue;
          const StripePiece piece{.laser = static_cast<std::int32_t>(laser),
                                  .u = centre.u,
                                  .v = centre.v,
                                  .grey = grey,
                                  .sigma_px = centre.sigma_px,
                                  .part = centre.shaded,
                                  .near_mark = centre.near_mark};
          frame.pieces.push_back(piece);
          if (centre.shaded) continue;
          if (!(grey > frame.stripe_grey[column])) continue;
          frame.stripe_v[column] = centre.v;
          frame.stripe_grey[column] = grey;
        }
      }
    }
  }

  // Where the picture's laser light is brightest in its column, and no centre is near. Of lines only: a pattern's light is not told apart.
  void find_parts(const PixelStore& pixels, const std::vector<std::uint8_t>& line_packets, const Camera& camera, const Tiles& tiles,
                  float light, Frame& frame) {
    if (!std::all_of(patterns.begin(), patterns.end(), [](const auto& pattern) { return !pattern.has_value(); })) return;
    // Beyond 4.5 standard deviations a piece's light is under a ten-thousandth of its height: paint does not lift that over `least_part_grey`. A sheet that grazes a
    // face is wide there, and says nothing of the light on another plane; near a centre, where a peak could be matched with either, there is no part.
    constexpr float reach_sigmas = 4.5f, least_reach_px = 4;
    std::vector<std::vector<StripePiece>> centres(static_cast<std::size_t>(frame.width));
    for (const StripePiece& piece : frame.pieces) {
      if (!piece.part) centres[static_cast<std::size_t>(piece.u)].push_back(piece);
    }
    const std::size_t packets_a_row = pixels.stride / lane_count;
    const auto laser_at = [&](std::size_t at) {
      float brightest = pixels.laser[at];
      for (std::size_t c = 1; c < pixels.channels; ++c) brightest = std::max(brightest, pixels.laser[c * pixels.plane + at]);
      return brightest;
    };
    const auto in_row = [&](std::int32_t v, std::vector<StripePiece>& parts) {
      for (std::int32_t u = 0; u < frame.width; ++u) {
        if (line_packets[static_cast<std::size_t>(v) * packets_a_row + static_cast<std::size_t>(u / lane_count)] == 0) continue;
        const std::size_t at = pixels.index(u, v);
        const float here = laser_at(at);
        if (!(here > laser_at(at - pixels.stride)) || !(here >= laser_at(at + pixels.stride))) continue;
        const float grey = here * light * camera.sensor.vignetting(u, v);
        const std::vector<StripePiece>& near = centres[static_cast<std::size_t>(u)];
        const auto is_near = [&](const StripePiece& piece) {
          const float apart_px = std::abs(piece.v - static_cast<float>(v));
          if (apart_px <= least_reach_px) return true;
          if (apart_px > reach_sigmas * piece.sigma_px) return false;
          // A centre at a border may round to the pixel beside, and a little out of the picture.
          const auto row = [&](float place) { return std::clamp(static_cast<std::int32_t>(place), 0, frame.height - 1); };
          return pixels.on_one_plane(at, pixels.index(u, row(std::floor(piece.v)))) ||
                 pixels.on_one_plane(at, pixels.index(u, row(std::ceil(piece.v))));
        };
        if (grey >= least_part_grey && std::none_of(near.begin(), near.end(), is_near))
          parts.push_back({0, u, static_cast<float>(v), grey, 0, true, false});
      }
    };
    std::vector<std::vector<StripePiece>> found(static_cast<std::size_t>(tiles.rows()));
    pool.run(tiles.rows(), [&](int row) {
      const int end = std::min(tiles.end_row(row), frame.height - 1);
      for (std::int32_t v = std::max(tiles.first_row(row), 1); v < end; ++v) in_row(v, found[static_cast<std::size_t>(row)]);
    });
    for (const std::vector<StripePiece>& parts : found) frame.pieces.insert(frame.pieces.end(), parts.begin(), parts.end());
  }

  void render(const Shot& shot, Frame& frame) {
    Viewer& viewer = *viewers.at(shot.camera);
    if (shot.poses.size() != body_count) throw InputError("optics: the poses are not those of the scene's bodies");
    for (const Pose& pose : shot.poses) {
      if (!pose.matrix().allFinite()) throw InputError("optics: a body's pose is not finite");
    }
    scene.set_poses(shot.poses);
    look.set_poses(shot.poses);
    arm.set_poses(shot.poses);
    Shader shader(scene, look, water);
    light(shot, shader);
    for (SheetLight& sheet : shader.sheets) sheet.shade_by(viewer.particles.in_sheet(shot.time_s, sheet, pool));
    size(viewer.camera, shot, frame);
    StillView& still = shader.lamps.empty() ? viewer.dark : viewer.lit;
    const bool made_anew = still.update(shader, shot.poses, lamp_bodies(shot), shot.lamps, pool);
    if (made_anew || viewer.shown != &still) viewer.live.forget();
    viewer.shown = &still;

    const RenderPass pass(viewer.camera, viewer.formation.lens(), viewer.tiles, still, shader, arm, viewer.live);
    const Exposing exposing = exposing_of(viewer.camera.config, shot);
    const int tile_rows = viewer.tiles.rows();
    pool.run(tile_rows, [&](int row) { pass.sample(row); });
    pool.run(tile_rows, [&](int row) {
      pass.resample_marks(row);
      if (edge_sampling) pass.resample_edges(row);
      if (shot.truth) pass.write_geometry(row, object_of_shape, frame);
    });
    viewer.particles.stamp(shot.time_s, shader, viewer.live.pixels, pool);
    viewer.formation.spread(viewer.live.pixels, pass.lines(), water.scatters(), pool);
    const Speckle speckle = speckle_of(shader);
    const std::size_t row_bytes = frame.pixels.size() / static_cast<std::size_t>(frame.height);
    pool.run(tile_rows, [&](int row) {
      for (int v = viewer.tiles.first_row(row); v < viewer.tiles.end_row(row); ++v)
        viewer.formation.expose_row(viewer.live.pixels, v, speckle, exposing,
                                    frame.pixels.data() + static_cast<std::size_t>(v) * row_bytes);
    });
    if (!shot.truth) return;
    // Labels are of the stripe without its specks: what those make of it, a detector errs by.
    for (SheetLight& sheet : shader.sheets) sheet.shade_by({});
    find_stripes(pass, shader, viewer.camera, exposing.light, tile_rows, frame);
    if (!shader.sheets.empty()) find_parts(viewer.live.pixels, pass.lines(), viewer.camera, viewer.tiles, exposing.light, frame);
  }

  std::vector<LaserConfig> lasers;
  std::vector<LampConfig> lamps;
  std::size_t body_count;
  std::uint64_t seed;
  bool edge_sampling;
  Water water;
  SplitScene scene;
  SurfaceLook look;
  BodyBounds arm;
  std::vector<std::uint16_t> object_of_shape;
  std::vector<std::unique_ptr<Viewer>> viewers;
  std::vector<std::optional<PatternTable>> patterns;
  WorkerPool pool;
  std::mutex mutex;
};

Optics::Optics(const OpticsConfig& config) {
  check(config);
  impl_ = std::make_unique<Impl>(config);
}
Optics::~Optics() = default;
Optics::Optics(Optics&&) noexcept = default;
Optics& Optics::operator=(Optics&&) noexcept = default;

void Optics::render(const Shot& shot, Frame& frame) {
  const std::lock_guard lock(impl_->mutex);
  impl_->render(shot, frame);
}

}  // namespace lf::optics
