#include "firmware/mission/mission.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/arm/actuator.hpp"

namespace lf::mission {

using safety::Fault;
using safety::Reaction;

namespace {

// One late tick is jitter; three are the time after which a position is stale.
constexpr std::uint32_t clock_lost_ticks = 3;

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

// What free motion takes of torque is learned on the way; how much more is a contact, the limits say, and for the wrist half of its own limit if that is
// less. The overload is the watch's.
arm::GuardConfig free_motion(const safety::Limits& limits) {
  arm::GuardConfig guard;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    guard.contact_torque_nm[static_cast<Eigen::Index>(i)] = std::min(limits.max_contact_torque_nm, 0.5 * limits.joints[i].max_torque_nm);
  }
  guard.overload_torque_nm.setConstant(HUGE_VAL);
  return guard;
}

}  // namespace

Mission::Mission(const ControllerConfig& config)
    : config_(config),
      watch_(config.mission_limits),
      camera_(camera_config(config)),
      motion_(config.mission_limits, config.mission.layout, config.mission.park_rad),
      free_guard_(free_motion(config.mission_limits)),
      map_(config.mission.layout, config.marker, config.camera) {
  list_tasks();
}

void Mission::on_panel(const PanelResult& result) {
  if (result.id != sweep_) return;  // an answer to an earlier question: came too late to matter
  panel_ = result;
  panel_arrived_ = true;
}

void Mission::tick(Time now, canopen::Network& network, ScanOrders& orders, Telemetry& telemetry) {
  const Tick tick{now, network, orders, telemetry};
  observe(tick);
  take_shut_down(tick);
  watch_faults(tick);
  if (on_hold_) wait_on_hold(now - last_tick_);
  last_tick_ = now;
  // After a fault the arm comes to rest first: a motion is planned from rest.
  if (!entered_ && !on_hold_ && (!powered_ || motion_.done())) begin(tick);
  const Status status = entered_ && !on_hold_ ? run(tick) : Status::running;
  if (status != Status::running) finish_step(tick, status);
  camera_.tick(now, network.io(), orders);
  drive(tick);
  report(tick);
}

// Reads the joints, and passes them on to the vision thread while it may need them.
void Mission::observe(const Tick& tick) {
  std::array<double, joint_count> rad{};
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto joint = static_cast<Joint>(i);
    rad[i] = arm::rad_from_counts(joint, tick.network.axis(joint).actual_counts());
  }
  const Time before = watch_.joints().t;
  watch_.observe(tick.network, rad, tick.now);
  const safety::JointStates& joints = watch_.joints();
  if (!joints.valid || joints.t == before || row(step_).phase != safety::Phase::scan) return;
  ScanCommand sample;
  sample.kind = ScanCommand::Kind::joint_sample;
  sample.joints.t = joints.t;
  for (std::size_t i = 0; i < arm_joint_count; ++i) sample.joints.q_rad[i] = joints.position_rad[i];
  if (!tick.orders.push_back(sample)) raise(tick, Fault::port_error, static_cast<std::int32_t>(Port::scan_ring));
}

// After the end, too: what comes up then changes nothing, but is counted as long as the nodes are there to be heard.
void Mission::watch_faults(const Tick& tick) {
  faults_now_.clear();
  const bool armed = over() ? !closing_ && tick.network.boot().state == canopen::BootState::done : powered_;
  watch_.check(tick.network, arm::base_from_tool(measured_rad()).translation(), armed, tick.now, faults_now_);

  for (const safety::FaultReport& report : faults_now_) raise(tick, report.fault, report.code);
  take_orders(tick);
  watch_ports(tick);
  watch_images(tick);
  watch_contact(tick);
  if (camera_.laser_inhibited()) raise(tick, Fault::interlock, 0);
  const StepRow& now = row(step_);
  if (now.timeout_s > 0 && tick.now - step_since_ > Duration::from_s(now.timeout_s)) raise(tick, Fault::step_timeout, 0);
}

void Mission::take_orders(const Tick& tick) {
  if (stop_ordered_) raise(tick, Fault::estop, 1);
  if (abort_ordered_ && !failing_) raise(tick, Fault::aborted, 0);
  stop_ordered_ = abort_ordered_ = false;
}

void Mission::watch_ports(const Tick& tick) {
  clockless_ticks_ = clock_failed_ ? clockless_ticks_ + 1 : 0;
  clock_failed_ = false;
  if (clockless_ticks_ == clock_lost_ticks) raise(tick, Fault::clock_lost, static_cast<std::int32_t>(clockless_ticks_));
  const std::int32_t failed = port_error_ - 1;
  port_error_ = 0;
  if (failed < 0) return;
  // Before the start nothing is lost by it.
  if (step_ == Step::idle) {
    ++fault_counts_[static_cast<std::size_t>(Fault::port_error)];
  } else {
    raise(tick, Fault::port_error, failed);
  }
}

// A sweep bears a lost frame, but not a camera that is silent.
void Mission::watch_images(const Tick& tick) {
  if (camera_.images_lost() != images_lost_)
    raise(tick, Fault::image_lost, static_cast<std::int32_t>(camera_.images_lost() - images_lost_));
  images_lost_ = camera_.images_lost();
  if (camera_.take_silence()) raise(tick, Fault::camera_lost, 0);
}

// Where nothing may be touched. Out of a contact or a grip the arm's load is another: what is free is learned anew.
void Mission::watch_contact(const Tick& tick) {
  const safety::Phase phase = row(step_).phase;
  const bool free = phase == safety::Phase::free || phase == safety::Phase::scan || step_ == Step::stow;
  if (!powered_ || !free) return free_guard_.reset();
  if (!watch_.joints().valid) return;
  free_guard_.update(watch_.joints().t, motion_.target(), measured_rad(), measured_nm());
  if (free_guard_.touched()) raise(tick, Fault::unexpected_contact, static_cast<std::int32_t>(free_guard_.joint()));
}

void Mission::on_port_error(std::int32_t port) {
  port_error_ = port + 1;
  clock_failed_ = clock_failed_ || port == static_cast<std::int32_t>(Port::clock);
}

void Mission::raise(const Tick& tick, Fault fault, std::int32_t code) {
  Reaction reaction = safety::reaction(fault, row(step_).phase);
  if (reaction == Reaction::retry && !may_retry()) reaction = Reaction::retreat;
  if (reaction == Reaction::retreat && !powered_) reaction = Reaction::power_off;  // there is no way back without power
  // An arm that the operator holds does not set out by itself.
  const bool sets_out = reaction == Reaction::retry || reaction == Reaction::retreat;
  if (on_hold_ && sets_out && fault != Fault::aborted) reaction = Reaction::hold;
  record_fault(tick, fault, code, reaction);
  if (reaction > Reaction::retry) give_up(fault, code);
  react(tick, reaction);
}

void Mission::record_fault(const Tick& tick, Fault fault, std::int32_t code, Reaction reaction) {
  ++fault_counts_[static_cast<std::size_t>(fault)];
  if (over()) ++faults_after_end_[static_cast<std::size_t>(fault)];
  Event fault_event;
  fault_event.kind = Event::Kind::fault;
  fault_event.t = tick.now;
  fault_event.step = step_;
  fault_event.fault = fault;
  fault_event.reaction = reaction;
  fault_event.task = static_cast<std::uint8_t>(task_index_);
  fault_event.code = code;
  (void)tick.telemetry.events.push_back(fault_event);  // a full record of one tick loses details, never the counts
}

bool Mission::may_retry() {
  if (failing_ || row(step_).on_retry == Step::count) return false;
  return tries_[static_cast<std::size_t>(step_)] + 1u < config_.mission.tries;
}

// Remembers the first fault that ended the mission.
void Mission::give_up(Fault fault, std::int32_t code) {
  if (failing_) return;
  failing_ = true;
  outcome_.stage = row(step_).stage;
  outcome_.step = step_;
  outcome_.fault = fault;
  outcome_.code = code;
}

void Mission::react(const Tick& tick, Reaction reaction) {
  switch (reaction) {
    case Reaction::count_only: return;
    case Reaction::retry:
      ++tries_[static_cast<std::size_t>(step_)];
      retrying_ = true;
      motion_.stop();
      enter(tick, row(step_).on_retry);
      return;
    case Reaction::retreat:
      retrying_ = false;
      motion_.stop();
      if (!in_contact_phase()) {
        enter(tick, Step::stow);
      } else {
        const bool at_button = step_ == Step::press || step_ == Step::button_back;
        enter(tick, at_button ? Step::abandon_back : Step::abandon);
      }
      return;
    case Reaction::hold:
      motion_.stop();
      enter(tick, Step::held);
      return;
    case Reaction::quick_stop:
      tick.network.quick_stop_all();
      motion_.freeze();
      powered_ = false;
      enter(tick, Step::stopped);
      return;
    case Reaction::power_off:
      tick.network.disable_all();
      motion_.freeze();
      powered_ = false;
      enter(tick, Step::off);
      return;
  }
}

void Mission::enter(const Tick& tick, Step next) {
  step_ = next;
  step_since_ = tick.now;
  entered_ = false;
  on_hold_ = jog_ordered_ = false;
  failure_ = StepFailure::none;
  const CameraWork::Mode camera = is_end(next) ? CameraWork::Mode::off : CameraWork::Mode::idle;
  if (camera_.mode() != camera) camera_.set_mode(camera, tick.now);
  event(tick, Event::Kind::step);
  settling_ = false;
  if (next == Step::done || next == Step::failed) {
    tick.network.disable_all();  // parked: the gears lock themselves
    powered_ = false;
  }
  if (is_end(next)) {
    outcome_.ended = true;
    outcome_.success = next == Step::done && !failing_;
  }
}

void Mission::event(const Tick& tick, Event::Kind kind, double value) {
  Event event;
  event.kind = kind;
  event.t = tick.now;
  event.step = step_;
  event.task = static_cast<std::uint8_t>(task_index_);
  event.value = value;
  (void)tick.telemetry.events.push_back(event);
}

Mission::Status Mission::fail(StepFailure failure) {
  failure_ = failure;
  return Status::failed;
}

void Mission::finish_step(const Tick& tick, Status status) {
  const StepRow& now = row(step_);
  if (status == Status::failed) {
    const bool by_vision = step_ == Step::perceive || step_ == Step::verify;
    raise(tick,
          by_vision             ? Fault::vision_poor
          : step_ == Step::boot ? Fault::boot_failed
                                : Fault::step_failed,
          static_cast<std::int32_t>(failure_));
    return;
  }
  enter(tick, status == Status::end ? now.on_end : status == Status::branch ? now.on_branch : now.on_done);
}

void Mission::begin(const Tick& tick) {
  entered_ = true;
  if (!yielding() || step_ == Step::grip) stay_where_pushed();
  switch (step_) {
    case Step::boot: begin_boot(tick); return;
    case Step::jog: begin_jog(); return;
    case Step::deploy: begin_deploy(); return;
    case Step::verify_reach: begin_verify_reach(); return;
    case Step::scan:
    case Step::verify_scan: begin_scan(tick); return;
    case Step::look:
    case Step::verify_look: camera_.set_mode(CameraWork::Mode::still, tick.now); return;
    case Step::perceive:
    case Step::verify:
      panel_arrived_ = false;
      order(tick, ScanCommand::Kind::analyse);
      return;
    case Step::reach_valve: begin_reach_valve(); return;
    case Step::advance: begin_advance(); return;
    case Step::grip: gripper_.close(); return;
    case Step::turn: begin_turn(); return;
    case Step::let_go: begin_let_go(); return;
    case Step::back_off: begin_back_off(); return;
    case Step::reach_button: begin_reach_button(); return;
    case Step::press: begin_press(); return;
    case Step::button_back: begin_button_back(); return;
    case Step::abandon: begin_abandon(); return;
    case Step::abandon_back: begin_back_off(); return;
    case Step::stow: begin_stow(); return;
    case Step::shut_down: begin_shut_down(tick); return;
    default: return;
  }
}

Mission::Status Mission::run(const Tick& tick) {
  switch (step_) {
    case Step::idle: return start_ordered_ || home_ordered_ ? Status::done : Status::running;
    case Step::boot: return run_boot(tick);
    case Step::enable: return run_enable(tick);
    case Step::home: return run_home(tick);
    case Step::ready: return run_ready();
    case Step::jog: return run_jog();
    case Step::deploy:
    case Step::verify_reach: return run_motion();
    case Step::scan:
    case Step::verify_scan: return run_scan(tick);
    case Step::look:
    case Step::verify_look: return run_look();
    case Step::perceive: return run_perceive(tick);
    case Step::next_task: return run_next_task(tick);
    case Step::reach_valve: return run_reach_valve();
    case Step::advance: return run_advance(tick);
    case Step::grip: return run_grip();
    case Step::turn: return run_turn(tick);
    case Step::let_go: return run_let_go();
    case Step::back_off: return run_motion();
    case Step::verify: return run_verify(tick);
    case Step::reach_button: return run_reach_button();
    case Step::press: return run_press(tick);
    case Step::button_back: return run_button_back(tick);
    case Step::abandon: return run_abandon();
    case Step::abandon_back: return run_motion() == Status::running ? Status::running : (retrying_ ? Status::branch : Status::done);
    case Step::stow: return run_stow();
    case Step::shut_down: return run_shut_down(tick);
    default: return Status::running;
  }
}

arm::JointVector Mission::measured_rad() const {
  arm::JointVector q;
  for (std::size_t i = 0; i < arm_joint_count; ++i) q[static_cast<Eigen::Index>(i)] = watch_.joints().position_rad[i];
  return q;
}

arm::JointVector Mission::measured_nm() const {
  arm::JointVector torque;
  for (std::size_t i = 0; i < arm_joint_count; ++i) torque[static_cast<Eigen::Index>(i)] = watch_.joints().torque_nm[i];
  return torque;
}

bool Mission::settled(bool condition, Duration for_how_long, Time now) {
  if (!condition) {
    settling_ = false;
  } else if (!settling_) {
    settling_ = true;
    settled_since_ = now;
  }
  return settling_ && now - settled_since_ >= for_how_long;
}

Mission::Status Mission::run_motion() {
  if (failure_ != StepFailure::none) return Status::failed;
  if (motion_.failure() != StepFailure::none) return fail(motion_.failure());
  return motion_.done() ? Status::done : Status::running;
}

// Giving way ends at the joints' limits.
arm::JointVector Mission::pushed_target() const {
  const arm::JointVector& target = motion_.target();
  if (compliance_.offset_rad().isZero()) return target;
  const arm::JointLimits limits = motion_.limits(1);
  return (target + compliance_.offset_rad()).cwiseMax(limits.lower_rad.cwiseMin(target)).cwiseMin(limits.upper_rad.cwiseMax(target));
}

// What the arm has given way by is from now on where it stands.
void Mission::stay_where_pushed() {
  if (!compliance_.offset_rad().isZero()) motion_.start_at(pushed_target());
  compliance_.reset();
}

// Targets to the drives: the arm follows the motion, the jaw its gripper. Without power the motion follows the joints instead.
void Mission::drive(const Tick& tick) {
  const safety::JointStates& joints = watch_.joints();
  if (!powered_) return;
  motion_.step(tick.network.config().sync_period.s());
  if (yielding() && joints.valid && !on_hold_) compliance_.update(joints.t, measured_nm());
  const arm::JointVector target = pushed_target();
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto joint = static_cast<Joint>(i);
    tick.network.axis(joint).set_target_counts(arm::counts_from_rad(joint, target[static_cast<Eigen::Index>(i)]));
  }
  if (!joints.valid || on_hold_) return;
  const auto jaw = static_cast<std::size_t>(Joint::jaw);
  const double jaw_rad = gripper_.update(joints.t, joints.position_rad[jaw], joints.torque_nm[jaw]);
  tick.network.axis(Joint::jaw).set_target_counts(arm::counts_from_rad(Joint::jaw, jaw_rad));
}

void Mission::report(const Tick& tick) {
  Telemetry& telemetry = tick.telemetry;
  telemetry.t = tick.now;
  telemetry.step = step_;
  const safety::JointStates& joints = watch_.joints();
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto joint = static_cast<Joint>(i);
    telemetry.actual_rad[i] = joints.position_rad[i];
    telemetry.torque_nm[i] = joints.torque_nm[i];
    telemetry.target_rad[i] = arm::rad_from_counts(joint, tick.network.axis(joint).target_counts());
  }
  telemetry.outputs = tick.network.io().wanted_outputs();
  telemetry.faults = fault_counts_;
}

}  // namespace lf::mission
