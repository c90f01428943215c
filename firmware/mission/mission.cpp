#include "firmware/mission/mission.hpp"

#include "firmware/arm/actuator.hpp"
#include "firmware/mission/axis_limits.hpp"

namespace lf::mission {

using safety::Fault;
using safety::Reaction;

Mission::Mission(const ControllerConfig& config) : bench_(config), sources_(config.arm, config.mission_limits) {}

void Mission::tick(Time now, canopen::Network& network, ScanOrders& orders, Telemetry& telemetry) {
  const StepTick tick{now, step_, network, orders, telemetry, bench_, arbiter_, clock_};
  arbiter_.clear();
  faults_recorded_ = 0;
  bench_.mailbox.drop_expired(now);
  take_reset(tick);  // before the joints are observed: the watch begins anew with it, and a joint that it has not observed counts as silent
  observe(tick);
  limit_axes(bench_.config.arm, network);
  take_shut_down(tick);
  sources_.collect(tick, vigilance(network));
  watch_grip(tick);
  if (on_hold()) {
    clock_.wait(now - last_tick_);
    bench_.gripper.wait(now - last_tick_);
  }
  last_tick_ = now;
  if (!settle_faults(tick)) {
    const Progress progress = work(tick);
    if (progress.kind == Progress::Kind::failed) report_failure(tick, progress);
    if (!settle_faults(tick) && !progress.is_running()) {
      const StepRow& now_at = row(step_);
      enter(tick, progress.kind == Progress::Kind::nothing_left ? now_at.on_end
                  : progress.kind == Progress::Kind::other_way  ? now_at.on_branch
                                                                : now_at.on_done);
    }
  }
  bench_.power.tick(joints(), now, network);
  if (bench_.mailbox.closed() && over() && !nodes_stopped_) {
    network.shut_down();
    nodes_stopped_ = true;
  }
  bench_.camera.tick(now, network.io(), orders);
  drive(tick);
  complete_outcome(tick);
  report(tick);
}

// Reads the joints, and passes them on to the vision thread while it may need them.
void Mission::observe(const StepTick& tick) {
  PerJoint<double> rad{};
  for (std::size_t i = 0; i < bench_.config.arm.joint_count(); ++i) {
    rad[i] = arm::rad_from_counts(bench_.config.arm.joint(i), tick.network.axis(i).actual_counts());
  }
  const Time before = joints().t;
  bench_.watch.observe(tick.network, rad, tick.now);
  if (!joints().valid || joints().t == before || row(step_).phase != safety::Phase::scan) return;
  ScanCommand sample;
  sample.kind = ScanCommand::Kind::joint_sample;
  sample.joints.t = joints().t;
  for (std::size_t i = 0; i < bench_.config.arm.arm_joints(); ++i) sample.joints.q_rad[i] = joints().position_rad[i];
  tick.send(sample);
}

// ---- faults ----

// After the end, too, as long as the nodes are there to be heard.
safety::Vigilance Mission::vigilance(const canopen::Network& network) const {
  const bool booted = network.boot().state == canopen::BootState::done && !nodes_stopped_;
  // Before a boot the nodes' old silences mean nothing: the boot starts them anew.
  if (!booted || step_ == Step::idle) return safety::Vigilance::bus;
  if (bench_.powered || ended()) return safety::Vigilance::joints;
  return bench_.power.off() ? safety::Vigilance::bus : safety::Vigilance::nodes;
}

bool Mission::settle_faults(const StepTick& tick) {
  safety::Circumstances circumstances;
  circumstances.phase = row(step_).phase;
  circumstances.may_retry = bench_.course != Course::giving_up && row(step_).on_retry != Step::count && bench_.job.may_try_again(step_);
  circumstances.powered = bench_.powered;
  circumstances.on_hold = on_hold();
  const safety::FaultArbiter::Verdict verdict = arbiter_.decide(circumstances);
  const safety::FaultReports& reports = arbiter_.reports();
  bool cause_told = false;
  for (; faults_recorded_ < reports.size(); ++faults_recorded_) {
    const safety::FaultReport& report = reports[faults_recorded_];
    const bool is_cause = !cause_told && report.fault == verdict.cause.fault && report.code == verdict.cause.code;
    record(tick, report, is_cause ? verdict.reaction : Reaction::count_only);
    cause_told = cause_told || is_cause;
  }
  if (verdict.reaction == Reaction::count_only) return false;
  if (verdict.reaction > Reaction::retry) give_up(verdict.cause);
  react(tick, verdict);
  return true;
}

void Mission::record(const StepTick& tick, const safety::FaultReport& report, Reaction reaction) {
  ++fault_counts_[static_cast<std::size_t>(report.fault)];
  if (ended()) ++faults_after_end_[static_cast<std::size_t>(report.fault)];
  // Before the start a failed call loses nothing: it is counted, but no event.
  if (step_ == Step::idle && report.fault == Fault::port_error) return;
  Event event;
  event.kind = Event::Kind::fault;
  event.t = tick.now;
  event.step = step_;
  event.fault = report.fault;
  event.reaction = reaction;
  event.task = static_cast<std::uint8_t>(bench_.job.index());
  event.code = report.code;
  event.emcy = report.emcy;
  (void)tick.telemetry.events.push_back(event);  // a full record of one tick loses details, never the counts
}

// Remembers the first fault that ended the mission. One may replace it: a joint that does not follow on the way back explains what the arm felt before. The task's
// result keeps what was felt.
void Mission::give_up(const safety::FaultReport& cause) {
  const bool leaves = step_ == Step::abandon || step_ == Step::abandon_back || step_ == Step::stow;
  const bool felt = outcome_.fault == Fault::step_failed && may_be_misled(static_cast<StepFailure>(outcome_.code));
  const bool explains =
      leaves && felt && cause.fault == Fault::following_error && cause.code < static_cast<std::int32_t>(bench_.config.arm.arm_joints());
  if (ended() || (bench_.course == Course::giving_up && !explains)) return;
  bench_.course = Course::giving_up;
  outcome_.stage = row(step_).stage;
  outcome_.step = step_;
  outcome_.fault = cause.fault;
  outcome_.code = cause.code;
  outcome_.emcy = cause.emcy;
}

// A drive's EMCY may come a cycle after its statusword.
void Mission::complete_outcome(const StepTick& tick) {
  if (outcome_.fault != Fault::drive_fault || outcome_.emcy != 0) return;
  outcome_.emcy = tick.network.fault(static_cast<std::size_t>(outcome_.code)).emcy_code;
}

void Mission::react(const StepTick& tick, const safety::FaultArbiter::Verdict& verdict) {
  switch (verdict.reaction) {
    case Reaction::count_only: return;
    case Reaction::retry:
      bench_.job.count_try(step_);
      bench_.course = Course::retrying;
      bench_.motion.stop();
      return enter(tick, row(step_).on_retry);
    case Reaction::retreat: return retreat(tick);
    case Reaction::hold:
      // A shut-down takes the power anyway: holding must not keep it from that.
      if (step_ == Step::shut_down) return;
      // What overloads a held arm is not held against: it is pinned, or somebody leans on it.
      if (step_ == Step::held) {
        bench_.power.stop(tick.now, tick.network);
        return end_without_power(tick, Step::stopped);
      }
      bench_.motion.stop();
      // What the jaw holds stays held, but it does not go on moving.
      if (const arm::GripperState jaw = bench_.gripper.state(); jaw == arm::GripperState::opening || jaw == arm::GripperState::closing) {
        bench_.gripper.stay();
      }
      return enter(tick, Step::held);
    case Reaction::quick_stop: bench_.power.stop(tick.now, tick.network); return end_without_power(tick, Step::stopped);
    case Reaction::power_off:
      // A stop that brakes is not cut short, unless somebody else keeps the drives from braking.
      if (bench_.power.state() != safety::Power::State::stopping || drives_are_told_otherwise(verdict.cause)) {
        bench_.power.remove(tick.now, tick.network);
      }
      return end_without_power(tick, Step::off);
  }
}

// An end stays the end that it was.
void Mission::end_without_power(const StepTick& tick, Step end) {
  bench_.motion.freeze();
  bench_.powered = false;
  if (!ended()) enter(tick, end);
}

void Mission::retreat(const StepTick& tick) {
  bench_.motion.stop();
  const safety::Phase phase = row(step_).phase;
  const bool touching = phase == safety::Phase::contact || phase == safety::Phase::gripping;
  // By hand nobody has looked yet what the jaw holds, and the way to the park would drag it along.
  if (step_ == Step::ready || step_ == Step::jog) return enter(tick, Step::check_jaw);
  if (!touching) return enter(tick, Step::stow);
  const bool at_button = step_ == Step::press || step_ == Step::button_back;
  enter(tick, at_button ? Step::abandon_back : Step::abandon);
}

void Mission::enter(const StepTick& tick, Step next) {
  step_ = next;
  stage_ = Stage::coming_to_rest;
  clock_.start(tick.now);
  hold_.reset();
  (void)bench_.mailbox.take(Command::jog);
  const CameraWork::Mode camera = is_end(next) ? CameraWork::Mode::off : CameraWork::Mode::idle;
  if (bench_.camera.mode() != camera) bench_.camera.set_mode(camera, tick.now);
  tick.event(Event::Kind::step);
  if (next == Step::done || next == Step::failed) {
    bench_.power.lower(tick.now, tick.network);  // parked: the gears lock themselves
    bench_.powered = false;
  }
  if (is_end(next)) {
    outcome_.ended = true;
    outcome_.success = next == Step::done && bench_.course != Course::giving_up;
  }
}

// ---- the step under way ----

Progress Mission::work(const StepTick& tick) {
  if (on_hold()) {
    watch_contact_on_hold(tick);
    return Progress::running();
  }
  if (stage_ == Stage::coming_to_rest) {
    if (bench_.powered && !bench_.motion.done()) return Progress::running();
    stage_ = Stage::under_way;
    motions_before_ = bench_.motion.begun();
    const bool takes_hold = step_ == Step::grip || step_ == Step::free_jaw;
    if (!yielding() || takes_hold) bench_.stay_where_pushed();
    bench_.grip_guard.reset();
    grip_lag_rad_.reset();
    if (step_ == Step::held) bench_.stay_where_measured();
    const Progress begun = begin(tick);
    if (!begun.is_running()) return begun;
  }
  const Progress progress = run(tick);
  expect_duration();
  return progress;
}

// The steps that go into a contact, and out of one, watch it with guards of their own. The arm still moves for half a second on hold.
void Mission::watch_contact_on_hold(const StepTick& tick) {
  if (stage_ != Stage::under_way || bench_.motion.planning() || !joints().valid) return;
  switch (step_) {
    case Step::advance: return turn_valve_.watch_on_hold(tick);
    case Step::press: return press_button_.watch_on_hold(tick);
    case Step::back_out:
    case Step::back_off:
    case Step::button_back:
    case Step::abandon_back: return bench_.watch_back_off_on_hold(tick);
    default: return;
  }
}

bool Mission::yielding() const {
  switch (step_) {
    case Step::free_jaw:
    case Step::grip:
    case Step::turn:
    case Step::let_go:
    case Step::abandon: return true;
    default: return false;
  }
}

void Mission::expect_duration() {
  if (bench_.motion.begun() != motions_before_) clock_.expect(Duration::from_s(bench_.motion.duration_s()));
}

Progress Mission::begin(const StepTick& tick) {
  switch (row(step_).activity) {
    case Activity::start_up: start_up_.begin(tick); break;
    case Activity::manual: manual_.begin(tick); break;
    case Activity::empty_jaw: return empty_jaw_.begin(tick);
    case Activity::look: look_.begin(tick); break;
    case Activity::turn_valve: return turn_valve_.begin(tick);
    case Activity::press_button: return press_button_.begin(tick);
    case Activity::way_home: way_home_.begin(tick); break;
    case Activity::choose_task:
    case Activity::none: break;
  }
  return Progress::running();
}

Progress Mission::run(const StepTick& tick) {
  switch (row(step_).activity) {
    case Activity::start_up: return start_up_.run(tick);
    case Activity::manual: return manual_.run(tick);
    case Activity::empty_jaw: return empty_jaw_.run(tick);
    case Activity::look: return look_.run(tick);
    case Activity::choose_task: bench_.take_up_task(); return bench_.job.choose_next();
    case Activity::turn_valve: return turn_valve_.run(tick);
    case Activity::press_button: return press_button_.run(tick);
    case Activity::way_home: return way_home_.run(tick);
    case Activity::none: break;
  }
  return Progress::running();
}

void Mission::report_failure(const StepTick& tick, const Progress& progress) {
  const bool by_vision = (step_ == Step::perceive || step_ == Step::verify) && !progress.out_of_tries;
  safety::FaultReport report;
  report.fault = by_vision ? Fault::vision_poor : step_ == Step::boot ? Fault::boot_failed : Fault::step_failed;
  report.code = static_cast<std::int32_t>(progress.failure);
  if (report.fault == Fault::boot_failed) report.code = tick.network.boot().first_failed();
  report.out_of_tries = progress.out_of_tries;
  report.touched = progress.touched;
  tick.faults.report(report);
}

// Targets to the drives: the arm follows the motion, the jaw its gripper. Without power the motion follows the joints instead.
void Mission::drive(const StepTick& tick) {
  if (!bench_.powered) return;
  bench_.motion.step(tick.network.config().sync_period.s());
  if (yielding() && joints().valid && !on_hold()) bench_.compliance.update(joints().t, bench_.measured_nm());
  const arm::JointVector target = bench_.pushed_target();
  for (std::size_t i = 0; i < bench_.config.arm.arm_joints(); ++i) {
    tick.network.axis(i).set_target_counts(arm::counts_from_rad(bench_.config.arm.joint(i), target[static_cast<Eigen::Index>(i)]));
  }
  if (!joints().valid || on_hold()) return;
  const std::size_t jaw = bench_.config.arm.jaw_joint();
  const double jaw_rad = bench_.gripper.update(joints().t, joints().position_rad[jaw],
                                               {joints().torque_nm[jaw], joints().torque_low_nm[jaw], joints().torque_high_nm[jaw]});
  tick.network.axis(jaw).set_target_counts(arm::counts_from_rad(bench_.config.arm.joint(jaw), jaw_rad));
}

// A slew that runs off squeezes the bar against the jaw. The friction of its gear hides that from its motor long before it is an overload, so the lag tells it.
// At the beginning of a step the arm may already lag behind its target, from the contact with which the last step ended. This lag is no sign of a drive that
// runs off, and is subtracted. While the arm comes to rest its lag still falls, so the watch begins afterwards.
void Mission::watch_grip(const StepTick& tick) {
  const bool stays = yielding() || step_ == Step::held;
  if (!stays || stage_ != Stage::under_way || !bench_.powered || !joints().valid) return;
  const arm::JointVector target_rad = bench_.pushed_target(), measured_rad = bench_.measured_rad();
  if (!grip_lag_rad_) grip_lag_rad_ = target_rad - measured_rad;
  bench_.grip_guard.update(joints().t, target_rad - *grip_lag_rad_, measured_rad, bench_.measured_rad_s(), bench_.measured_nm());
  if (bench_.grip_guard.touched()) tick.faults.report(Fault::following_error, static_cast<std::int32_t>(bench_.grip_guard.joint()));
}

void Mission::report(const StepTick& tick) {
  Telemetry& telemetry = tick.telemetry;
  telemetry.t = tick.now;
  telemetry.step = step_;
  telemetry.joints_valid = joints().valid;
  for (std::size_t i = 0; i < bench_.config.arm.joint_count(); ++i) {
    telemetry.actual_rad[i] = joints().position_rad[i];
    telemetry.torque_nm[i] = joints().torque_nm[i];
    telemetry.target_rad[i] = arm::rad_from_counts(bench_.config.arm.joint(i), tick.network.axis(i).target_counts());
  }
  telemetry.outputs = tick.network.io().wanted_outputs();
  telemetry.faults = fault_counts_;
  telemetry.sight = look_.sight();
}

}  // namespace lf::mission
