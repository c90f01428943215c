#include "firmware/arm/gripper.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

// The handle is known to 4 mm and the tool comes to 2 mm of where it is sent; a tool 14 degrees aslant has its finger tips, 25 mm before and behind the
// bar, 6 mm off to the side. Twice that, since a finger that meets the bar's edge pushes instead of reaching around.
constexpr double reaching_room_m = 0.024;
// A jaw that was opened stands this much short of its goal: 4 mrad at rest, and the play of a drive that was stopped there.
constexpr double short_of_open_m = 0.002;
// Within this of its stop it is closed: it counts as empty from 4 mrad on, and its zero may be 5 mrad off. The pads are then 3 mm apart.
constexpr double closed_rad = 0.01;
// An encoder that has moved so far is not stuck, and what jammed the jaw has let it go.
constexpr double free_rad = 0.05;

bool in_doubt(GripperState state) {
  switch (state) {
    case GripperState::held:
    case GripperState::dropped:
    case GripperState::jammed:
    case GripperState::lost: return true;
    default: return false;
  }
}

}  // namespace

double gap_from_jaw(const ArmModel::Jaw& jaw, double jaw_rad) {
  return -2 * (jaw.pivot_x_m + jaw.face_x_m * std::cos(jaw_rad) - jaw.face_z_m * std::sin(jaw_rad));
}

double jaw_from_gap(const ArmModel::Jaw& jaw, double gap_m) {
  // face_x cos q - face_z sin q = reach cos(q + phase)
  const double reach = std::hypot(jaw.face_x_m, jaw.face_z_m);
  const double phase = std::atan2(jaw.face_z_m, jaw.face_x_m);
  const double cosine = std::clamp((-gap_m / 2 - jaw.pivot_x_m) / reach, -1.0, 1.0);
  return std::clamp(std::acos(cosine) - phase, jaw.lower_rad, jaw.upper_rad);
}

double pad_force_n(const ArmModel::Jaw& jaw, double jaw_torque_nm) { return jaw_torque_nm / 2 / jaw.face_z_m; }

bool stands_closed(const ArmModel::Jaw& jaw, double jaw_rad) { return std::abs(jaw_rad - jaw.lower_rad) <= closed_rad; }

bool stands_empty(const ArmModel::Jaw& jaw, double jaw_rad, double bar_m) {
  const bool open = jaw_rad <= jaw.upper_rad + closed_rad && gap_from_jaw(jaw, jaw_rad) > jaw_opening_m(jaw, bar_m) - short_of_open_m;
  return stands_closed(jaw, jaw_rad) || open;  // what is not a number is neither
}

double thinnest_bar_m(const ArmModel::Jaw& jaw) {
  constexpr double told_apart_m = 0.0065;  // a grip's tolerance, and half a millimetre
  return std::max(thinnest_bar_of_any_m, gap_from_jaw(jaw, jaw.lower_rad) + told_apart_m);
}

GripperConfig gripper_config(const ArmModel::Joint& joint) {
  constexpr double grip_share = 0.3, hold_share = 0.1;        // of the peak torque
  constexpr double closing_share = 0.5, opening_share = 0.8;  // of the top speed
  constexpr double stall_counts = 3.7, spare = 1.4;           // of the encoder; of the time for the whole stroke
  GripperConfig config;
  config.grip_torque_nm = grip_share * joint.effort_nm;
  config.hold_torque_nm = hold_share * joint.effort_nm;
  config.closing_speed_rad_s = closing_share * joint.velocity_rad_s;
  config.opening_speed_rad_s = opening_share * joint.velocity_rad_s;
  config.ramp_rad_s2 = joint.acceleration_rad_s2;
  config.stall_rad = std::max(config.stall_rad, stall_counts * rad_per_count(joint, 0.5 * (joint.lower_rad + joint.upper_rad)));
  const double stroke_s = (joint.upper_rad - joint.lower_rad) / config.closing_speed_rad_s;
  config.move_timeout = std::max(config.move_timeout, Duration::from_s(spare * stroke_s));
  return config;
}

double jaw_opening_m(const ArmModel::Jaw& jaw, double bar_m) {
  return std::min(bar_m + 2 * reaching_room_m, gap_from_jaw(jaw, jaw.upper_rad));
}

double thickest_bar_m(const ArmModel::Jaw& jaw) { return gap_from_jaw(jaw, jaw.upper_rad) - 2 * reaching_room_m; }

double tip_beyond_tool_m(const ArmModel::Jaw& jaw, double jaw_rad) {
  const double end = (jaw.face_z_m + jaw.pad_depth_m / 2) * std::cos(jaw_rad);
  return jaw.pivot_z_m + end + std::max(0.0, jaw.face_x_m * std::sin(jaw_rad));
}

void Gripper::open_to(double gap_m) {
  if (!std::isfinite(gap_m)) return;
  goal_rad_ = jaw_from_gap(jaw_, gap_m);
  order_ = Order::open;
}

void Gripper::turn_to(double jaw_rad) {
  if (!std::isfinite(jaw_rad)) return;
  goal_rad_ = std::clamp(jaw_rad, jaw_.lower_rad, jaw_.upper_rad);
  order_ = Order::open;
}

void Gripper::close() { order_ = Order::close; }
void Gripper::stay() { order_ = Order::stay; }

GripperState Gripper::state() const {
  switch (order_) {
    case Order::open: return GripperState::opening;
    case Order::close: return GripperState::closing;
    default: return state_;
  }
}

bool Gripper::doubted() const { return doubted_ || in_doubt(state()) || state() == GripperState::closing; }

bool Gripper::may_hold(double jaw_rad) const { return doubted() || !stands_empty(jaw_, jaw_rad, config_.bar_m); }

void Gripper::wait(Duration d) {
  still_since_ = still_since_ + d;
  began_ = began_ + d;
  unloaded_ = unloaded_ + d;
  last_ = last_ + d;
}

void Gripper::begin(Time t, double jaw_rad) {
  // It may have closed on something, and was called away before it could tell.
  if (state_ == GripperState::closing && order_ != Order::close) {
    doubted_ = true;
    doubted_rad_ = jaw_rad;
  }
  if (order_ == Order::close) goal_rad_ = jaw_.lower_rad;
  state_ = order_ == Order::open ? GripperState::opening : order_ == Order::close ? GripperState::closing : GripperState::idle;
  order_ = Order::none;
  // From where the jaw is: a squeeze's lead or an old target must not make it jump.
  target_rad_ = std::clamp(jaw_rad, jaw_.lower_rad, jaw_.upper_rad);
  still_rad_ = jaw_rad;
  nearest_rad_ = std::abs(goal_rad_ - jaw_rad);
  still_since_ = began_ = unloaded_ = t;
  low_torque_run_ = 0;
}

double Gripper::update(Time t, double jaw_rad, const TorqueEstimate& torque) {
  if (!std::isfinite(jaw_rad) || !std::isfinite(torque.nm + torque.low_nm + torque.high_nm) || (started_ && t <= last_)) {
    ++refused_;
    return target_rad_;
  }
  const double dt_s = started_ ? (t - last_).s() : 0;
  if (!started_) doubted_rad_ = jaw_rad;
  if (std::abs(jaw_rad - doubted_rad_) > free_rad) doubted_ = false;
  last_ = t;
  started_ = true;
  if (order_ != Order::none) begin(t, jaw_rad);
  if (state_ == GripperState::opening || state_ == GripperState::closing) move(t, jaw_rad, torque, dt_s);
  if (state_ == GripperState::held) hold(jaw_rad, torque, dt_s);
  if (state_ == GripperState::open) rest(t, jaw_rad, torque);
  if (in_doubt(state_)) {
    doubted_ = true;
    doubted_rad_ = jaw_rad;
  }
  return target_rad_;
}

void Gripper::move(Time t, double jaw_rad, const TorqueEstimate& torque, double dt_s) {
  const double top = state_ == GripperState::opening ? config_.opening_speed_rad_s : config_.closing_speed_rad_s;
  const double speed = std::min(top, config_.ramp_rad_s2 * (t - began_).s());
  target_rad_ += std::clamp(goal_rad_ - target_rad_, -speed * dt_s, speed * dt_s);
  target_rad_ = std::clamp(target_rad_, jaw_rad - config_.lead_rad, jaw_rad + config_.lead_rad);
  nearest_rad_ = std::min(nearest_rad_, std::abs(goal_rad_ - jaw_rad));
  if (std::abs(goal_rad_ - jaw_rad) > nearest_rad_ + config_.wrong_way_rad) {
    state_ = GripperState::lost;
    target_rad_ = jaw_rad;
    return;
  }
  if (std::abs(jaw_rad - still_rad_) > config_.stall_rad) {
    still_rad_ = jaw_rad;
    still_since_ = t;
  }
  if (std::abs(jaw_rad - goal_rad_) <= 2 * config_.stall_rad) {
    state_ = state_ == GripperState::opening ? GripperState::open : GripperState::empty;
    target_rad_ = goal_rad_;
    return;
  }
  const bool pushing = target_rad_ == goal_rad_ || std::abs(target_rad_ - jaw_rad) >= 0.99 * config_.lead_rad;
  // A screw that has clamped needs more than a moment to break loose.
  const bool widening = state_ == GripperState::opening && goal_rad_ > jaw_rad;
  if (pushing && t - still_since_ >= (widening ? config_.lost_time * 4 : config_.stall_time)) stalled(jaw_rad, torque);
  if (state_ != GripperState::opening && state_ != GripperState::closing) return;
  // A drive that goes on pushing the other way does not hear its target; a screw that is turning round gets time for it.
  const double towards_nm = target_rad_ > jaw_rad ? torque.nm : -torque.nm;
  const Duration patience = towards_nm < -config_.hold_torque_nm ? config_.lost_time * 4 : config_.lost_time;
  if (pushing && t - still_since_ >= patience && towards_nm < config_.hold_torque_nm) {
    state_ = GripperState::lost;
    target_rad_ = jaw_rad;
    return;
  }
  if (t - began_ >= config_.move_timeout) {
    state_ = GripperState::jammed;
    target_rad_ = jaw_rad;  // pressing on would only heat the motor
  }
}

// Open, it touches nothing. A drive whose encoder stands still creeps on until the fingers meet their stop.
void Gripper::rest(Time t, double jaw_rad, const TorqueEstimate& torque) {
  if (std::abs(torque.at_least_nm()) < config_.grip_torque_nm) unloaded_ = t;
  if (t - unloaded_ >= config_.stall_time) target_rad_ = jaw_rad;  // a stop that is nearer than believed is let go of
  if (t - unloaded_ >= config_.lost_time) state_ = GripperState::lost;
}

// Opening is positive, so that a closing torque is negative.
void Gripper::stalled(double jaw_rad, const TorqueEstimate& torque) {
  if (state_ == GripperState::opening) {
    // A jaw that stands without pressing may be held by its stiction: it has until the time-out. One that presses on something is jammed, whichever way
    // it was told to go.
    const double pressing_nm = goal_rad_ > jaw_rad ? torque.low_nm : -torque.high_nm;
    if (pressing_nm < config_.grip_torque_nm) return;
    state_ = GripperState::jammed;
    target_rad_ = jaw_rad;
    return;
  }
  if (-torque.high_nm < config_.grip_torque_nm) return;
  const double gap = gap_from_jaw(jaw_, jaw_rad);
  grip_rad_ = crept_rad_ = jaw_rad;
  grip_gap_m_ = gap;
  const bool bar = std::abs(gap - config_.bar_m) <= config_.bar_tolerance_m;
  if (!bar || stands_closed(jaw_, jaw_rad)) {
    state_ = stands_closed(jaw_, jaw_rad) ? GripperState::empty : GripperState::jammed;
    target_rad_ = jaw_rad;
  } else {
    state_ = GripperState::held;
    target_rad_ = std::max(jaw_rad - config_.lead_rad, jaw_.lower_rad);
  }
}

// Pads creep over a bar that turns between them, and snap shut when it has gone. A jaw that goes on closing then wedges the bar away, and the arm with it.
void Gripper::hold(double jaw_rad, const TorqueEstimate& torque, double dt_s) {
  low_torque_run_ = -torque.low_nm < config_.hold_torque_nm ? low_torque_run_ + 1 : 0;
  crept_rad_ += (jaw_rad - crept_rad_) * (dt_s / (dt_s + config_.creep_s));
  const bool slipped = jaw_rad < grip_rad_ - config_.slip_rad || jaw_rad < crept_rad_ - config_.snap_rad;
  if (!slipped && low_torque_run_ < config_.low_torque_samples) return;
  state_ = GripperState::dropped;
  target_rad_ = jaw_rad;
}

}  // namespace lf::arm
