#include "firmware/arm/guarded_motion.hpp"

#include <cmath>

namespace lf::arm {
namespace {

// Rows past an arm's own joints stay 0, and no threshold is below that.
constexpr std::size_t arm_joints = capacity::arm_joints;

constexpr double hardly_there = 0.25;  // of the contact's torque

// Counts samples in a row for which `says_so`; true once there are `wanted` of them.
bool run_of(bool says_so, std::uint32_t wanted, std::uint32_t& run) {
  run = says_so ? run + 1 : 0;
  return run >= wanted;
}

}  // namespace

void GuardedMotion::reset() {
  const std::uint32_t refused = refused_;
  *this = GuardedMotion(config_);
  refused_ = refused;
}

void GuardedMotion::latch(GuardState state, GuardCause cause, std::size_t joint) {
  if (state_ == GuardState::overload || state_ == state) return;
  state_ = state;
  cause_ = cause;
  joint_ = joint;
}

void GuardedMotion::observe(const JointVector& command_rad, double dt_s) {
  for (std::size_t i = 0; i < arm_joints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    if (samples_ == 1)
      commands_[i].reset(command_rad[joint]);
    else
      commands_[i].update(command_rad[joint], dt_s);
    command_rad_s_[joint] = commands_[i].velocity_rad_s();
  }
}

GuardState GuardedMotion::update(Time t, const JointVector& command_rad, const JointVector& position_rad, const JointVector& velocity_rad_s,
                                 const JointTorques& torque) {
  const bool numbers = command_rad.allFinite() && position_rad.allFinite() && velocity_rad_s.allFinite() && torque.finite();
  if (!numbers || (samples_ > 0 && t <= last_)) {
    ++refused_;
    return state_;
  }
  const double dt_s = samples_ > 0 ? (t - last_).s() : 0;
  last_ = t;
  ++samples_;
  if (samples_ == 1) filtered_ = torque;
  filtered_.follow(torque, dt_s / (dt_s + config_.filter_s));
  const bool learning = samples_ <= config_.learning;
  if (learning) baseline_nm_ += (torque.nm - baseline_nm_) / samples_;
  excess_nm_ = filtered_.nm - baseline_nm_;
  error_rad_ = command_rad - position_rad;
  position_rad_ = position_rad;
  observe(command_rad, dt_s);
  velocity_rad_s_ = velocity_rad_s;

  for (std::size_t i = 0; i < arm_joints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const bool over = std::abs(filtered_.sure_excess_nm(joint, 0)) > config_.overload_torque_nm[i];
    const bool pushed = !learning && std::abs(filtered_.sure_excess_nm(joint, baseline_nm_[joint])) > config_.contact_torque_nm[i];
    const bool behind = !learning && std::abs(error_rad_[i]) > config_.following_rad[i];
    if (run_of(over, config_.debounce, overload_run_[i])) latch(GuardState::overload, GuardCause::torque, i);
    if (run_of(pushed, config_.debounce, torque_run_[i])) latch(GuardState::contact, GuardCause::torque, i);
    if (run_of(behind, config_.debounce, following_run_[i])) latch(GuardState::contact, GuardCause::following_error, i);
    if (samples_ == 1 || std::abs(excess_nm_[i]) < hardly_there * config_.contact_torque_nm[i]) {
      free_position_rad_[i] = position_rad[i];
      free_command_rad_[i] = command_rad[i];
    }
    // A joint that is being pushed teaches nothing about free motion.
    if (!learning && std::abs(excess_nm_[i]) < 0.5 * config_.contact_torque_nm[i])
      baseline_nm_[i] += excess_nm_[i] * (dt_s / (dt_s + config_.baseline_s));
  }
  if (!learning && state_ == GuardState::learning) state_ = GuardState::free;
  return state_;
}

}  // namespace lf::arm
