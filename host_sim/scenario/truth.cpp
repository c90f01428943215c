#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "hal/config/drive_kind.hpp"
#include "hal/config/fault_kinds.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/share.hpp"
#include "host_sim/devices/drive/drive_dictionary.hpp"
#include "host_sim/optics/formation/gaussian_taps.hpp"
#include "host_sim/scenario/bounds.hpp"
#include "host_sim/scenario/drive_make.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scene_file.hpp"
#include "host_sim/scenario/true_vehicle.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "shared/input_error.hpp"
#include "shared/random.hpp"
#include "shared/scene/panel_scene.hpp"

namespace lf::scenario {

namespace {

using devices::DeviceFaultKind;

constexpr const char* limits_refused = "limits_refused";

Pose small_pose(const Vec3& shift_m, const Vec3& turn_rad) {
  Pose pose = Pose::Identity();
  pose.translation() = shift_m;
  if (const double angle = turn_rad.norm(); angle > 0) pose.linear() = Eigen::AngleAxisd(angle, turn_rad / angle).toRotationMatrix();
  return pose;
}

ArmDescription true_arm(const Scenario& scenario) {
  ArmDescription arm = load_arm_urdf(config::find_file(scenario.arm.urdf, std::filesystem::path(scenario.file).parent_path()));
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    arm.joints[i].holding_torque_nm = config::held_nm(arm.joints[i], config::drive_of(scenario.drives, i));
  if (scenario.jaw.torque_nm > 0) arm.jaw().effort_nm = arm.finger_b.effort_nm = scenario.jaw.torque_nm;
  if (scenario.jaw.pad_friction > 0) {
    const scene::OwnBodies own(arm.arm_joints());
    for (const scene::BodyId finger : {own.finger_a(), own.finger_b()}) {
      for (scene::Shape& shape : arm.links[finger].shapes) shape.friction = scenario.jaw.pad_friction;
    }
  }
  return arm;
}

void move_markers(scene::Body& panel, const Sample& sample) {
  std::size_t next = 0;
  for (scene::Shape& shape : panel.shapes) {
    if (shape.marker_id < 0) continue;
    const Sample::Marker& error_of = sample.markers.at(next++);
    const Pose error = small_pose(error_of.shift_m, Vec3(0, 0, error_of.turn_rad));
    // A plate that one edge holds off the panel: about its middle it is turned, and lifted by half as much.
    const Vec3 tilt = Vec3(error_of.flat_m.y(), -error_of.flat_m.x(), 0) / shape.size_m.x();
    shape.body_from_shape.translation() += error.translation() + Vec3(0, 0, 0.5 * error_of.flat_m.lpNorm<1>());
    shape.body_from_shape.linear() = small_pose(Vec3::Zero(), tilt).linear() * error.linear() * shape.body_from_shape.linear();
  }
}

// The panel as it was built: its buttons off their drawn places, its parts off their drawn sizes.
PanelLayout true_layout(PanelLayout layout, const Sample& sample) {
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    const Vec3& off_m = sample.valves.at(i).size_m;
    layout.valves[i].handle_length_m += off_m.x();
    layout.valves[i].handle_thickness_m += off_m.y();
    layout.valves[i].handle_height_m += off_m.z();
  }
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
    const Sample::Button& off = sample.buttons.at(i);
    layout.buttons[i].at_m += off.shift_m;
    layout.buttons[i].width_m += off.size_m.x();
    layout.buttons[i].height_m += off.size_m.y();
  }
  for (std::size_t i = 0; i < layout.markers.size(); ++i) layout.markers[i].size_m += sample.markers.at(i).size_m;
  return layout;
}

// Distortion terms whose shift at the picture's corner is so many px.
void distort(CameraIntrinsics& k, const Vec3& corner_px) {
  const Vec2 corner(k.cx / k.fx, k.cy / k.fy);
  const double r2 = corner.squaredNorm(), f = std::sqrt(k.fx * k.fy);
  k.distortion[0] += corner_px[0] / (f * r2 * std::sqrt(r2));
  k.distortion[2] += corner_px[1] / (f * 3 * r2);
  k.distortion[3] += corner_px[2] / (f * 3 * r2);
}

CameraIntrinsics true_intrinsics(CameraIntrinsics k, const Sample& sample) {
  k.cx += sample.principal_point_px.x(), k.cy += sample.principal_point_px.y();
  k.fx *= sample.focal_ratio, k.fy *= sample.focal_ratio;
  distort(k, sample.distortion_px);
  return k;
}

world::ValveConfig valve_config(const config::ValveNature& nature, const PanelLayout::Valve& layout, const Sample::Valve& sample) {
  world::ValveConfig valve;
  valve.start_rad = sample.start_rad;
  valve.friction_nm = sample.friction_nm;
  valve.viscous_nm_s = nature.viscous_nm_s;
  valve.stop_min_rad = layout.handle_min_rad;
  valve.stop_max_rad = layout.handle_max_rad;
  valve.detent_nm = nature.detent_nm;
  for (const double detent : nature.detents_deg) valve.detents_rad.push_back(rad_from_deg(detent));
  return valve;
}

world::WorldConfig world_config(const Scenario& scenario, const Sample& sample) {
  world::WorldConfig world;
  world.arm = true_arm(scenario);
  const ArmJoint& jaw = world.arm.jaw();
  const std::size_t arm_joints = world.arm.arm_joints();
  world.start_rad = {};
  world.drive_stiffness_nm_rad = {};
  for (std::size_t i = 0; i <= arm_joints; ++i) world.drive_stiffness_nm_rad[i] = stiffness_nm_rad(world.arm, i);
  world.start_rad[arm_joints] = std::clamp(world::half_open_rad, jaw.lower_rad, jaw.upper_rad);
  std::copy_n(scenario.arm.park_rad.begin(), std::min(scenario.arm.park_rad.size(), arm_joints), world.start_rad.begin());
  world.layout = true_layout(scenario.panel, sample);
  world.scene = scene::make_scene(world.arm, world.layout, scenario.survey.names, vehicle_shapes(scenario));
  move_markers(world.scene[scene::OwnBodies(arm_joints).panel()], sample);
  world.base_from_panel = true_base_from_panel(scenario.panel, sample);
  if (scenario.objects) {
    for (scene::Body& object : placed_objects(*scenario.objects, world.base_from_panel)) world.scene.push_back(std::move(object));
  }
  const std::vector<config::ValveNature> natures = valve_natures(scenario);
  world.valves.clear();
  for (std::size_t i = 0; i < scenario.panel.valves.size(); ++i)
    world.valves.push_back(valve_config(natures.at(i), scenario.panel.valves[i], sample.valves.at(i)));
  const std::vector<std::size_t> caps = scene::bodies_of(world.scene, scene::Role::button);
  world.buttons.assign(scenario.panel.buttons.size(), scenario.buttons);
  const auto broken = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (std::size_t i = 0; i < world.buttons.size(); ++i) {
    const std::string& name = scenario.survey.names.buttons.at(i);
    world.buttons[i].stroke_m = scenario.panel.buttons[i].stroke_m;
    world.buttons[i].stuck = broken(scenario.buttons.stuck, name);
    if (broken(scenario.buttons.missing, name)) world.scene[caps.at(i)].shapes.clear();
  }
  world.joint_drag_nm_s = scenario.physics.joint_drag_nm_s;
  world.drag_coefficient = scenario.physics.drag_coefficient;
  world.restitution = scenario.physics.restitution;
  return world;
}

// Waves of these numbers along the fan, of random phases, that change the power by `most` of it at most.
void add_waves(int first, int last, double most, std::uint64_t seed, std::vector<float>& profile) {
  std::vector<double> sum(profile.size());
  for (int wave = first; wave <= last; ++wave) {
    const double phase = 2 * pi * uniform(seed, "wave." + std::to_string(wave));
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += std::cos(pi * wave * static_cast<double>(i) / static_cast<double>(sum.size() - 1) + phase);
  }
  double mean = 0, greatest = 0;
  for (const double value : sum) mean += value / static_cast<double>(sum.size());
  for (const double value : sum) greatest = std::max(greatest, std::abs(value - mean));
  for (std::size_t i = 0; i < sum.size(); ++i) profile[i] += static_cast<float>(most * (sum[i] - mean) / greatest);
}

// Low orders of a line's optics, and fine structure of some 2 to 7 px here.
std::vector<float> fan_profile(const Sample& sample) {
  std::vector<float> profile(513, 1.f);
  if (sample.fan_low_ratio > 0) add_waves(1, 4, sample.fan_low_ratio, sample.fan_seed, profile);
  if (sample.fan_fine_ratio > 0) add_waves(40, 120, sample.fan_fine_ratio, splitmix64(sample.fan_seed), profile);
  return profile;
}

optics::OpticsConfig optics_config(const Scenario& scenario, const Sample& sample, const Nominal& nominal,
                                   const world::WorldConfig& world) {
  optics::OpticsConfig optics;
  optics::CameraConfig camera;
  camera.intrinsics = true_intrinsics(nominal.controller.camera.intrinsics, sample);
  camera.serial = sample.optics_seed;
  camera.base_from_camera = nominal.controller.camera.base_from_camera * small_pose(sample.camera_shift_m, sample.camera_turn_rad);
  camera.exposure = nominal.controller.camera.exposure;
  camera.read_noise_grey = sample.camera_noise_grey;
  camera.blur_px = std::min(scenario.camera.blur_px * sample.lens_ratio, optics::GaussianTaps::widest_px);
  camera.corner_blur = sample.corner_blur;
  camera.electrons_per_grey = sample.electrons_per_grey;
  camera.exposure_jitter = sample.exposure_jitter;
  camera.ghost_share = sample.ghost_share;
  camera.ghost_px = sample.ghost_px;
  optics.cameras.push_back(camera);

  optics::LaserConfig laser;
  const scene::OwnBodies own(world.arm.arm_joints());
  laser.body = world.arm.rolls ? own.before_hand() : own.hand;
  laser.body_from_laser =
      world.arm.laser_link_from_tool() * nominal.controller.laser.tool_from_laser * small_pose(sample.laser_shift_m, sample.laser_turn_rad);
  // Bent to a cone, the sheet keeps its middle where the calibration found it.
  laser.cone_rad = sample.laser_cone_rad;
  laser.body_from_laser.linear() =
      laser.body_from_laser.linear() * Eigen::AngleAxisd(-sample.laser_cone_rad, Vec3::UnitY()).toRotationMatrix();
  laser.fan_half_angle_rad = nominal.controller.laser.fan_half_angle_rad;
  laser.power_w = scenario.laser.power_w;
  laser.waist_sigma_m = scenario.laser.waist_sigma_m * sample.beam_ratio;
  laser.divergence_rad *= sample.beam_ratio;
  laser.speckle = sample.speckle;
  laser.waist_at_m = sample.waist_at_m;
  laser.lobe_share = sample.lobe_share;
  laser.lobe_sigmas = sample.lobe_sigmas;
  laser.fan_profile = fan_profile(sample);
  optics.lasers.push_back(laser);

  optics.lamps = lamps(scenario);
  optics.water.attenuation_per_m = sample.attenuation_per_m;
  optics.water.scattering_share = scenario.water.scattering_share;
  optics.water.asymmetry = scenario.water.asymmetry;
  optics.water.scattering_ratio = sample.scattering_ratio;
  optics.water.forward = optics.water.forward.varied(sample.forward_ratio);
  optics.water.back_share *= sample.back_ratio;
  optics.water.particles_per_l = sample.particles_per_l;
  for (float& band : optics.water.ambient_w_m2) band *= static_cast<float>(scenario.water.ambient);
  for (float& band : optics.water.water_w_m2_sr) band *= static_cast<float>(scenario.water.ambient);
  optics.scene = world.scene;
  optics.seed = sample.optics_seed;
  return optics;
}

// The names of config::fault_kinds() that the devices make; a test holds the tables against each other.
constexpr std::array<std::pair<const char*, DeviceFaultKind>, 23> device_kinds{{{"overcurrent", DeviceFaultKind::overcurrent},
                                                                                {"hot", DeviceFaultKind::hot},
                                                                                {"following", DeviceFaultKind::following},
                                                                                {"stuck_encoder", DeviceFaultKind::stuck_encoder},
                                                                                {"silent", DeviceFaultKind::silent},
                                                                                {"reboot", DeviceFaultKind::reboot},
                                                                                {"estop", DeviceFaultKind::estop},
                                                                                {"interlock_open", DeviceFaultKind::interlock_open},
                                                                                {"drop_frames", DeviceFaultKind::drop_frames},
                                                                                {"error_frames", DeviceFaultKind::error_frames},
                                                                                {"bus_off", DeviceFaultKind::bus_off},
                                                                                {"encoder_jump", DeviceFaultKind::encoder_jump},
                                                                                {"torque_frozen", DeviceFaultKind::torque_frozen},
                                                                                {"torque_high", DeviceFaultKind::torque_high},
                                                                                {"runaway", DeviceFaultKind::runaway},
                                                                                {"wrong_identity", DeviceFaultKind::wrong_identity},
                                                                                {"foreign_rpdo", DeviceFaultKind::foreign_rpdo},
                                                                                {"foreign_sdo", DeviceFaultKind::foreign_sdo},
                                                                                {"foreign_sync", DeviceFaultKind::foreign_sync},
                                                                                {"foreign_nmt", DeviceFaultKind::foreign_nmt},
                                                                                {"foreign_reset", DeviceFaultKind::foreign_reset},
                                                                                {"foreign_heartbeat", DeviceFaultKind::foreign_heartbeat},
                                                                                {"foreign_master", DeviceFaultKind::foreign_master}}};

// Those that the platform makes.
constexpr std::array<std::pair<const char*, hal::SimFaultKind>, 20> platform_kinds{
    {{"clock_lost", hal::SimFaultKind::clock_lost},
     {"can_receive_fails", hal::SimFaultKind::can_receive_fails},
     {"can_send_fails", hal::SimFaultKind::can_send_fails},
     {"camera_fails", hal::SimFaultKind::camera_fails},
     {"panel_submit_fails", hal::SimFaultKind::panel_submit_fails},
     {"panel_receive_fails", hal::SimFaultKind::panel_receive_fails},
     {"telemetry_fails", hal::SimFaultKind::telemetry_fails},
     {"vision_stalled", hal::SimFaultKind::vision_stalled},
     {"image_lost", hal::SimFaultKind::image_lost},
     {"camera_silent", hal::SimFaultKind::camera_silent},
     {"camera_frozen", hal::SimFaultKind::camera_frozen},
     {"sensor_frozen", hal::SimFaultKind::sensor_frozen},
     {"vision_late", hal::SimFaultKind::vision_late},
     {"vision_silent", hal::SimFaultKind::vision_silent},
     {"vision_poor", hal::SimFaultKind::vision_poor},
     {"handle_breaks", hal::SimFaultKind::handle_breaks},
     {"obstacle", hal::SimFaultKind::obstacle},
     {"abort_ordered", hal::SimFaultKind::abort_ordered},
     {"estop_ordered", hal::SimFaultKind::estop_ordered},
     {"shut_down_ordered", hal::SimFaultKind::shut_down_ordered}}};

mission::Step step_of(const std::string& name) {
  for (std::size_t i = 0; i < mission::step_count; ++i) {
    if (name == mission::row(static_cast<mission::Step>(i)).name) return static_cast<mission::Step>(i);
  }
  return mission::Step::count;
}

std::uint8_t node_number(const std::string& name, const config::Drives& drives, const JointNames& joints) {
  if (const std::optional<std::size_t> joint = joints.find(name)) return static_cast<std::uint8_t>(config::drive_of(drives, *joint).node);
  return name == "io" ? static_cast<std::uint8_t>(drives.output_node) : name == "master" ? can_map::master_node : 0;
}

// A simulated motor is the one of the arm's description, and a drive that says its rating says that motor's. The boot refuses a drive that says another
// rating than the stated one.
void check_rating(const config::JointDriveChoice& choice, const config::DriveKind& kind, const std::string& joint,
                  const devices::DriveConfig& drive) {
  const double stated_nm = choice.rated_torque_nm, said_nm = drive.rated_torque_nm;
  if (stated_nm == 0 || kind.rating != "object" || std::abs(said_nm - stated_nm) <= rating_apart_share * stated_nm) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "'drives.%s.rated_torque_nm' is %.4g: the simulated drive says %.4g N m, the arm's description's, and would not be booted",
                joint.c_str(), stated_nm, said_nm);
  throw InputError(text);
}

// A simulated drive of the make that the machine's file names. `folder`: of that file.
void set_make(const config::Drives& drives, std::size_t joint, const std::filesystem::path& folder, const ArmJoint& arm_joint,
              devices::DriveConfig& drive) {
  const config::JointDriveChoice choice = config::drive_of(drives, joint);
  drive.node = static_cast<std::uint8_t>(choice.node);
  devices::set_motor(arm_joint, choice.counts_per_rev, drive);
  const config::DriveKind kind = config::find_drive_kind(choice.profile, folder);
  check_rating(choice, kind, arm_joint.name, drive);
  drive.vendor = kind.identity.vendor;
  drive.product = kind.identity.product;
  drive.rated_current_a = choice.rated_current_a;
  drive.reversed = choice.polarity == "reversed";
  if (const std::optional<DriveMake> make = find_make(choice.profile, folder)) {
    drive.habit = make->habit;
    if (drive.habit != nullptr)
      drive.dictionary = devices::read_dictionary(config::share_folder() / drive_objects_file, drive.habit->dictionary);
    return;
  }
  // A dictionary of which no profile is shipped can be named by nobody.
  std::string list;
  for (const std::string& shipped : config::shipped_drive_kinds()) {
    const bool simulated = shipped == "lanternfish" || shipped.starts_with("cia402") || devices::find_habit(shipped) != nullptr;
    if (simulated) list += (list.empty() ? "" : ", ") + shipped;
  }
  throw InputError("drives." + arm_joint.name + ": there is no simulated drive '" + choice.profile +
                   "': a profile of your own is simulated as the one that it is 'like', and that takes " + list);
}

devices::DevicesConfig device_config(const Scenario& scenario, const Sample& sample, const ArmDescription& arm) {
  devices::DevicesConfig config = devices::devices_config(arm, sample.joint_offset_rad, sample.devices_seed);
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    devices::DriveConfig& drive = config.drives[i];
    drive.torque_noise_ratio = scenario.physics.torque_noise_ratio;
    drive.water_celsius = scenario.physics.water_celsius;
    set_make(scenario.drives, i, std::filesystem::path(scenario.file).parent_path(), arm.joints[i], drive);
    drive.switches.ramps_from_demand = scenario.physics.stops_from_demand;
    drive.friction.coulomb_nm *= sample.coulomb[i];
    drive.friction.viscous_nm_s *= sample.viscous[i];
    drive.friction.efficiency = std::min(1.0, drive.friction.efficiency * sample.efficiency[i]);
    drive.friction.back_efficiency = std::min(1.0, drive.friction.back_efficiency * sample.back_efficiency[i]);
    drive.friction.breakaway = sample.breakaway[i];
    drive.friction.one_way = sample.one_way[i];
    if (drive.actuator.pivot_a_m > 0) drive.actuator.pivot_a_m += sample.pivot_m[i];
  }
  config.io.node = static_cast<std::uint8_t>(scenario.drives.output_node);
  return config;
}

// Where the panel may be docked, the objects on it are, too: at each corner of the docking's shifts and with none.
void add_clashes(const Scenario& scenario, std::vector<std::string>& problems) {
  if (!scenario.objects) return;
  const Docking& docking = scenario.docking;
  for (unsigned corner = 0; corner <= 8; ++corner) {
    Sample sample = draw(scenario, 1);
    const auto end = [&](const Spread& spread, unsigned bit) { return (corner & bit) != 0 ? spread.max : spread.min; };
    sample.docking_turn_rad = Vec3::Zero();
    sample.docking_shift_m = corner == 8 ? Vec3::Zero() : Vec3(end(docking.x_m, 1), end(docking.y_m, 2), end(docking.z_m, 4));
    try {
      (void)world::World(world_config(scenario, sample));
    } catch (const InputError& problem) {
      char text[160];
      const Vec3 mm = 1e3 * sample.docking_shift_m;
      std::snprintf(text, sizeof text, " (the panel docked %.0f, %.0f, %.0f mm off its place)", mm.x(), mm.y(), mm.z());
      std::istringstream lines(problem.what());
      for (std::string line; std::getline(lines, line);) problems.push_back(scenario.file + ": " + line + text);
      return;
    }
  }
}

}  // namespace

void check_runnable(const Scenario& scenario) {
  std::vector<std::string> problems;
  if (scenario.tasks.empty()) problems.push_back(scenario.file + ": 'tasks' is empty: there is nothing to do");
  add_job_problems(scenario, problems);
  if (!problems.empty()) throw InputError(config::joined(problems));
  add_clashes(scenario, problems);
  const ArmDescription arm = true_arm(scenario);
  for (std::size_t joint = 0; joint < arm.joints.size(); ++joint) {
    devices::DriveConfig drive;
    try {
      set_make(scenario.drives, joint, std::filesystem::path(scenario.file).parent_path(), arm.joints[joint], drive);
    } catch (const InputError& problem) {
      problems.push_back(scenario.file + ": " + problem.what());
    }
  }
  if (!problems.empty()) throw InputError(config::joined(problems));
}

void check_overheard(const config::Drives& drives, const JointNames& joints, std::size_t joint) {
  const config::JointDriveChoice drive = config::drive_of(drives, joint);
  const bool plain = drive.profile == "lanternfish" || drive.profile == "cia402";
  if (joint < can_map::drive_nodes.size() && drive.node == can_map::drive_nodes[joint] && plain && drive.polarity == "forward") return;
  throw InputError("drives." + joints[joint] +
                   ": a drive that is not served is overheard only at its node of the CAN map, in encoder counts and forward. One that "
                   "reports encoder counts is followed under that node with 'drives." +
                   joints[joint] + ".profile' cia402; of another, serve the node (`--nodes`) and leave the real drive off this bus");
}

hal::SimFault sim_fault(const Fault& fault, const config::Drives& drives, const JointNames& joints) {
  hal::SimFault out;
  out.at_s = fault.at_s;
  out.at_step = step_of(fault.at_step);
  out.after_s = fault.after_s;
  out.duration_s = fault.duration_s;
  for (const auto& [name, kind] : platform_kinds) {
    if (fault.kind != name) continue;
    out.kind = kind;
    return out;
  }
  out.device = device_fault(fault, drives, joints);
  return out;
}

devices::DeviceFault device_fault(const Fault& fault, const config::Drives& drives, const JointNames& joints) {
  if (!fault.node.empty() && node_number(fault.node, drives, joints) == 0) {
    const std::vector<std::string> nodes = config::fault_nodes(config::FaultPlace::node_or_master, joints);
    const std::string nearest = config::suggestion(fault.node, nodes);
    throw InputError("no node '" + fault.node + "'" + (nearest.empty() ? "; there are the joints, io and master" : nearest));
  }
  for (const auto& [name, kind] : device_kinds) {
    if (fault.kind == name)
      return {fault.at_s, kind, node_number(fault.node, drives, joints), fault.duration_s, static_cast<std::uint32_t>(fault.can_id)};
  }
  throw InputError("the devices have no fault '" + fault.kind + "'");
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
  for (const Fault& fault : scenario.faults) {
    if (fault.kind == limits_refused) continue;  // make_nominal's
    const hal::SimFault made = sim_fault(fault, scenario.drives, scenario.joints);
    const bool timed_by_devices = made.kind == hal::SimFaultKind::device && made.at_step == mission::Step::count;
    timed_by_devices ? sim.devices.faults.push_back(made.device) : sim.faults.push_back(made);
  }
  sim.vision.camera = nominal.controller.camera;
  sim.vision.markers = nominal.controller.markers;
  sim.vision.panel = scenario.panel;
  for (const mission::Task& task : nominal.controller.mission.tasks) {
    if (task.kind != mission::Task::Kind::turn_valve) continue;
    sim.valve_that_breaks = task.valve;
    break;
  }
  sim.image_latency = Duration::from_s(scenario.latency.image_ms * 1e-3);
  sim.exposure_delay = Duration::from_s(sample.exposure_delay_s);
  sim.stamp_offset = Duration::from_s(sample.stamp_s);
  sim.vision_latency = Duration::from_s(scenario.latency.panel_vision_ms * 1e-3);
  return sim;
}

}  // namespace lf::scenario
