#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/tool_place.hpp"
#include "hal/config/core_drives.hpp"
#include "hal/config/drive_kind.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/config/limits_check.hpp"
#include "hal/config/limits_file.hpp"
#include "hal/config/machine.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/park_pose.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/roll_check.hpp"
#include "hal/config/share.hpp"
#include "hal/config/sweep_check.hpp"
#include "hal/config/task_check.hpp"
#include "hal/config/task_reach.hpp"
#include "hal/config/view_check.hpp"
#include "hal/vision/calibration_file.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace {

// Runs the steps of a set-up; without a list the first problem ends it.
class Steps {
 public:
  explicit Steps(std::vector<std::string>* problems) : problems_(problems) {}
  template <class Step>
  bool take(Step step) const {
    try {
      step();
      return true;
    } catch (const InputError& problem) {
      if (problems_ == nullptr) throw;
      const bool told = std::find(problems_->begin(), problems_->end(), problem.what()) != problems_->end();
      if (!told) problems_->emplace_back(problem.what());
      return false;
    }
  }

 private:
  std::vector<std::string>* problems_;
};

// The profiles of the joints' drives by their names in the machine's file. What is wrong with one is told once, by the first key that names it.
std::map<std::string, DriveKind> read_profiles(const Machine& machine, const Steps& steps) {
  std::map<std::string, DriveKind> profiles;
  std::set<std::string> tried;
  for (std::size_t joint = 0; joint < machine.joints.size(); ++joint) {
    const std::string& name = drive_of(machine.drives, joint).profile;
    if (!tried.insert(name).second) continue;
    const bool of_all = machine.drives.joints[joint].profile.empty();
    const std::string key = "drives." + (of_all ? "" : machine.joints[joint] + ".") + "profile";
    steps.take([&] {
      try {
        profiles[name] = find_drive_kind(name, std::filesystem::path(machine.file).parent_path());
      } catch (const InputError& problem) {
        throw InputError(machine.told_in() + ": " + key + ": " + problem.what());
      }
    });
  }
  return profiles;
}

// Of the joints whose drives do not say their motors' rating, and nobody else does.
void note_assumed_ratings(const Machine& machine, const std::map<std::string, DriveKind>& profiles, const ArmDescription& description,
                          Core& core) {
  std::string assumed;
  for (std::size_t i = 0; i < description.joints.size(); ++i) {
    const JointDriveChoice choice = drive_of(machine.drives, i);
    const auto kind = profiles.find(choice.profile);
    if (kind == profiles.end() || kind->second.rating != "configured" || choice.rated_torque_nm > 0) continue;
    char text[64];
    std::snprintf(text, sizeof text, "%s%s %.3g N m", assumed.empty() ? "" : ", ", description.joints[i].name.c_str(),
                  motor_of(description.joints[i], choice.counts_per_rev).rated_torque_nm);
    assumed += text;
  }
  if (assumed.empty()) return;
  core.notes.push_back(machine.told_in() + ": the rated torque of these motors is assumed from the arm's description: " + assumed +
                       ". Their drives do not say it, and all torques are shares of it: state 'drives.<joint>.rated_torque_nm'");
}

CameraCalibration camera_calibration(const Camera& camera) {
  CameraCalibration calibration;
  calibration.intrinsics.fx = calibration.intrinsics.fy = camera.focal_px;
  std::copy(camera.distortion.begin(), camera.distortion.end(), calibration.intrinsics.distortion.begin());
  calibration.base_from_camera = base_from_camera(camera);
  calibration.exposure = Duration::from_us(camera.exposure_us);
  return calibration;
}

// A calibration of another image size is one of another camera.
void read_intrinsics(const std::string& path, CameraIntrinsics& intrinsics) {
  CameraIntrinsics read = vision::read_camera_calibration(path);
  if (read.width == 0) std::tie(read.width, read.height) = std::tie(intrinsics.width, intrinsics.height);
  if (read.width != intrinsics.width || read.height != intrinsics.height) {
    throw InputError(path + ": is of a " + std::to_string(read.width) + "x" + std::to_string(read.height) + " camera; the core takes " +
                     std::to_string(intrinsics.width) + "x" + std::to_string(intrinsics.height));
  }
  intrinsics = read;
}

LaserCalibration laser_calibration(const Laser& laser) {
  LaserCalibration calibration;
  calibration.tool_from_laser.translation() = Vec3(laser.position_m[0], laser.position_m[1], laser.position_m[2]);
  if (laser.turn_deg != 0)
    calibration.tool_from_laser.linear() = Eigen::AngleAxisd(rad_from_deg(laser.turn_deg), Vec3::UnitZ()).toRotationMatrix();
  calibration.fan_half_angle_rad = rad_from_deg(laser.fan_half_angle_deg);
  return calibration;
}

[[noreturn]] void refuse(const Machine& machine, const std::string& message) { throw InputError(machine.told_in() + ": " + message); }

arm::VehicleShape vehicle_shape(const Machine& machine) {
  arm::VehicleShape shape;
  const std::string most = std::to_string(arm::VehicleShape::capacity);
  for (const auto& [x, y, z, dx, dy, dz] : machine.vehicle.boxes_m) {
    if (!shape.boxes.push_back({Vec3(x, y, z), Vec3(dx, dy, dz)})) refuse(machine, "'vehicle.boxes_m' has more than " + most + " boxes");
  }
  for (const auto& [ax, ay, az, bx, by, bz, radius] : machine.vehicle.capsules_m) {
    if (!shape.rods.push_back({Vec3(ax, ay, az), Vec3(bx, by, bz), radius}))
      refuse(machine, "'vehicle.capsules_m' has more than " + most + " capsules");
  }
  if (machine.vehicle.lamps_m.size() > Vehicle::most_lamps)
    refuse(machine, "'vehicle.lamps_m' has more than " + std::to_string(Vehicle::most_lamps) + " lamps");
  return shape;
}

mission::MissionConfig mission_config(const Machine& machine) {
  mission::MissionConfig config = machine.mission;
  config.vehicle = vehicle_shape(machine);
  config.park_rad = park_pose(machine);
  config.layout = machine.panel;
  config.use_lamps = machine.lamps_lit;
  config.camera_always_on = machine.camera_always_on;
  if (!machine.tasks.empty()) config.tasks = core_tasks(machine.tasks, machine.survey.names, machine.file);
  return config;
}

bool check_reach_of_tasks(const Machine& machine, const Steps& steps) {
  if (!arm::can_work(machine.arm)) return false;
  bool all = true;
  for (const Place& place : places_of_tasks(machine)) {
    const arm::IkResult ik = pose_at(machine, place);
    const bool reached = steps.take([&] {
      if (!ik.ok())
        refuse(machine, place.what + " is out of the arm's reach at its nominal place: " + excess_text(ik) + place_text(machine.panel) +
                            "; see also " + place.key);
    });
    all = all && reached;
  }
  return all;
}

// The entry of a limits file that keeps the arm from its work, before anything moves.
bool check_limits(const Machine& machine, const std::string& file, const safety::Limits& limits, const ControllerConfig& controller,
                  const Steps& steps) {
  std::vector<std::string> problems = limits_problems(limits, controller, machine.joints);
  for (const Place& place : places_of_tasks(machine)) {
    const arm::IkResult ik = pose_at(machine, place);
    if (!ik.ok()) continue;
    for (const std::string& problem : pose_problems(controller.arm, machine.joints, limits, ik.q_rad, place.what))
      problems.push_back(problem);
  }
  for (const std::string& problem : problems) steps.take([&] { throw InputError(file + ": " + problem); });
  return problems.empty();
}

// What a sweep at 25 Hz gives, 232,000 points, fills the cloud to nine tenths. At more frames a second the points are taken of fewer columns. Backgrounds that
// are older leave more of the moving hand's outline.
void set_frame_rate(const mission::MissionConfig& mission, ScanConfig& scan) {
  constexpr std::uint32_t full_cloud_syncs = 9;
  constexpr double hand_m_s = 0.040, outline_m = 0.0036;
  scan.frames_per_background = mission.frames_per_background;
  scan.columns_apart = (full_cloud_syncs + mission.camera_syncs - 1) / mission.camera_syncs;
  const double oldest_background_s = (mission.frames_per_background - 1) * mission.camera_syncs * can_map::sync_period.s();
  scan.silhouette_margin_m = outline_m + hand_m_s * oldest_background_s;
}

// Laser and lamps switch with the frames, on SYNCs: they have to stay as they are over a whole exposure, by the output node's reports.
void check_exposure(const Machine& machine) {
  const double longest_us = 1e6 * (machine.mission.camera_syncs - 1) * can_map::sync_period.s();
  if (static_cast<double>(machine.camera.exposure_us) <= longest_us) return;
  refuse(machine, "'camera.exposure_us' is " + std::to_string(machine.camera.exposure_us) + ": with 'mission.camera_syncs' at " +
                      std::to_string(machine.mission.camera_syncs) + " an exposure lasts at most " +
                      std::to_string(static_cast<int>(longest_us)) + " us");
}

// The sweep of slew, shoulder, elbow and roll lifts a level line.
void check_laser(const Machine& machine) {
  if (machine.arm.is_planar() && machine.laser.turn_deg != 0)
    refuse(machine, "'laser.turn_deg' is not 0: on an arm of slew, shoulder, elbow and roll the plane's normal is the tool's x");
}

// The wrist's peak, or the couple of two pads that press on the bar's ends. 0 without a roll.
double hand_torque_nm(const ArmDescription& description, const ArmModel::Jaw& jaw) {
  if (!description.rolls) return 0;
  return std::min(arm::pad_force_n(jaw, description.jaw().effort_nm) * jaw.pad_width_m, description.last().effort_nm);
}

// Where the panel and what stands proud of it can be: the worst docking error moves a corner of the plate by 20 mm and, over half a metre, by
// 2 degrees about two axes.
void set_region(const PanelLayout& panel, scan::Triangulator::Config& triangulation) {
  constexpr double docking_m = 0.060;
  const Pose base_from_panel = panel.nominal_base_from_panel();
  double proud_m = 0;
  for (const PanelLayout::Valve& valve : panel.valves) proud_m = std::max(proud_m, valve.front_m());
  for (const PanelLayout::Button& button : panel.buttons) proud_m = std::max(proud_m, button.height_m);
  const Vec3 low = base_from_panel * Vec3(panel.plate_min_m.x(), panel.plate_min_m.y(), 0);
  const Vec3 high = base_from_panel * Vec3(panel.plate_max_m.x(), panel.plate_max_m.y(), proud_m);
  triangulation.region_min_m = low.cwiseMin(high).array() - docking_m;
  triangulation.region_max_m = low.cwiseMax(high).array() + docking_m;
}

// The narrowest bar is so many pixels wide as it is far off: farther than the default panel from the default camera it fills fewer columns.
void set_chain(const PanelLayout& panel, const CameraCalibration& camera, scan::ChainConfig& chain) {
  const auto distance_m = [](const PanelLayout& to, const Pose& base_from_camera) {
    return (to.nominal_base_from_panel().translation() - base_from_camera.translation()).norm();
  };
  const double usual_m = distance_m(PanelLayout(), base_from_camera(Camera()));
  chain.part_rad *= std::min(1.0, usual_m / distance_m(panel, camera.base_from_camera));
}

}  // namespace

Pose base_from_camera(const Camera& camera) {
  Mat3 forward;  // camera z along base x, camera x along base y, camera y along base z
  forward << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  Pose pose = Pose::Identity();
  pose.translation() = Vec3(camera.position_m[0], camera.position_m[1], camera.position_m[2]);
  pose.linear() = Eigen::AngleAxisd(rad_from_deg(camera.right_deg), Vec3::UnitZ()).toRotationMatrix() *
                  Eigen::AngleAxisd(-rad_from_deg(camera.down_deg), Vec3::UnitY()).toRotationMatrix() * forward;
  return pose;
}

mission::Tasks core_tasks(const std::vector<Task>& tasks, const PanelNames& names, const std::string& where) {
  std::vector<mission::Task> all;
  for (const Task& task : tasks) {
    if (task.kind == Task::Kind::turn_valve) {
      const std::optional<std::size_t> valve = find_valve(names, task.valve);
      if (!valve) throw InputError(where + ": the panel has no valve '" + task.valve + "'" + suggestion(task.valve, names.valves));
      all.push_back({mission::Task::Kind::turn_valve, rad_from_deg(task.to_deg), 0, static_cast<std::uint8_t>(*valve)});
      continue;
    }
    for (const std::string& name : task.order) {
      const std::optional<std::size_t> button = find_button(names, name);
      if (!button) throw InputError(where + ": the panel has no button '" + name + "'" + suggestion(name, names.buttons));
      all.push_back({mission::Task::Kind::press_button, 0, static_cast<std::uint8_t>(*button), 0});
    }
  }
  if (all.empty()) throw InputError(where + ": 'tasks' is empty: there is nothing to do");
  mission::Tasks core;
  for (const mission::Task& task : all) {
    if (core.push_back(task)) continue;
    throw InputError(where + ": 'tasks' has " + std::to_string(all.size()) + " turns and presses; the core holds " +
                     std::to_string(mission::Tasks::capacity()));
  }
  return core;
}

namespace {

// A joint without a line in the file, and every joint without a file, takes no power.
void set_zeros(const Machine& machine, const std::filesystem::path& folder, const ArmDescription& arm, Core& core) {
  ControllerConfig& controller = core.controller;
  const std::string& file = machine.homing_file;
  canopen::NetworkConfig& network = controller.network;
  for (canopen::DriveSetup& drive : network.drives) drive.zero_known = file.empty() && machine.zeros_by_construction;
  if (file.empty()) return;
  const std::string found = find_file(file, folder);
  HomingOffsets offsets = read_homing_file(found, machine.joints);
  const HomingOffsets in_file = offsets;
  PerJoint<Motor> motors;
  for (std::size_t i = 0; i < machine.joints.size(); ++i) motors[i] = motor_of(arm.joints[i], drive_of(machine.drives, i).counts_per_rev);
  for (const std::string& doubtful : leave_out_doubtful(offsets, motors))
    core.notes.push_back(found + ": " + doubtful + ". Until then this joint takes no power");
  for (std::size_t i = 0; i < network.drives.size(); ++i) {
    if (in_file.zero_doubtful[i] && !in_file.friction_doubtful[i])
      core.notes.push_back(found + ": the " + machine.joints[i] +
                           "'s zero is doubtful: a commissioning found it elsewhere, or did not come to its end. This joint takes no power "
                           "until it is commissioned again");
    if (in_file.friction_doubtful[i])
      core.notes.push_back(
          found + ": the " + machine.joints[i] +
          "'s friction was doubtful when it was last measured. This joint takes no power until a commissioning measures it again");
    network.drives[i].zero_known = offsets.known[i];
    network.drives[i].encoder_zero_counts = offsets.zero_counts[i];
    set_friction(offsets, i, controller.transmissions[i].friction);
  }
}

// A mission's own limits, none of them wider than the machine's.
void tighten(const Machine& machine, ControllerConfig& controller) {
  if (machine.mission_limits.empty()) return;
  const std::string found = named_file(machine.file, "safety.mission_limits", machine.mission_limits);
  const safety::Limits tighter = read_limits(found, machine.joints);
  if (!safety::is_tighter(tighter, controller.limits))
    throw InputError(found + ": 'safety.mission_limits' tightens limits, and one of these is wider than in 'safety.limits'");
  controller.mission_limits = tighter;
}

Core assemble(Machine machine, const Steps& steps) {
  const std::filesystem::path folder = std::filesystem::path(machine.file).parent_path();
  Core core;
  ControllerConfig& controller = core.controller;
  ArmDescription description;
  const bool arm = !machine.arm_told && steps.take([&] {
    const std::string urdf = named_file(machine.file, "arm.urdf", machine.arm_urdf);
    description = load_arm_urdf(urdf);
    machine.arm = arm_of(description, urdf);
    machine.joints = description.names();
  });
  controller.arm = core.scan.arm = machine.arm;
  // Of a machine's own arm that cannot be read nobody knows what its joints are called.
  const bool limits = (arm || (!machine.arm_told && machine.joints == JointNames())) && steps.take([&] {
    controller.limits = read_limits(named_file(machine.file, "safety.limits", machine.safety_limits), machine.joints);
  });
  controller.mission_limits = controller.limits;
  const bool tightened = limits && steps.take([&] { tighten(machine, controller); });
  bool drives_known = false;
  const std::map<std::string, DriveKind> profiles = read_profiles(machine, steps);
  if (arm && limits) {
    controller.network = network_config(machine.arm, controller.limits);
    controller.network.io.node = static_cast<std::uint8_t>(machine.drives.output_node);
    core.error_texts = ErrorTexts(machine.joints);
    bool drives = true;
    for (std::size_t i = 0; i < machine.joints.size(); ++i) {
      controller.transmissions[i] = transmission_of(description.joints[i], drive_of(machine.drives, i).counts_per_rev);
      controller.network.drives[i].max_torque_permille =
          torque_cap_permille(description.joints[i], controller.limits.joints[i], controller.transmissions[i]);
      const auto kind = profiles.find(drive_of(machine.drives, i).profile);
      const bool known = kind != profiles.end();
      drives =
          known && steps.take([&] { set_drive(machine, i, kind->second, description.joints[i], controller.network.drives[i]); }) && drives;
      if (known) core.error_texts.set(i, controller.network.drives[i].node, kind->second.errors);
    }
    drives_known = drives;
    note_assumed_ratings(machine, profiles, description, core);
  }
  if (arm) steps.take([&] { set_zeros(machine, folder, description, core); });
  if (drives_known) steps.take([&] { check_network(machine, controller.network); });
  controller.camera = camera_calibration(machine.camera);
  const bool camera = steps.take([&] {
    if (machine.camera_calibration.empty()) return;
    read_intrinsics(named_file(machine.file, "camera.calibration", machine.camera_calibration), controller.camera.intrinsics);
  });
  controller.laser = laser_calibration(machine.laser);
  for (const PanelLayout::Marker& marker : machine.panel.markers)
    (void)controller.markers.push_back({marker.id, marker.size_m, marker.panel_from_tag()});
  const bool mission = steps.take([&] { controller.mission = mission_config(machine); });
  core.scan.camera = controller.camera;
  core.scan.laser = controller.laser;
  set_region(machine.panel, core.scan.triangulation);
  set_chain(machine.panel, controller.camera, core.scan.chain);
  set_frame_rate(machine.mission, core.scan);
  steps.take([&] { check_exposure(machine); });
  steps.take([&] { check_laser(machine); });
  // What follows is about jobs at a panel. An arm of another form than the planar one that is given none need not be able to do any.
  const bool works = arm && arm::can_work(machine.arm) && (machine.arm.is_planar() || !machine.tasks.empty());
  if (arm && !arm::can_work(machine.arm) && !machine.tasks.empty()) steps.take([&] { refuse(machine, no_jobs); });
  if (arm && mission && !works) {
    steps.take([&] {
      if (const std::optional<std::string> problem = fold_problem(controller, machine.survey)) refuse(machine, *problem);
    });
  }
  const bool reach = check_reach_of_tasks(machine, steps);
  if (works && limits) {
    for (const std::string& problem : turn_speed_problems(machine, controller.mission_limits))
      steps.take([&] { refuse(machine, problem); });
  }
  if (arm) {
    core.hand_torque_nm = hand_torque_nm(description, controller.arm.jaw());
    for (const std::string& problem : torque_problems(machine, core.hand_torque_nm)) steps.take([&] { refuse(machine, problem); });
  }
  if (works && limits) {
    for (const std::string& problem : roll_problems(machine, controller.mission_limits)) steps.take([&] { refuse(machine, problem); });
  }
  bool workable = true;
  if (arm && limits && mission) {
    workable =
        check_limits(machine, named_file(machine.file, "safety.limits", machine.safety_limits), controller.limits, controller, steps);
    if (workable && tightened && !machine.mission_limits.empty())
      workable = check_limits(machine, named_file(machine.file, "safety.mission_limits", machine.mission_limits), controller.mission_limits,
                              controller, steps);
  }
  if (camera && works) {
    for (const std::string& problem : view_problems(machine, controller.camera)) steps.take([&] { refuse(machine, problem); });
  }
  if (limits && mission && reach && workable && works) {
    steps.take([&] {
      if (const std::optional<std::string> problem = sweep_problem(controller, machine.joints, machine.survey)) refuse(machine, *problem);
    });
  }
  return core;
}

}  // namespace

Core make_core(const Machine& machine) { return assemble(machine, Steps(nullptr)); }
Core make_core(const Machine& machine, std::vector<std::string>& problems) { return assemble(machine, Steps(&problems)); }

}  // namespace lf::config
