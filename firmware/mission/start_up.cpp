#include "firmware/mission/start_up.hpp"

namespace lf::mission {

using safety::Fault;

void StartUp::begin(const StepTick& tick) {
  if (tick.step == Step::boot) begin_boot(tick);
}

Progress StartUp::run(const StepTick& tick) {
  switch (tick.step) {
    case Step::idle: return run_idle(tick);
    case Step::boot: return run_boot(tick);
    case Step::enable: return run_enable(tick);
    case Step::home: return run_home(tick);
    default: return Progress::running();
  }
}

// Ordered both, the mission homes and waits: that is the smaller step.
Progress StartUp::run_idle(const StepTick& tick) {
  if (!tick.bench.power.off()) return Progress::running();  // an order waits until the last mission's power is down
  const bool start = tick.bench.mailbox.take(Command::start).has_value();
  const bool home = tick.bench.mailbox.take(Command::home).has_value();
  aim_ = home ? Aim::wait : Aim::job;
  return Progress::done_if(start || home);
}

void StartUp::begin_boot(const StepTick& tick) {
  const MissionSetup& config = tick.bench.config;
  const safety::LimitsVerdict verdict = safety::check(config.limits);
  const bool tighter = safety::is_tighter(config.mission_limits, config.limits);
  // Of other joints than the arm's, or a bus of other drives.
  const std::size_t joints = config.arm.joint_count();
  const bool fits = config.limits.joints.size() == joints && tick.network.drive_count() == joints;
  if (verdict == safety::LimitsVerdict::good && tighter && fits) return tick.network.start_boot(tick.now);
  tick.faults.report(Fault::limits_refused, verdict != safety::LimitsVerdict::good ? static_cast<std::int32_t>(verdict) : 100);
}

Progress StartUp::run_boot(const StepTick& tick) {
  switch (tick.network.boot().state) {
    case canopen::BootState::done: return Progress::done();
    case canopen::BootState::failed: return Progress::failed(StepFailure::none);
    default: return Progress::running();
  }
}

Progress StartUp::run_enable(const StepTick& tick) {
  // No power before the emergency-stop chain was read.
  const canopen::IoModule& io = tick.network.io();
  if (!io.seen() || !io.fresh(tick.now) || !io.estop_closed()) return Progress::running();
  tick.bench.power.switch_on();
  // An axis without a homed zero is powered when it is homed.
  bool all = true;
  for (std::size_t i = 0; i < tick.network.drive_count(); ++i) {
    canopen::Axis& axis = tick.network.axis(i);
    // A fault from before is reset. One that comes once power was asked for is a fault of this mission.
    const bool asked = axis.requested() == canopen::AxisRequest::hold_enabled;
    // Power that was taken by hardware (safe torque off) does not come back without an order.
    const bool fails = axis.fault() == canopen::AxisFault::drive_fault || axis.fault() == canopen::AxisFault::dropped_out;
    if (asked && fails) {
      tick.faults.report(Fault::drive_fault, static_cast<std::int32_t>(i));
      return Progress::running();
    }
    if (axis.fault() != canopen::AxisFault::none || axis.state() == canopen::AxisState::fault) {
      axis.request(canopen::AxisRequest::reset_fault);
      all = false;
      continue;
    }
    if (!axis.homed()) continue;
    if (axis.requested() != canopen::AxisRequest::hold_enabled) axis.request(canopen::AxisRequest::hold_enabled);
    all = all && axis.enabled();
  }
  if (!all || !tick.bench.watch.joints().valid) return Progress::running();
  tick.bench.motion.start_at(tick.bench.measured_rad());
  return Progress::done();
}

Progress StartUp::run_home(const StepTick& tick) {
  Workbench& bench = tick.bench;
  bool all = true;
  for (std::size_t i = 0; i < tick.network.drive_count(); ++i) {
    canopen::Axis& axis = tick.network.axis(i);
    if (axis.enabled() && axis.homed()) continue;
    all = false;
    if (axis.setup().homing_method != 0) tick.clock.expect(axis.setup().homing_timeout);
    if (axis.fault() == canopen::AxisFault::drive_fault || axis.fault() == canopen::AxisFault::dropped_out) {
      tick.faults.report(Fault::drive_fault, static_cast<std::int32_t>(i));
      return Progress::running();
    }
    if (axis.fault() != canopen::AxisFault::none) return Progress::failed(StepFailure::not_homed);
    const canopen::AxisRequest wanted = axis.homed() ? canopen::AxisRequest::hold_enabled : canopen::AxisRequest::home;
    if (axis.requested() != wanted) axis.request(wanted);
  }
  if (!all || !bench.watch.joints().valid) return Progress::running();
  forget_complaints(tick);
  bench.motion.start_at(bench.measured_rad());  // homing has moved the joints, and their zeros
  bench.gripper.stay();
  bench.powered = true;
  if (aim_ == Aim::job) return Progress::done();
  tolerate_excursion(tick);
  return Progress::other_way();
}

// What a drive complained of before it was enabled is past; not every drive withdraws it.
void StartUp::forget_complaints(const StepTick& tick) {
  for (std::size_t node = 0; node < tick.network.node_count(); ++node) {
    if (!tick.network.fault(node).link()) tick.network.acknowledge(node);
  }
}

// An arm that is found outside its limits or its workspace waits to be jogged back; for a job it is a fault.
void StartUp::tolerate_excursion(const StepTick& tick) {
  safety::Watch& watch = tick.bench.watch;
  watch.tolerate_excursion(true);
  for (std::size_t i = 0; i < tick.network.drive_count(); ++i) {
    if (!watch.outside(i)) continue;
    safety::FaultReport report{Fault::joint_limit, static_cast<std::int32_t>(i)};
    report.only_counted = true;
    tick.faults.report(report);
  }
}

}  // namespace lf::mission
