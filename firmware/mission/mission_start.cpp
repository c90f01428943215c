#include "firmware/mission/mission.hpp"

namespace lf::mission {

void Mission::begin_boot(const Tick& tick) {
  const safety::LimitsVerdict verdict = safety::check(config_.limits);
  const bool tighter = safety::is_tighter(config_.mission_limits, config_.limits);
  if (verdict == safety::LimitsVerdict::good && tighter) return tick.network.start_boot(tick.now);
  raise(tick, safety::Fault::limits_refused, verdict != safety::LimitsVerdict::good ? static_cast<std::int32_t>(verdict) : 100);
}

Mission::Status Mission::run_boot(const Tick& tick) {
  switch (tick.network.boot().state) {
    case canopen::BootState::done: return Status::done;
    case canopen::BootState::failed: return Status::failed;
    default: return Status::running;
  }
}

Mission::Status Mission::run_enable(const Tick& tick) {
  // An axis without a homed zero is powered when it is homed.
  bool all = true;
  for (std::size_t i = 0; i < joint_count; ++i) {
    canopen::Axis& axis = tick.network.axis(static_cast<Joint>(i));
    if (axis.fault() != canopen::AxisFault::none || axis.state() == canopen::AxisState::fault) {
      axis.request(canopen::AxisRequest::reset_fault);
      all = false;
      continue;
    }
    if (!axis.homed()) continue;
    if (axis.requested() != canopen::AxisRequest::hold_enabled) axis.request(canopen::AxisRequest::hold_enabled);
    all = all && axis.enabled();
  }
  if (!all || !watch_.joints().valid) return Status::running;
  motion_.start_at(measured_rad());
  return Status::done;
}

Mission::Status Mission::run_home(const Tick& tick) {
  bool all = true;
  for (std::size_t i = 0; i < joint_count; ++i) {
    canopen::Axis& axis = tick.network.axis(static_cast<Joint>(i));
    if (axis.enabled() && axis.homed()) continue;
    all = false;
    if (axis.fault() != canopen::AxisFault::none) return fail(StepFailure::not_homed);
    const canopen::AxisRequest wanted = axis.homed() ? canopen::AxisRequest::hold_enabled : canopen::AxisRequest::home;
    if (axis.requested() != wanted) axis.request(wanted);
  }
  if (!all || !watch_.joints().valid) return Status::running;
  gripper_.stay();
  powered_ = true;
  const bool only_home = home_ordered_;
  start_ordered_ = home_ordered_ = false;
  if (only_home) bear_outside(tick);
  return only_home ? Status::branch : Status::done;
}

// An arm that is found outside its limits waits to be jogged back; for a job it is a fault.
void Mission::bear_outside(const Tick& tick) {
  watch_.bear_outside(true);
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (watch_.outside(i)) record_fault(tick, safety::Fault::joint_limit, static_cast<std::int32_t>(i), safety::Reaction::count_only);
  }
}

void Mission::begin_stow() {
  gripper_.close();
  go_clear(config_.mission.park_rad);
}

Mission::Status Mission::run_stow() {
  const Status status = run_motion();
  if (status != Status::done) return status;
  return failing_ ? Status::branch : Status::done;
}

// Out of a contact: open the jaw, whatever it holds, before going back.
void Mission::begin_abandon() {
  let_off_roll();
  gripper_.open_to(config_.mission.jaw_open_m);
}

Mission::Status Mission::run_abandon() {
  const bool open = gripper_.state() == arm::GripperState::open || gripper_.state() == arm::GripperState::jammed;
  return open && motion_.done() ? Status::done : Status::running;
}

}  // namespace lf::mission
