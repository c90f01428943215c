// Small scenes for the optics tests: the camera looks along base x from the origin unless a test moves it.
#pragma once

#include <cmath>
#include <vector>

#include "host_sim/optics/optics.hpp"
#include "host_sim/optics/shader.hpp"
#include "tests/arm5e_bodies.hpp"

namespace lf::optics::test {

// A camera or lamp at `position` that looks along `axis`, upright in the base frame (z down).
inline Pose looking(const Vec3& position, const Vec3& axis) {
  Pose pose = Pose::Identity();
  const Vec3 z = axis.normalized(), x = Vec3::UnitZ().cross(z).normalized();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = position;
  return pose;
}

// A laser at `position` whose sheet holds `axis` and `along`.
inline Pose sheet(const Vec3& position, const Vec3& axis, const Vec3& along) {
  Pose pose = Pose::Identity();
  const Vec3 z = axis.normalized(), x = along.cross(z).normalized();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = position;
  return pose;
}

inline scene::Shape make_shape(scene::ShapeKind kind, const Vec3& size_m, const Vec3& position, float albedo = 0.5f) {
  scene::Shape shape;
  shape.kind = kind;
  shape.size_m = size_m;
  shape.body_from_shape.setIdentity();
  shape.body_from_shape.translation() = position;
  shape.albedo = {albedo, albedo, albedo};
  return shape;
}

inline scene::Body& body(scene::Scene& scene, scene::BodyId id) { return scene[static_cast<std::size_t>(id)]; }

// A plate facing the camera: its near face at x = distance.
inline scene::Scene plate_scene(double distance_m, float albedo = 0.5f) {
  scene::Scene scene = scene::bare_scene();
  body(scene, arm5e_body::panel).shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 2, 2}, {distance_m + 0.01, 0, 0}, albedo));
  return scene;
}

inline scene::BodyPoses resting() { return scene::poses_at_origin(scene::bare_scene()); }

// Without what lens and sensor do beside the lens's spot.
inline CameraConfig lossless(CameraConfig camera) {
  camera.stray_share = camera.ghost_share = camera.prnu = camera.dsnu_grey = camera.row_noise_grey = camera.hot_pixels =
      camera.exposure_jitter = 0;
  camera.corner_light = camera.corner_blur = 1;
  return camera;
}

inline CameraConfig quiet_camera() {
  CameraConfig camera;
  camera.base_from_camera = looking(Vec3::Zero(), Vec3::UnitX());
  camera.read_noise_grey = 0;
  camera.electrons_per_grey = 0;
  return lossless(camera);
}

inline LaserConfig vehicle_laser(const Pose& base_from_laser) {
  LaserConfig laser;
  laser.body = arm5e_body::vehicle;
  laser.body_from_laser = base_from_laser;
  laser.speckle = 0;
  return laser;
}

inline WaterConfig dark_clear_water() {
  WaterConfig water;
  water.attenuation_per_m = 0;
  water.ambient_w_m2 = water.water_w_m2_sr = {0, 0, 0};
  return water;
}

// The renderer's inside without the sensor: radiance as floating point.
struct Bench {
  Bench(const scene::Scene& bodies, const WaterConfig& config, const scene::BodyPoses& poses = resting(), float grain = 0)
      : water(config), scene(bodies), look(bodies, grain), shader(scene, look, water) {
    scene.set_poses(poses);
    look.set_poses(poses);
  }
  void add(const LaserConfig& laser, const scene::BodyPoses& poses = resting()) {
    shader.sheets.emplace_back(laser, poses[static_cast<std::size_t>(laser.body)], no_pattern);
  }
  void add(const LampConfig& lamp, const scene::BodyPoses& poses = resting()) {
    shader.lamps.emplace_back(lamp, poses[static_cast<std::size_t>(lamp.body)]);
  }
  // Green radiance at pixel (u, v), one sample of a whole pixel.
  float green(const CameraConfig& camera, const CameraRays& rays, int u, int v) const {
    const RayPacket packet = rays.around(CameraPlace(camera.base_from_camera), u, v, Lanes{}, Lanes{});
    const HitPacket hit = scene.all(packet);
    const Light stripes = shader.stripes(packet, hit, 1.f, nullptr, static_cast<float>(camera.blur_px));
    float green = shader.base(packet, hit, 1.f, {}, Casters::all).radiance[1][0] + stripes.radiance[1][0] + stripes.laser[1][0];
    for (const SheetLight& sheet : shader.sheets) {
      const Glow glow = sheet.glow(packet, water);
      if (glow.parameter[0] < hit.parameter[0]) green += glow.radiance[1][0];
    }
    return green;
  }

  std::optional<PatternTable> no_pattern;
  Water water;
  SplitScene scene;
  SurfaceLook look;
  Shader shader;
};

}  // namespace lf::optics::test
