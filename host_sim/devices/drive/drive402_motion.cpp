// What moves: the demand of each mode, the position loop, and what the drive tells about it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/devices/drive/drive402.hpp"

namespace lf::devices {
namespace {

constexpr double step_s = 1e-3;
constexpr double hot_celsius = 95;
constexpr std::uint16_t bit_halt = 0x100, bit_4 = 0x10;

}  // namespace

// Each SYNC's target is reached one interpolation period later.
void Drive402::synced(Time now) {
  last_sync_ = now;
  if (state_ != DriveState::operation_enabled || mode_ != mode_cyclic_position) return;
  const double period_s =
      static_cast<double>(o_.interpolation_time.value) * std::pow(10.0, static_cast<double>(o_.interpolation_exponent.value));
  cyclic_.target(cyclic_.position(now), clamp_to_limits(static_cast<double>(o_.target_position.value)), now, Duration::from_s(period_s));
}

double Drive402::clamp_to_limits(double target) {
  const auto low = static_cast<double>(o_.limit_low.value), high = static_cast<double>(o_.limit_high.value);
  limited_ = low < high && (target < low || target > high);
  return limited_ ? std::clamp(target, low, high) : target;
}

void Drive402::change_mode() {
  if (mode_ == o_.mode.value) return;
  mode_ = o_.mode.value;
  homing_.abandon();
  cyclic_.hold(profile_.position());
  set_point_ = std::llround(profile_.position());
  set_point_taken_ = limited_ = false;
}

void Drive402::generate(Time now) {
  // Behind a closed brake nothing moves, and no target is taken.
  brake_closed_ = brake_closed(now);
  if (brake_closed_) {
    cyclic_.hold(static_cast<double>(o_.position_actual.value));
    return profile_.hold(static_cast<double>(o_.position_actual.value));
  }
  const auto deceleration = static_cast<double>(o_.profile_deceleration.value);
  const auto quick = static_cast<double>(o_.quick_stop_deceleration.value);
  if (state_ == DriveState::quick_stop_active) return profile_.stop(o_.quick_stop_option.value % 4 == 2 ? quick : deceleration, step_s);
  if (state_ == DriveState::fault_reaction_active) return profile_.stop(reaction_option_ == quick_stop_ramp ? quick : deceleration, step_s);
  if (ramping_) return profile_.stop(deceleration, step_s);
  if (state_ != DriveState::operation_enabled) return profile_.hold(static_cast<double>(o_.position_actual.value));
  if (mode_ == mode_cyclic_position) return profile_.move(cyclic_.position(now), cyclic_.velocity(now));
  const bool halt = (o_.controlword.value & bit_halt) != 0;
  if (halt || mode_ == 0) {
    homing_.abandon();
    return profile_.stop(o_.halt_option.value == 2 ? quick : deceleration, step_s);
  }
  if (mode_ == mode_profile_position) return profile_position();
  if (mode_ == mode_homing) return run_homing();
  const double speed = std::clamp(static_cast<double>(o_.target_velocity.value), -top_speed(), top_speed());
  profile_.run_at(speed, static_cast<double>(o_.profile_acceleration.value), step_s);
}

void Drive402::profile_position() {
  if (set_point_taken_ && (o_.controlword.value & bit_4) == 0) set_point_taken_ = false;
  profile_.go_to(clamp_to_limits(static_cast<double>(set_point_)), std::min(top_speed(), static_cast<double>(o_.profile_velocity.value)),
                 static_cast<double>(o_.profile_acceleration.value), static_cast<double>(o_.profile_deceleration.value), step_s);
}

// While a homing run presses on the stop the demand stays close: the loop pushes with its speed, not with a growing error.
void Drive402::run_homing() {
  const auto actual = static_cast<double>(o_.position_actual.value);
  if (homing_.state() != Homing::State::running && homing_.state() != Homing::State::attained) {
    return profile_.stop(static_cast<double>(o_.profile_deceleration.value), step_s);
  }
  if (homing_.state() == Homing::State::running) {
    homing_.step(actual, torque_ratio_, 1e-3 * static_cast<double>(o_.homing_threshold.value), step_s);
    if (homing_.state() == Homing::State::running) return profile_.move(actual, homing_.velocity_counts_s());
  }
  if (homed_) return;
  homed_ = true;
  zero_ = o_.home_offset.value - encoder_;
  o_.position_actual.value = encoder_ + zero_;
  last_counts_ = static_cast<double>(o_.position_actual.value);
  profile_.hold(last_counts_);
  loop_.reset();
}

void Drive402::finish_ramp() {
  if (!profile_.standing()) return;
  ramping_ = false;
  if (state_ == DriveState::quick_stop_active && !stays_after_quick_stop(o_.quick_stop_option.value)) enter(DriveState::switch_on_disabled);
  if (state_ == DriveState::fault_reaction_active) enter(DriveState::fault);
}

JointDrive Drive402::actuate() {
  JointDrive drive;
  const double motor_nm = torque_limit_nm();
  drive.torque_limit_nm = gear_.push_nm(motor_nm, velocity_counts_s_ / config_.counts_per_rev * 2 * std::numbers::pi, ratio());
  drive.holding_limit_nm = gear_.hold_nm(motor_nm, ratio());
  if (!powered()) {
    drive.released = !brake_;
    output_rad_s_ = 0;
    return drive;
  }
  const bool own_ramp = state_ != DriveState::operation_enabled;
  const double wanted_rad_s =
      loop_.step(profile_.position(), profile_.velocity(), static_cast<double>(o_.position_actual.value), rad_per_count_, step_s, own_ramp);
  const bool turns = wanted_rad_s * output_rad_s_ > 0 || gear_.breaks_away(wanted_rad_s * rad_per_count_ < 0 ? -1 : 1, motor_nm);
  if (!turns) loop_.stand();
  output_rad_s_ = turns ? wanted_rad_s : 0;
  const double top_rad_s = top_speed() * std::abs(rad_per_count_);
  drive.velocity_rad_s = faults_.jammed ? 0 : std::clamp(output_rad_s_, -top_rad_s, top_rad_s);
  return drive;
}

std::int64_t Drive402::mode_bits() const {
  constexpr std::int64_t bit_10 = 0x400, bit_12 = 0x1000, bit_13 = 0x2000;
  if (state_ != DriveState::operation_enabled) return state_ == DriveState::quick_stop_active && profile_.standing() ? bit_10 : 0;
  std::int64_t bits = 0;
  if (mode_ == mode_homing) {
    if (homing_.state() != Homing::State::running) bits |= bit_10;
    if (homing_.state() == Homing::State::attained && homed_) bits |= bit_12;
    if (homing_.state() == Homing::State::failed) bits |= bit_13;
    return bits;
  }
  if (on_target_ms_ >= o_.position_time_ms.value) bits |= bit_10;
  if (mode_ == mode_profile_position && set_point_taken_) bits |= bit_12;
  if (mode_ == mode_cyclic_position && !brake_closed_) bits |= bit_12;
  if (mode_ == mode_profile_velocity && profile_.standing()) bits |= bit_12;
  if (following_ms_ > 0 && mode_ != mode_profile_velocity) bits |= bit_13;
  return bits;
}

void Drive402::publish() {
  const auto actual = static_cast<double>(o_.position_actual.value);
  double target = profile_.position();
  if (mode_ == mode_cyclic_position) target = static_cast<double>(o_.target_position.value);
  if (mode_ == mode_profile_position) target = static_cast<double>(set_point_);
  bool reached = std::abs(target - actual) <= static_cast<double>(o_.position_window.value);
  if (mode_ == mode_profile_velocity) reached = profile_.velocity() == static_cast<double>(o_.target_velocity.value);
  on_target_ms_ = state_ == DriveState::operation_enabled && reached ? std::min(on_target_ms_ + 1, 0xFFFF) : 0;

  constexpr std::int64_t voltage = 0x10, warning = 0x80, remote = 0x200, internal_limit = 0x800;
  std::int64_t status = status_bits(state_) | voltage | remote | mode_bits();
  if (winding_.excess_ratio() > 0.5) status |= warning;
  if (powered() && (limited_ || loop_.saturated())) status |= internal_limit;
  o_.statusword.value = status;
  o_.mode_display.value = mode_;
  o_.position_demand.value = std::llround(profile_.position());
  o_.following_error.value = std::llround(profile_.position() - actual);
  o_.velocity_actual.value = std::llround(velocity_counts_s_);
  o_.velocity_demand.value = std::llround(output_rad_s_ / rad_per_count_);
  const auto torque = static_cast<std::int64_t>(std::clamp(1000 * torque_ratio_, -32768.0, 32767.0));
  o_.torque_actual.value = o_.torque_demand.value = o_.current_actual.value = torque;
  o_.temperature.value = std::llround(10 * (faults_.hot ? hot_celsius : std::min(winding_.celsius(), 300.0)));
  o_.overload.value = std::llround(std::min(100.0, 100 * winding_.excess_ratio()));
  if (units_) units_->give_outputs();
}

}  // namespace lf::devices
