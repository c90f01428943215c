#include "host_sim/optics/outside_view.hpp"

#include <algorithm>

namespace lf::optics {
namespace {

Pose upright(const Vec3& eye, const Vec3& target) {
  Pose pose = Pose::Identity();
  const Vec3 z = (target - eye).normalized(), x = Vec3::UnitZ().cross(z).normalized();  // base z is down
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = eye;
  return pose;
}

CameraConfig divers_camera(const OutsideView& view) {
  CameraConfig camera;
  camera.colour = true;
  camera.intrinsics.width = view.width, camera.intrinsics.height = view.height;
  camera.intrinsics.fx = camera.intrinsics.fy = view.focal_px;
  camera.intrinsics.cx = 0.5 * (view.width - 1), camera.intrinsics.cy = 0.5 * (view.height - 1);
  camera.base_from_camera = upright(view.eye_m, view.target_m);
  camera.exposure = Duration::from_us(3500);
  camera.read_noise_grey = 0.6;
  camera.electrons_per_grey = 200;
  camera.blur_px = 0.6;
  camera.corner_light = 0.9;
  return camera;
}

// A cylinder behind its window, for the eye alone: what the arm keeps away from is `vehicle.capsules_m`.
void add_housing(const LampConfig& lamp, scene::Scene& scene) {
  scene::Shape housing;
  housing.kind = scene::ShapeKind::cylinder;
  housing.size_m = Vec3(0.028, 0, 0.080);
  housing.body_from_shape = lamp.body_from_lamp * Eigen::Translation3d(0, 0, -0.045);
  housing.albedo = {0.25f, 0.25f, 0.22f};
  housing.collides = false;
  scene[std::size_t(lamp.body)].shapes.push_back(housing);
}

}  // namespace

OutsideView OutsideView::of_panel(const Vec3& panel_m) {
  const Vec3 default_m(0.44, 0, 0.592);
  const double farther = std::max(1.0, panel_m.norm() / default_m.norm());
  OutsideView view;
  const Vec3 back_m = view.eye_m - view.target_m;
  view.target_m += (panel_m - default_m) / 2;
  view.eye_m = view.target_m + farther * back_m;
  return view;
}

OpticsConfig outside_view(const OpticsConfig& mission, const OutsideView& view) {
  OpticsConfig config = mission;
  config.cameras = {divers_camera(view)};
  for (LaserConfig& laser : config.lasers) {
    laser.power_w *= view.sheet_gain / 4;
    laser.waist_sigma_m *= 0.7, laser.divergence_rad *= 0.5;  // overexposed it looks wider than it is
    laser.band = {0.05f, 1.f, 0.16f};                         // an overexposed green line is white in its middle
    laser.speckle = 0;
  }
  for (LampConfig& lamp : config.lamps) {
    for (float& band : lamp.intensity_w_sr) band *= 3.f;
    lamp.edge_rad = 0.6;
    add_housing(lamp, config.scene);
  }
  config.water.attenuation_per_m = 0.20;
  config.water.attenuation_ratio = {1.7f, 1.0f, 0.9f};
  config.water.scattering_share = 0.8;
  config.water.asymmetry = 0.2;  // haze seen from the side
  config.water.particles_per_l = 0;
  config.water.ambient_w_m2 = {9.f, 15.f, 17.f};
  config.water.water_w_m2_sr = {0.25f, 1.9f, 3.0f};
  return config;
}

}  // namespace lf::optics
