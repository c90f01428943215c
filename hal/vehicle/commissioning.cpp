#include "hal/vehicle/commissioning.hpp"

#include <algorithm>
#include <limits>

#include "firmware/arm/actuator.hpp"
#include "shared/arm/arm_geometry.hpp"

namespace lf::hal {

namespace {

// Half of the range of counts: the zero is what is not known yet.
constexpr std::int32_t any_count = std::numeric_limits<std::int32_t>::max() / 2;
// After the last order: quick stop, NMT stop.
constexpr Duration stop_time = Duration::from_ms(300);
// Off the stop, of the lead.
constexpr double back_off_leads = 2;

canopen::NetworkConfig gentle(const Commissioning::Config& config) {
  canopen::NetworkConfig network = config.network;
  for (canopen::DriveSetup& drive : network.drives) {
    drive.encoder_zero_counts = 0;
    drive.min_counts = -any_count;
    drive.max_counts = any_count;
    drive.max_torque_permille = std::min(drive.max_torque_permille, config.torque_permille);
    drive.homing_method = 0;
  }
  return network;
}

}  // namespace

Commissioning::Commissioning(const Config& config) : config_(config), network_(gentle(config)) {}

void Commissioning::go(State state, Time now) {
  state_ = state;
  since_ = now;
}

void Commissioning::fail(const std::string& why, Time now) {
  failure_ = why;
  network_.shut_down();
  go(State::stopping, now);
}

void Commissioning::tick(Time now, canopen::Outbox& outbox) {
  if (!booted_) {
    booted_ = true;
    network_.start_boot(now);
    since_ = now;
  }
  watch(now);
  step(now);
  network_.tick(now, outbox);
}

void Commissioning::watch(Time now) {
  if (state_ == State::stopping || ended()) return;
  if (cancelled_) return fail("cancelled", now);
  if (state_ == State::booting) return;
  if (!network_.operational()) return fail("a node was lost", now);
  if (!network_.io().estop_closed()) return fail("the emergency-stop chain is open", now);
  for (std::size_t i = 0; i < joint_count; ++i) {
    const canopen::Axis& one = network_.axis(static_cast<Joint>(i));
    if (one.fault() != canopen::AxisFault::none) return fail(std::string(joint_name(i)) + ": " + canopen::name(one.fault()), now);
  }
  if (now - joint_since_ > config_.longest) fail(std::string(joint_name(joint_)) + ": no stop was found in time", now);
}

void Commissioning::step(Time now) {
  switch (state_) {
    case State::booting:
      if (network_.boot().state == canopen::BootState::failed) {
        const canopen::NodeBoot* node = network_.boot().failed();
        return fail("boot failed" + (node != nullptr ? ", node " + std::to_string(node->node) + ": " + canopen::name(node->failure) : ""),
                    now);
      }
      if (network_.boot().state != canopen::BootState::done || !network_.operational()) return;
      if (config_.here) return take_here(now);
      joint_ = 0;
      return next_joint(now);
    case State::enabling:
      if (axis().requested() != canopen::AxisRequest::hold_enabled) axis().request(canopen::AxisRequest::hold_enabled);
      if (!axis().enabled()) return;
      target_ = last_counts_ = axis().actual_counts();
      moved_ = now;
      return go(State::seeking, now);
    case State::seeking: return seek(now);
    case State::backing_off: return back_off(now);
    case State::releasing:
      if (axis().state() != canopen::AxisState::disabled) return;
      ++joint_;
      return next_joint(now);
    case State::stopping:
      if (now - since_ >= stop_time) go(failure_.empty() ? State::done : State::failed, now);
      return;
    case State::done:
    case State::failed: return;
  }
}

void Commissioning::next_joint(Time now) {
  while (joint_ < joint_count && !config_.joints[joint_]) ++joint_;
  joint_since_ = now;
  if (joint_ < joint_count) return go(State::enabling, now);
  network_.shut_down();
  go(State::stopping, now);
}

void Commissioning::take_here(Time now) {
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!config_.joints[i]) continue;
    zero_counts_[i] = network_.axis(static_cast<Joint>(i)).actual_counts() - arm::counts_from_rad(static_cast<Joint>(i), 0);
    found_[i] = true;
  }
  joint_ = joint_count;
  next_joint(now);
}

// The target creeps down, a lead ahead of the joint at most: at the stop the lead is what presses.
void Commissioning::seek(Time now) {
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const double lead = drive.following_window_counts / 2.0;
  const std::int32_t actual = axis().actual_counts();
  if (actual != last_counts_) {
    last_counts_ = actual;
    moved_ = now;
  }
  target_ -= config_.speed_fraction * drive.max_speed_counts_s * network_.config().sync_period.s();
  target_ = std::max(target_, actual - lead);
  (void)axis().set_target_counts(static_cast<std::int32_t>(target_));
  const bool pressing = target_ <= actual - 0.9 * lead;
  if (!pressing || now - moved_ < config_.stall) return;
  stop_counts_ = actual;
  zero_counts_[joint_] = actual - arm::counts_from_rad(static_cast<Joint>(joint_), arm_geometry::joints[joint_].lower_rad);
  found_[joint_] = true;
  go(State::backing_off, now);
}

void Commissioning::back_off(Time now) {
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const double goal = stop_counts_ + back_off_leads * drive.following_window_counts / 2.0;
  target_ = std::min(goal, target_ + config_.speed_fraction * drive.max_speed_counts_s * network_.config().sync_period.s());
  (void)axis().set_target_counts(static_cast<std::int32_t>(target_));
  if (axis().actual_counts() < stop_counts_ + (goal - stop_counts_) / 2) return;
  axis().request(canopen::AxisRequest::disable);
  go(State::releasing, now);
}

}  // namespace lf::hal
