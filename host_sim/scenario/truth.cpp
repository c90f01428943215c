#include <algorithm>
#include <array>

#include "hal/config/share.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"
#include "shared/scene/panel_scene.hpp"

namespace lf::scenario {

namespace {

using devices::DeviceFaultKind;

Pose small_pose(const Vec3& shift_m, const Vec3& turn_rad) {
  Pose pose = Pose::Identity();
  pose.translation() = shift_m;
  if (const double angle = turn_rad.norm(); angle > 0) pose.linear() = Eigen::AngleAxisd(angle, turn_rad / angle).toRotationMatrix();
  return pose;
}

ArmDescription true_arm(const Scenario& scenario) {
  ArmDescription arm = load_arm_urdf(config::find_file(scenario.arm.urdf, std::filesystem::path(scenario.file).parent_path()));
  if (scenario.jaw.torque_nm > 0) arm.joints[std::size_t(Joint::jaw)].effort_nm = arm.finger_b.effort_nm = scenario.jaw.torque_nm;
  if (scenario.jaw.pad_friction > 0) {
    for (const scene::BodyId finger : {scene::BodyId::finger_a, scene::BodyId::finger_b}) {
      for (scene::Shape& shape : arm.links[std::size_t(finger)].shapes) shape.friction = scenario.jaw.pad_friction;
    }
  }
  return arm;
}

void move_marker(scene::Body& panel, const Sample& sample) {
  const Pose error = small_pose(sample.marker_shift_m, Vec3(0, 0, sample.marker_turn_rad));
  for (scene::Shape& shape : panel.shapes) {
    if (shape.marker_id < 0) continue;
    shape.body_from_shape.translation() += error.translation();
    shape.body_from_shape.linear() = error.linear() * shape.body_from_shape.linear();
  }
}

world::WorldConfig world_config(const Scenario& scenario, const Sample& sample) {
  world::WorldConfig world;
  world.arm = true_arm(scenario);
  world.layout = scenario.panel;
  world.scene = scene::make_scene(world.arm, world.layout);
  move_marker(world.scene[std::size_t(scene::BodyId::panel)], sample);
  world.base_from_panel = true_base_from_panel(scenario.panel, sample);
  world.valve.start_rad = sample.valve_start_rad;
  world.valve.friction_nm = sample.valve_friction_nm;
  world.valve.viscous_nm_s = scenario.valve.viscous_nm_s;
  world.valve.stop_min_rad = rad_from_deg(scenario.valve.stop_min_deg);
  world.valve.stop_max_rad = rad_from_deg(scenario.valve.stop_max_deg);
  world.valve.detent_nm = scenario.valve.detent_nm;
  for (const double detent : scenario.valve.detents_deg) world.valve.detents_rad.push_back(rad_from_deg(detent));
  world.buttons.fill(scenario.buttons);
  for (world::ButtonConfig& button : world.buttons) button.stroke_m = scenario.panel.button_stroke_m;
  world.joint_drag_nm_s = scenario.physics.joint_drag_nm_s;
  world.restitution = scenario.physics.restitution;
  return world;
}

// A lamp on either side of the vehicle, wide of the camera so that little of the lit water is in its view, both at the panel's middle.
std::vector<optics::LampConfig> lamps(double power) {
  const Vec3 aim(0.44, 0.0, 0.60);
  std::vector<optics::LampConfig> all;
  for (const double side : {-0.62, 0.45}) {
    optics::LampConfig lamp;
    lamp.body_from_lamp.translation() = Vec3(0.02, side, 0.02);
    lamp.body_from_lamp.linear() =
        Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), aim - lamp.body_from_lamp.translation()).toRotationMatrix();
    for (float& band : lamp.intensity_w_sr) band *= static_cast<float>(power);
    all.push_back(lamp);
  }
  return all;
}

optics::OpticsConfig optics_config(const Scenario& scenario, const Sample& sample, const Nominal& nominal,
                                   const world::WorldConfig& world) {
  optics::OpticsConfig optics;
  optics::CameraConfig camera;
  camera.intrinsics = nominal.controller.camera.intrinsics;
  camera.base_from_camera = nominal.controller.camera.base_from_camera * small_pose(sample.camera_shift_m, sample.camera_turn_rad);
  camera.exposure = nominal.controller.camera.exposure;
  camera.read_noise_grey = sample.camera_noise_grey;
  camera.blur_px = scenario.camera.blur_px;
  optics.cameras.push_back(camera);

  optics::LaserConfig laser;
  const Pose forearm_from_tool = world.arm.joints[std::size_t(Joint::roll)].parent_from_joint * world.arm.wrist_from_tool;
  laser.body_from_laser =
      forearm_from_tool * nominal.controller.laser.tool_from_laser * small_pose(sample.laser_shift_m, sample.laser_turn_rad);
  laser.fan_half_angle_rad = nominal.controller.laser.fan_half_angle_rad;
  laser.power_w = scenario.laser.power_w;
  laser.waist_sigma_m = scenario.laser.waist_sigma_m;
  optics.lasers.push_back(laser);

  optics.lamps = lamps(scenario.lamps.power);
  optics.water.attenuation_per_m = sample.attenuation_per_m;
  optics.water.scattering_share = scenario.water.scattering_share;
  optics.water.asymmetry = scenario.water.asymmetry;
  for (float& band : optics.water.ambient_w_m2) band *= static_cast<float>(scenario.water.ambient);
  for (float& band : optics.water.water_w_m2_sr) band *= static_cast<float>(scenario.water.ambient);
  optics.scene = world.scene;
  optics.seed = sample.optics_seed;
  return optics;
}

DeviceFaultKind fault_kind(const std::string& name) {
  static constexpr std::array<std::pair<const char*, DeviceFaultKind>, 11> kinds{{{"overcurrent", DeviceFaultKind::overcurrent},
                                                                                  {"hot", DeviceFaultKind::hot},
                                                                                  {"following", DeviceFaultKind::following},
                                                                                  {"stuck_encoder", DeviceFaultKind::stuck_encoder},
                                                                                  {"silent", DeviceFaultKind::silent},
                                                                                  {"reboot", DeviceFaultKind::reboot},
                                                                                  {"estop", DeviceFaultKind::estop},
                                                                                  {"interlock_open", DeviceFaultKind::interlock_open},
                                                                                  {"drop_frames", DeviceFaultKind::drop_frames},
                                                                                  {"error_frames", DeviceFaultKind::error_frames},
                                                                                  {"bus_off", DeviceFaultKind::bus_off}}};
  for (const auto& [text, kind] : kinds) {
    if (name == text) return kind;
  }
  throw InputError("no kind of fault '" + name + "'");
}

std::uint8_t node_number(const std::string& name) {
  static constexpr std::array<const char*, joint_count> joints{"slew", "shoulder", "elbow", "roll", "jaw"};
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (name == joints[i]) return can_map::drive_nodes[i];
  }
  return name == "io" ? can_map::io_node : name == "master" ? can_map::master_node : 0;
}

devices::DevicesConfig device_config(const Scenario& scenario, const Sample& sample, const ArmDescription& arm) {
  devices::DevicesConfig config = devices::devices_config(arm, sample.joint_offset_rad, sample.devices_seed);
  for (devices::DriveConfig& drive : config.drives) {
    drive.torque_noise_ratio = scenario.physics.torque_noise_ratio;
    drive.water_celsius = scenario.physics.water_celsius;
  }
  for (const Fault& fault : scenario.faults) config.faults.push_back(device_fault(fault));
  return config;
}

}  // namespace

devices::DeviceFault device_fault(const Fault& fault) {
  return {fault.at_s, fault_kind(fault.kind), node_number(fault.node), fault.duration_s, static_cast<std::uint32_t>(fault.can_id)};
}

Pose true_base_from_panel(const PanelLayout& layout, const Sample& sample) {
  Pose pose = layout.nominal_base_from_panel();
  pose.translation() += sample.docking_shift_m;
  const Mat3 turn =
      (Eigen::AngleAxisd(sample.docking_turn_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(sample.docking_turn_rad.y(), Vec3::UnitY()) *
       Eigen::AngleAxisd(sample.docking_turn_rad.x(), Vec3::UnitX()))
          .toRotationMatrix();
  pose.linear() = turn * pose.linear();
  return pose;
}

hal::SimConfig make_truth(const Scenario& scenario, const Sample& sample, const Nominal& nominal, int render_threads) {
  hal::SimConfig sim;
  sim.world = world_config(scenario, sample);
  sim.optics = optics_config(scenario, sample, nominal, sim.world);
  sim.optics.threads = render_threads;
  sim.devices = device_config(scenario, sample, sim.world.arm);
  sim.vision.camera = nominal.controller.camera;
  sim.vision.marker = nominal.controller.marker;
  sim.vision.panel = scenario.panel;
  sim.image_latency = Duration::from_s(scenario.latency.image_ms * 1e-3);
  sim.vision_latency = Duration::from_s(scenario.latency.panel_vision_ms * 1e-3);
  return sim;
}

}  // namespace lf::scenario
