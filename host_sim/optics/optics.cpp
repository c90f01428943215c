#include "host_sim/optics/optics.hpp"

#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "host_sim/optics/config_check.hpp"
#include "host_sim/optics/render_pass.hpp"
#include "host_sim/optics/worker_pool.hpp"
#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

constexpr float grain = 0.05f;  // of the albedo: anodised plates and paint

struct Camera {
  explicit Camera(const CameraConfig& camera) : config(camera), rays(camera.intrinsics, camera.port), sensor(camera) {}
  CameraConfig config;
  CameraRays rays;
  Sensor sensor;
};

std::vector<std::uint16_t> objects_of_shapes(const scene::Scene& scene) {
  std::vector<std::uint16_t> objects;
  for (std::size_t body = 0; body < scene.size(); ++body)
    objects.insert(objects.end(), scene[body].shapes.size(), static_cast<std::uint16_t>(body + 1));
  return objects;
}

}  // namespace

struct Optics::Impl {
  explicit Impl(const OpticsConfig& config)
      : lasers(config.lasers),
        lamps(config.lamps),
        seed(config.seed),
        edge_sampling(config.edge_sampling),
        water(config.water),
        scene(config.scene),
        look(config.scene, grain),
        object_of_shape(objects_of_shapes(config.scene)),
        pool(config.threads) {
    for (const CameraConfig& camera : config.cameras) cameras.emplace_back(camera);
    for (const LaserConfig& laser : lasers) {
      patterns.push_back(laser.pattern ? std::optional<PatternTable>(*laser.pattern) : std::nullopt);
    }
  }

  void light(const Shot& shot, Shader& shader) const {
    if (shot.laser) {
      for (std::size_t i = 0; i < lasers.size(); ++i) {
        shader.sheets.emplace_back(lasers[i], shot.poses[static_cast<std::size_t>(lasers[i].body)], patterns[i]);
      }
    }
    if (shot.lamps) {
      for (const LampConfig& lamp : lamps) shader.lamps.emplace_back(lamp, shot.poses[static_cast<std::size_t>(lamp.body)]);
    }
  }

  void size(const Camera& camera, const Shot& shot, Frame& frame) {
    frame.width = camera.config.intrinsics.width;
    frame.height = camera.config.intrinsics.height;
    frame.channels = camera.config.colour ? 3 : 1;
    const auto count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    frame.pixels.resize(count * static_cast<std::size_t>(frame.channels));
    frame.depth_m.resize(shot.truth ? count : 0);
    frame.object.resize(shot.truth ? count : 0);
    const std::size_t stripes = shot.truth ? lasers.size() * static_cast<std::size_t>(frame.width) : 0;
    frame.stripe_v.assign(stripes, std::numeric_limits<float>::quiet_NaN());
    frame.stripe_grey.assign(stripes, 0.f);
    store.resize(frame.width, frame.height, frame.channels);
  }

  // Of several centres in a column the brightest counts, as it does for a peak detector.
  void find_stripes(const RenderPass& pass, const Shader& shader, Frame& frame) {
    for (std::size_t laser = 0; laser < shader.sheets.size(); ++laser) {
      if (patterns[laser]) continue;
      std::vector<std::vector<RenderPass::StripeCentre>> found(static_cast<std::size_t>(pass.blocks()));
      pool.run(pass.blocks(), [&](int block) { found[static_cast<std::size_t>(block)] = pass.stripe_centres(block, laser); });
      for (const auto& centres : found) {
        for (const RenderPass::StripeCentre& centre : centres) {
          const std::size_t column = laser * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(centre.u);
          if (!(centre.grey > frame.stripe_grey[column])) continue;
          frame.stripe_v[column] = centre.v;
          frame.stripe_grey[column] = centre.grey;
        }
      }
    }
  }

  void render(const Shot& shot, Frame& frame) {
    const Camera& camera = cameras.at(shot.camera);
    for (const Pose& pose : shot.poses) {
      if (!pose.matrix().allFinite()) throw InputError("optics: a body's pose is not finite");
    }
    scene.set_poses(shot.poses);
    look.set_poses(shot.poses);
    Shader shader(scene, look, water);
    light(shot, shader);
    size(camera, shot, frame);
    std::optional<LampHaze> haze;
    if (!shader.lamps.empty()) {
      haze.emplace(camera.rays, CameraPlace(camera.config.base_from_camera), frame.width, frame.height, shader.lamps, water);
    }
    const RenderPass pass(camera.config, camera.rays, camera.sensor, shader, haze ? &*haze : nullptr, store);
    const std::uint64_t key = noise_key(seed, shot.camera, shot.frame_number);
    pool.run(pass.blocks(), [&](int block) { pass.sample_block(block); });
    if (edge_sampling) resampled.resize(store.grey.size());
    pool.run(pass.blocks(), [&](int block) {
      if (edge_sampling) pass.resample_edges(block, resampled);
      pass.expose_block(block, edge_sampling ? resampled : store.grey, key, frame);
      if (shot.truth) pass.write_geometry(block, object_of_shape, frame);
    });
    if (shot.truth) find_stripes(pass, shader, frame);
  }

  std::vector<LaserConfig> lasers;
  std::vector<LampConfig> lamps;
  std::uint64_t seed;
  bool edge_sampling;
  Water water;
  RayScene scene;
  SurfaceLook look;
  std::vector<std::uint16_t> object_of_shape;
  std::vector<Camera> cameras;
  std::vector<std::optional<PatternTable>> patterns;
  WorkerPool pool;
  PixelStore store;
  std::vector<float> resampled;
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
