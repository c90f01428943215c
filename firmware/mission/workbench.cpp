#include "firmware/mission/workbench.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/arm/actuator.hpp"

namespace lf::mission {

namespace {

// A contact is told long before it is an overload: at 13 N m on the default's arm, 33 N at the tool. At 9, a sweep after a turn was taken for one (seed 52).
constexpr double contact_share = 0.5;
// Whatever it was before, as where something pushed already. The default's free motion takes a fifth of the limit (limits.yaml).
constexpr double load_share = 0.7;

// Behind its set-point a joint stands by 3 mrad at most where the tool goes at some centimetres a second: position loops have 20 / s. A joint on a fast way
// that is pushed from behind may be named for it: it is stopped in either case.
constexpr double slow_lag_rad = 0.006;

// Of the way back from a press: twice what the arm gives way by at 60 N. Behind it the button's spring pushes for the whole stroke.
constexpr double gives_way_m = 0.006;

// While the load of a press is let off its change is no contact. Nor is the load: a press may leave 28 N m in the shoulder's gear, which holds it by itself.
arm::GuardConfig unwinding_guard(const arm::Arm& arm) {
  arm::GuardConfig guard(arm);
  guard.contact_torque_nm.setConstant(HUGE_VAL);
  guard.overload_torque_nm.setConstant(HUGE_VAL);
  return guard;
}

// While the jaw holds something the arm hardly moves: it lags by 5 mrad at most. The roll turns, and has a rule of its own.
arm::GuardConfig gripping_guard(const arm::Arm& arm) {
  arm::GuardConfig guard = unwinding_guard(arm);
  guard.following_rad = arm::each_joint(arm.arm_joints(), 0.025, HUGE_VAL);
  guard.learning = 1;
  return guard;
}

double thickest_bar_m(const PanelLayout& layout) {
  double thickest_m = 0;
  for (const PanelLayout::Valve& valve : layout.valves) thickest_m = std::max(thickest_m, valve.handle_thickness_m);
  return thickest_m > 0 ? thickest_m : arm::GripperConfig{}.bar_m;
}

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

arm::GuardConfig free_motion_guard(const arm::Arm& arm, const safety::Limits& limits) {
  arm::GuardConfig guard(arm);
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    guard.contact_torque_nm[joint] = std::min(limits.max_contact_torque_nm, contact_share * limits.joints[i].max_torque_nm);
    guard.overload_torque_nm[joint] = load_share * limits.joints[i].max_torque_nm;
  }
  return guard;
}

arm::GuardConfig approach_guard(const arm::Arm& arm, const safety::Limits& limits) {
  constexpr double share = 8.0 / 13.0, roll_share = 12.0 / 13.0;  // 20 N at the default arm's tool
  arm::GuardConfig guard = free_motion_guard(arm, limits);
  guard.contact_torque_nm.head(static_cast<Eigen::Index>(arm.pointing_joints())) *= share;
  arm.set_roll(guard.contact_torque_nm, roll_share * arm.roll_rad(guard.contact_torque_nm));
  guard.overload_torque_nm.setConstant(HUGE_VAL);  // the watch's
  return guard;
}

arm::JointVector strengths(const arm::Arm& arm, const safety::Limits& limits) {
  constexpr double of_the_default_nm = 13;
  const auto pointing = static_cast<Eigen::Index>(arm.pointing_joints());
  arm::JointVector strengths = arm::JointVector::Ones();
  strengths.head(pointing) = free_motion_guard(arm, limits).contact_torque_nm.head(pointing) / of_the_default_nm;
  return strengths;
}

double strength(const arm::Arm& arm, const safety::Limits& limits) {
  return strengths(arm, limits).head(static_cast<Eigen::Index>(arm.pointing_joints())).minCoeff();
}

// In a press 2.5 N m were seen of the default arm, and 10 of a Predator, 3.8 times as strong, whose slew rings.
arm::JointVector bottom_torques_nm(const arm::Arm& arm, const safety::Limits& limits, double press_torque_nm) {
  constexpr double least_nm = 3;
  const arm::JointVector stronger = strengths(arm, limits);
  return (stronger.array() > 1).select(least_nm * stronger, 0).cwiseMax(press_torque_nm);
}

double press_push_n(double felt_n) { return std::clamp(most_press_n - felt_n, least_push_n, usual_push_n); }

arm::ComplianceConfig gripping_compliance(const arm::Arm& arm, const safety::Limits& limits) {
  arm::ComplianceConfig config(arm.arm_joints());
  const double stronger =
      std::max(1.0, strength(arm, limits));  // a weaker arm gives way no faster than the default: its loops are no faster
  config.give_rad_s_nm /= stronger;
  config.dead_nm *= strength(arm, limits);
  constexpr double at_the_tool_m = 0.02;  // as 0.05 rad of the default arm's elbow
  if (!arm.is_planar()) config.largest_rad = std::min(config.largest_rad, at_the_tool_m / arm.reach_m(0).maxCoeff());
  return config;
}

bool lags_without_load(const arm::Arm& arm, const arm::GuardedMotion& guard) {
  // Over free motion's estimated torque: 10 N at the tool. The friction's doubt is within.
  const arm::JointVector load_nm = arm::each_joint(arm.arm_joints(), 4, 2, arm.rolls());
  const auto joint = static_cast<Eigen::Index>(guard.joint());
  return guard.touched() && guard.cause() == arm::GuardCause::following_error && std::abs(guard.excess_torque_nm()[joint]) < load_nm[joint];
}

bool runs_off(const arm::GuardedMotion& guard) {
  const auto joint = static_cast<Eigen::Index>(guard.joint());
  const double error_rad = guard.error_rad()[joint];
  const bool away = error_rad * guard.excess_torque_nm()[joint] < 0;
  return guard.touched() && guard.cause() == arm::GuardCause::torque && away && std::abs(error_rad) > slow_lag_rad;
}

bool drives_itself_off(const arm::Arm& arm, const arm::GuardedMotion& guard) {
  constexpr double least_rad_s = 0.02;  // above the observer's noise of a joint that stands; a runaway passes it within two ticks
  constexpr double least_nm = 1;        // an overload that a new guard meets is its baseline: its excess has no direction
  constexpr double fastest_push_rad_s = 0.1, push_share = 0.56;  // of the joint's top speed: a screw does not give way to a push so fast
  if (!guard.touched()) return false;
  const double pushed_rad_s = std::min(fastest_push_rad_s, push_share * arm.joint(guard.joint()).velocity_rad_s);
  const auto joint = static_cast<Eigen::Index>(guard.joint());
  const double speed_rad_s = guard.velocity_rad_s()[joint], off_rad_s = speed_rad_s - guard.command_rad_s()[joint];
  const double excess_nm = guard.excess_torque_nm()[joint];
  const bool by_its_motor = off_rad_s * excess_nm > 0 && std::abs(off_rad_s) > least_rad_s && std::abs(excess_nm) > least_nm;
  const bool away = speed_rad_s * guard.error_rad()[joint] < 0 && std::abs(speed_rad_s) > pushed_rad_s;
  return by_its_motor || away;
}

bool has_seized(const arm::Arm& arm, const arm::GuardedMotion& guard) {
  // Gear and links of the stiffest joint give way by 2.4 mrad before they carry a contact's torque: the motor goes so far, seven counts of a screw. A
  // count is what an encoder that stands may waver by. The roll's is 3.1 mrad: what it meets hard, and what leans on an arm before it begins to move, look the
  // same as a seized motor. Both lose their power, which is the safer answer.
  constexpr double stands_counts = 1.5, wavers_counts = 1, gives_rad = 0.0024;
  if (!guard.touched()) return false;
  const auto joint = static_cast<Eigen::Index>(guard.joint());
  const double count_rad = arm::rad_per_count(arm.joint(guard.joint()), guard.position_rad()[joint]);
  const double travelled = guard.travelled_rad()[joint] / count_rad, to_travel = guard.to_travel_rad()[joint] / count_rad;
  // Where one count is more than gear and links give way by, a motor that pushes towards its target shows the count before anything can hold it.
  const double error_rad = guard.error_rad()[joint];
  const bool pushes_there = error_rad * guard.excess_torque_nm()[joint] > 0 && std::abs(error_rad) > 0.5 * count_rad;
  if (count_rad > gives_rad && pushes_there && travelled < 0.5) return true;
  return travelled < stands_counts && to_travel > 2 * travelled + wavers_counts;
}

bool does_not_follow(const arm::Arm& arm, const arm::GuardedMotion& guard) {
  return lags_without_load(arm, guard) || runs_off(guard) || drives_itself_off(arm, guard) || has_seized(arm, guard);
}

bool was_behind_before(const arm::Arm& arm, const arm::GuardedMotion& guard) {
  // A healthy drive holds its joint within two counts. A guard that begins under a load takes it for the usual one: what it reads above that has come later.
  constexpr double healthy_counts = 2.5, grown_share = 0.25;  // an overload that has grown by a quarter is one that the arm met
  const auto joint = static_cast<Eigen::Index>(guard.joint());
  const double count_rad = arm::rad_per_count(arm.joint(guard.joint()), guard.position_rad()[joint]);
  const double load_nm = guard.baseline_nm()[joint], error_rad = guard.error_rad()[joint];
  const bool grown = std::abs(guard.excess_torque_nm()[joint]) >= grown_share * std::abs(load_nm);
  return guard.state() == arm::GuardState::overload && !grown && error_rad * load_nm > 0 &&
         std::abs(error_rad) > healthy_counts * count_rad;
}

Workbench::Workbench(const ControllerConfig& told)
    : config(told),
      watch(config.arm, told.mission_limits, told.transmissions),
      camera(camera_config(told)),
      motion(config.arm, told.mission_limits, config.mission.layout, config.mission.vehicle, told.mission.park_rad),
      map(config.mission.layout, config.markers, config.camera, config.arm.pointing_joints()),
      job(told.mission.tasks, told.mission.tries),
      gripper(new_gripper()),
      compliance(gripping_compliance(config.arm, told.mission_limits)),
      grip_guard(gripping_guard(config.arm)),
      back_guard(free_motion_guard(config.arm, told.mission_limits)),
      power(config.arm) {}

arm::Gripper Workbench::new_gripper() const {
  arm::Gripper fresh(jaw(), arm::gripper_config(config.arm.joint(config.arm.jaw_joint())));
  expect_bar(fresh);
  return fresh;
}

// Fingers that hold a thick bar stand apart at an angle: the bar touches the pads' edge, and the gap at their middle is wider by the pads' slope.
void Workbench::expect_bar(arm::Gripper& of) const {
  const double slope_rad = std::max(0.0, arm::jaw_from_gap(jaw(), bar_m()));
  of.expect_bar(bar_m(), arm::GripperConfig{}.bar_tolerance_m + jaw().pad_depth_m * std::tan(slope_rad));
}

double Workbench::bar_m() const {
  const PanelLayout& layout = config.mission.layout;
  return job.turns() ? layout.valves[job.task().valve].handle_thickness_m : thickest_bar_m(layout);
}

bool Workbench::jaw_may_hold() const {
  return gripper.may_hold(jaw_rad()) || !arm::stands_empty(jaw(), jaw_rad(), thickest_bar_m(config.mission.layout));
}

void Workbench::take_up_task() {
  course = course == Course::retrying ? Course::working : course;
  expect_bar(gripper);
}

arm::JointVector Workbench::measured_rad() const {
  arm::JointVector q = arm::JointVector::Zero();
  for (std::size_t i = 0; i < config.arm.arm_joints(); ++i) q[static_cast<Eigen::Index>(i)] = watch.joints().position_rad[i];
  return q;
}

arm::JointVector Workbench::measured_rad_s() const {
  arm::JointVector rad_s = arm::JointVector::Zero();
  for (std::size_t i = 0; i < config.arm.arm_joints(); ++i) rad_s[static_cast<Eigen::Index>(i)] = watch.joints().velocity_rad_s[i];
  return rad_s;
}

arm::JointTorques Workbench::measured_nm() const {
  arm::JointTorques torques;
  for (std::size_t i = 0; i < config.arm.arm_joints(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    torques.nm[joint] = watch.joints().torque_nm[i];
    torques.low_nm[joint] = watch.joints().torque_low_nm[i];
    torques.high_nm[joint] = watch.joints().torque_high_nm[i];
  }
  return torques;
}

Room Workbench::room(double jaw_goal_rad, arm::PanelParts meant) const {
  Room room;
  room.base_from_panel = map.known() ? map.base_from_panel() : config.mission.layout.nominal_base_from_panel();
  room.doubt = map.known() ? map.doubt() : config.mission.docking;
  room.jaw = {std::min(jaw_rad(), jaw_goal_rad), std::max(jaw_rad(), jaw_goal_rad)};
  room.meant_for_fingers = meant;
  return room;
}

arm::PanelParts Workbench::meant_parts() const {
  if (job.results().empty()) return 0;
  if (job.task().kind == Task::Kind::turn_valve) return arm::bit(arm::PanelPart::valve(job.task().valve));
  return arm::bit(arm::PanelPart::button(job.task().button)) | arm::bit(arm::PanelPart::plate());
}

Room Workbench::room_on_the_way(double jaw_opening_m) {
  jaw_order_m_ = jaw_opening_m;
  return room(jaw_opening_m > 0 ? arm::jaw_from_gap(jaw(), jaw_opening_m) : jaw().lower_rad);
}

void Workbench::go_clear(const arm::JointVector& goal_rad, double jaw_opening_m) {
  // Whoever gives up may have touched what nobody knows of: it may stand in the way home, too. At 0.6 the arm pressed with 162 N until it stood, at 0.3 with 88.
  constexpr double calm = 0.3;
  const double usual = config.mission.move_speed_fraction;
  motion.go_clear(goal_rad, room_on_the_way(jaw_opening_m), jaw_rad(), course == Course::giving_up ? std::min(usual, calm) : usual);
}

void Workbench::go_to_sweep(scan::SweepRequest request) {
  request.camera_m = config.camera.base_from_camera.translation();
  motion.go_to_sweep(request, config.laser, room_on_the_way(0), jaw_rad(), config.mission.move_speed_fraction);
}

Progress Workbench::follow_way() {
  const Progress progress = follow_motion();
  if (progress.kind == Progress::Kind::failed || motion.planning() || !jaw_order_m_) return progress;
  *jaw_order_m_ > 0 ? gripper.open_to(*jaw_order_m_) : gripper.close();
  jaw_order_m_.reset();
  return progress;
}

void Workbench::go_straight(const Vec3& goal_m, double roll_rad, double speed_m_s, arm::PanelParts meant) {
  motion.line(goal_m, roll_rad, room(jaw_rad(), meant), jaw_rad(), speed_m_s);
}

void Workbench::press_straight(const Vec3& goal_m, double roll_rad, double speed_m_s, double felt_n, arm::PanelParts meant) {
  Room pressed = room(jaw_rad(), meant);
  if (map.known()) pressed.doubt = map.doubt_where_touched();
  motion.line(goal_m, roll_rad, pressed, jaw_rad(), speed_m_s, press_push_n(felt_n));
}

Progress Workbench::follow_motion() const {
  if (motion.failure() != StepFailure::none) return Progress::failed(motion.failure());
  return Progress::done_if(motion.done());
}

void Workbench::feel(arm::GuardedMotion& guard, Time t) const {
  guard.update(t, pushed_target(), measured_rad(), measured_rad_s(), measured_nm());
}

arm::JointVector Workbench::pushed_target() const {
  const arm::JointVector& target = motion.target();
  if (compliance.offset_rad().isZero()) return target;
  const arm::JointLimits limits = motion.limits(1);
  return (target + compliance.offset_rad()).cwiseMax(limits.lower_rad.cwiseMin(target)).cwiseMin(limits.upper_rad.cwiseMax(target));
}

void Workbench::stay_where_measured() {
  if (!watch.joints().valid) return motion.stop();
  motion.start_at(measured_rad());
  compliance.reset();
}

void Workbench::stay_where_pushed() {
  if (!compliance.offset_rad().isZero()) motion.start_at(pushed_target());
  compliance.reset();
}

void report_felt(std::optional<std::size_t> misled, std::size_t felt_by, safety::FaultArbiter& faults) {
  faults.report(misled ? safety::Fault::following_error : safety::Fault::unexpected_contact,
                static_cast<std::int32_t>(misled.value_or(felt_by)));
}

std::optional<std::size_t> Workbench::unseen_joint() const {
  for (std::size_t joint = 0; joint < config.arm.pointing_joints(); ++joint) {
    if (watch.shows_nothing(joint)) return joint;
  }
  return std::nullopt;
}

std::optional<std::size_t> Workbench::misled_joint(const arm::GuardedMotion& guard) const {
  if (!guard.touched()) return std::nullopt;
  if (const std::optional<std::size_t> unseen = unseen_joint()) return unseen;
  return does_not_follow(config.arm, guard) || watch.shows_nothing(guard.joint()) ? std::optional(guard.joint()) : std::nullopt;
}

void Workbench::report_touch(const arm::GuardedMotion& guard, safety::FaultArbiter& faults) const {
  if (!guard.touched()) return;
  report_felt(misled_joint(guard), guard.joint(), faults);
}

void Workbench::let_off_roll() {
  arm::JointVector rest_rad = motion.target();
  config.arm.set_roll(rest_rad, config.arm.roll_rad(measured_rad()));
  motion.start_at(rest_rad);
}

void Workbench::begin_back_off() {
  back_guard = arm::GuardedMotion(wound_up ? unwinding_guard(config.arm) : free_motion_guard(config.arm, config.mission_limits));
  back_from_m_ = config.arm.base_from_tool(motion.target()).translation();
  go_straight(standoff_m, config.arm.roll_rad(motion.target()), config.mission.approach_speed_m_s, meant_parts());
}

void Workbench::guard_back_off(Time now) {
  const double unwinding_m = gives_way_m + (wound_up ? config.mission.layout.buttons[job.task().button].stroke_m : 0);
  if (wound_up && (config.arm.base_from_tool(motion.target()).translation() - back_from_m_).norm() >= unwinding_m) {
    wound_up = false;
    back_guard = arm::GuardedMotion(free_motion_guard(config.arm, config.mission_limits));
  }
  if (!motion.planning() && watch.joints().valid) feel(back_guard, now);
}

std::optional<std::size_t> Workbench::misled_on_the_way_back() const {
  if (const std::optional<std::size_t> misled = misled_joint(back_guard)) return misled;
  if (gripper.state() != arm::GripperState::open) return std::nullopt;
  // The jaw is open and the roll was let off: what its motor still pushes with is no contact. Another joint that was overloaded and behind its target before the arm left has
  // seized or is pinned. It loses its power either way.
  const bool roll_pushes =
      config.arm.rolls() && back_guard.state() == arm::GuardState::overload && back_guard.joint() == config.arm.roll_joint();
  return roll_pushes || was_behind_before(config.arm, back_guard) ? std::optional(back_guard.joint()) : std::nullopt;
}

void Workbench::watch_back_off_on_hold(const StepTick& tick) {
  guard_back_off(tick.now);
  if (!back_guard.touched()) return;
  report_felt(misled_on_the_way_back(), back_guard.joint(), tick.faults);
}

Progress Workbench::follow_back_off(const StepTick& tick) {
  guard_back_off(tick.now);
  if (!back_guard.touched()) return follow_motion();
  if (const std::optional<std::size_t> misled = misled_on_the_way_back()) {
    tick.faults.report(safety::Fault::following_error, static_cast<std::int32_t>(*misled));
    return Progress::running();
  }
  stay_where_measured();
  return Progress::failed_by_touch(StepFailure::touched_on_the_way_back);
}

void StepTick::event(Event::Kind kind, double value, std::int32_t code) const {
  Event event;
  event.kind = kind;
  event.t = now;
  event.step = step;
  event.task = static_cast<std::uint8_t>(bench.job.index());
  event.value = value;
  event.code = code;
  (void)telemetry.events.push_back(event);  // a full record of one tick loses details, never the counts
}

void StepTick::send(const ScanCommand& command) const {
  if (!orders.push_back(command)) faults.report(safety::Fault::port_error, static_cast<std::int32_t>(Port::scan_ring));
}

}  // namespace lf::mission
