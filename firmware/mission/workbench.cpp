#include "firmware/mission/workbench.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {

namespace {

// A contact is told before it is an overload.
constexpr double contact_share = 0.9;

CameraWork::Config camera_config(const ControllerConfig& config) {
  CameraWork::Config camera;
  camera.exposure = config.camera.exposure;
  camera.camera_syncs = config.mission.camera_syncs;
  camera.frames_per_background = config.mission.frames_per_background;
  camera.use_lamps = config.mission.use_lamps;
  camera.always_on = config.mission.camera_always_on;
  camera.sync_period = config.network.sync_period;
  camera.stale_image = Duration::from_s(config.mission_limits.stale_image_s);
  return camera;
}

}  // namespace

arm::GuardConfig free_motion_guard(const safety::Limits& limits) {
  arm::GuardConfig guard;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    guard.contact_torque_nm[static_cast<Eigen::Index>(i)] =
        std::min(limits.max_contact_torque_nm, contact_share * limits.joints[i].max_torque_nm);
  }
  guard.overload_torque_nm.setConstant(HUGE_VAL);
  return guard;
}

Workbench::Workbench(const ControllerConfig& told)
    : config(told),
      watch(told.mission_limits, told.transmissions),
      camera(camera_config(told)),
      motion(told.mission_limits, told.mission.layout, told.mission.park_rad),
      gripper(new_gripper()),
      back_guard(free_motion_guard(told.mission_limits)),
      map(told.mission.layout, told.marker, told.camera),
      job(told.mission.tasks, told.mission.tries) {}

arm::Gripper Workbench::new_gripper() const {
  arm::GripperConfig gripper_config;
  gripper_config.bar_m = config.mission.layout.handle_thickness_m;
  // Fingers that hold a thick bar stand apart at an angle: the bar touches the pads' edge, and the gap at their middle is wider by the pads' slope.
  const double slope_rad = std::max(0.0, arm::jaw_from_gap(gripper_config.bar_m));
  gripper_config.bar_tolerance_m += arm_geometry::jaw.pad_depth_m * std::tan(slope_rad);
  return arm::Gripper(gripper_config);
}

arm::JointVector Workbench::measured_rad() const {
  arm::JointVector q;
  for (std::size_t i = 0; i < arm_joint_count; ++i) q[static_cast<Eigen::Index>(i)] = watch.joints().position_rad[i];
  return q;
}

arm::JointTorques Workbench::measured_nm() const {
  arm::JointTorques torques;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    torques.nm[joint] = watch.joints().torque_nm[i];
    torques.low_nm[joint] = watch.joints().torque_low_nm[i];
    torques.high_nm[joint] = watch.joints().torque_high_nm[i];
  }
  return torques;
}

Room Workbench::room() const {
  Room room;
  room.base_from_panel = map.known() ? map.base_from_panel() : config.mission.layout.nominal_base_from_panel();
  room.jaw_rad = watch.joints().position_rad[static_cast<std::size_t>(Joint::jaw)];
  return room;
}

Progress Workbench::follow_motion() const {
  if (motion.failure() != StepFailure::none) return Progress::failed(motion.failure());
  return Progress::done_if(motion.done());
}

arm::JointVector Workbench::pushed_target() const {
  const arm::JointVector& target = motion.target();
  if (compliance.offset_rad().isZero()) return target;
  const arm::JointLimits limits = motion.limits(1);
  return (target + compliance.offset_rad()).cwiseMax(limits.lower_rad.cwiseMin(target)).cwiseMin(limits.upper_rad.cwiseMax(target));
}

void Workbench::stay_where_pushed() {
  if (!compliance.offset_rad().isZero()) motion.start_at(pushed_target());
  compliance.reset();
}

void Workbench::let_off_roll() {
  arm::JointVector rest_rad = motion.target();
  rest_rad[3] = measured_rad()[3];
  motion.start_at(rest_rad);
}

void Workbench::begin_back_off() {
  back_guard.reset();
  motion.line(standoff_m, motion.target()[3], config.mission.approach_speed_m_s);
}

Progress Workbench::follow_back_off(Time now) {
  if (!motion.planning() && watch.joints().valid) back_guard.update(now, pushed_target(), measured_rad(), measured_nm());
  if (!back_guard.touched()) return follow_motion();
  motion.stop();
  return Progress::failed(StepFailure::touched_on_the_way_back);
}

void StepTick::event(Event::Kind kind, double value) const {
  Event event;
  event.kind = kind;
  event.t = now;
  event.step = step;
  event.task = static_cast<std::uint8_t>(bench.job.index());
  event.value = value;
  (void)telemetry.events.push_back(event);  // a full record of one tick loses details, never the counts
}

void StepTick::send(const ScanCommand& command) const {
  if (!orders.push_back(command)) faults.report(safety::Fault::port_error, static_cast<std::int32_t>(Port::scan_ring));
}

}  // namespace lf::mission
