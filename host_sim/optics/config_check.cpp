#include "host_sim/optics/config_check.hpp"

#include <cmath>
#include <string>

#include "host_sim/optics/formation/gaussian_taps.hpp"
#include "shared/input_error.hpp"

namespace lf::optics {
namespace {

void require(bool ok, const std::string& message) {
  if (!ok) throw InputError("optics: " + message);
}

void require_range(double value, double low, double high, const std::string& name) {
  require(std::isfinite(value) && value >= low && value <= high,
          name + " is " + std::to_string(value) + ", must lie in " + std::to_string(low) + ".." + std::to_string(high));
}

void require_pose(const Pose& pose, const std::string& name) {
  require(pose.matrix().allFinite(), name + " is not finite");
  require((pose.linear() * pose.linear().transpose() - Mat3::Identity()).norm() < 1e-6 && pose.linear().determinant() > 0,
          name + " is not a rotation");
}

void require_light(const Rgb& bands, const std::string& name) {
  for (const float band : bands) require_range(band, 0, 1e6, name);
}

void check(const CameraConfig& camera) {
  const CameraIntrinsics& k = camera.intrinsics;
  require(k.width >= 1 && k.height >= 1 && k.width <= 8192 && k.height <= 8192, "camera: width and height must lie in 1..8192");
  require_range(k.fx, 1, 1e6, "camera: fx");
  require_range(k.fy, 1, 1e6, "camera: fy");
  require_range(k.cx, -1e5, 1e5, "camera: cx");
  require_range(k.cy, -1e5, 1e5, "camera: cy");
  for (const double d : k.distortion) require_range(d, -100, 100, "camera: a distortion coefficient");
  require_pose(camera.base_from_camera, "camera: base_from_camera");
  require_range(camera.exposure.s(), 0, 10, "camera: exposure_s");
  require_range(camera.gain, 0, 1e4, "camera: gain");
  require_range(camera.sensitivity, 0, 1e12, "camera: sensitivity");
  require_range(camera.read_noise_grey, 0, 255, "camera: read_noise_grey");
  require_range(camera.electrons_per_grey, 0, 1e9, "camera: electrons_per_grey");
  require_range(camera.blur_px, 0, GaussianTaps::widest_px, "camera: blur_px");
  require_range(camera.corner_blur, 0.1, 4, "camera: corner_blur");
  require_range(camera.stray_share, 0, 0.5, "camera: stray_share");
  require_range(camera.stray_px, 2, 100, "camera: stray_px");
  require_range(camera.ghost_share, 0, 1, "camera: ghost_share");
  require_range(camera.ghost_px, 0, 1000, "camera: ghost_px");
  require_range(camera.corner_light, 0.05, 1, "camera: corner_light");
  require_range(camera.prnu, 0, 0.2, "camera: prnu");
  require_range(camera.dsnu_grey, 0, 50, "camera: dsnu_grey");
  require_range(camera.row_noise_grey, 0, 50, "camera: row_noise_grey");
  require_range(camera.hot_pixels, 0, 0.1, "camera: hot_pixels");
  require_range(camera.exposure_jitter, 0, 0.2, "camera: exposure_jitter");
  require_light(camera.response, "camera: response");
  if (!camera.port) return;
  require_range(camera.port->distance_m, 0, 1, "camera: port distance_m");
  require_range(camera.port->thickness_m, 0, 1, "camera: port thickness_m");
  require_range(camera.port->glass_index, 1, 3, "camera: port glass_index");
  require_range(camera.port->water_index, 1, 3, "camera: port water_index");
}

void check(const LaserConfig& laser, std::size_t bodies) {
  require(laser.body < bodies, "laser: there is no such body");
  require_pose(laser.body_from_laser, "laser: body_from_laser");
  require_range(laser.fan_half_angle_rad, 0.001, 1.5, "laser: fan_half_angle_rad");
  require_range(laser.cone_rad, -1, 1, "laser: cone_rad");
  require_range(laser.power_w, 0, 1e4, "laser: power_w");
  require_light(laser.band, "laser: band");
  require_range(laser.waist_sigma_m, 1e-5, 0.1, "laser: waist_sigma_m");
  require_range(laser.divergence_rad, 0, 0.5, "laser: divergence_rad");
  require_range(laser.waist_at_m, -10, 10, "laser: waist_at_m");
  require_range(laser.lobe_share, 0, 0.5, "laser: lobe_share");
  require_range(laser.lobe_sigmas, -5, 5, "laser: lobe_sigmas");
  require(laser.fan_profile.empty() || laser.fan_profile.size() >= 2, "laser: fan_profile has one entry");
  for (const float power : laser.fan_profile) require_range(power, 0, 10, "laser: fan_profile");
  require_range(laser.speckle, 0, 0.5, "laser: speckle");
}

void check(const LampConfig& lamp, std::size_t bodies) {
  require(lamp.body < bodies, "lamp: there is no such body");
  require_pose(lamp.body_from_lamp, "lamp: body_from_lamp");
  require_light(lamp.intensity_w_sr, "lamp: intensity_w_sr");
  require_range(lamp.cone_half_angle_rad, 0.01, pi, "lamp: cone_half_angle_rad");
  require_range(lamp.edge_rad, 0, pi, "lamp: edge_rad");
}

void check(const WaterConfig& water) {
  require_range(water.attenuation_per_m, 0, 100, "water: attenuation_per_m");
  for (const float ratio : water.attenuation_ratio) require_range(ratio, 0, 100, "water: attenuation_ratio");
  require_range(water.scattering_share, -1, 1, "water: scattering_share");
  require_range(water.scattering_ratio, 0, 10, "water: scattering_ratio");
  require_range(water.back_share, 0, 1, "water: back_share");
  require_range(water.forward.core, 0, 1, "water: forward scatter's core");
  for (const ScatterTerm& term : water.forward.terms) require_range(term.weight, 1e-6, 1, "water: forward scatter's weight");
  require_range(water.forward.sum(), 0, 1.000001, "water: forward scatter's sum");
  require_range(water.asymmetry, -0.99, 0.99, "water: asymmetry");
  require_range(water.particles_per_l, 0, 1000, "water: particles_per_l");
  require(water.current_m_s.allFinite() && water.current_m_s.norm() <= 10, "water: current_m_s is not finite, or faster than 10 m/s");
  require_light(water.ambient_w_m2, "water: ambient_w_m2");
  require_light(water.water_w_m2_sr, "water: water_w_m2_sr");
}

}  // namespace

void check(const OpticsConfig& config) {
  require(!config.cameras.empty(), "at least one camera is needed");
  require(config.lasers.size() <= 16 && config.lamps.size() <= 15, "at most 16 lasers and 15 lamps");
  require(config.scene.size() <= scene::max_bodies, "scene: more than " + std::to_string(scene::max_bodies) + " bodies");
  require(config.threads >= 1 && config.threads <= 1024, "threads must lie in 1..1024");
  for (const CameraConfig& camera : config.cameras) check(camera);
  for (const LaserConfig& laser : config.lasers) check(laser, config.scene.size());
  for (const LampConfig& lamp : config.lamps) check(lamp, config.scene.size());
  check(config.water);
}

}  // namespace lf::optics
