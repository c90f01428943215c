#include "host_sim/devices/drive/position_loop.hpp"

#include <algorithm>
#include <cmath>

namespace lf::devices {
namespace {

constexpr double ramp_reserve = 1.25;    // a drive's torque beyond what its own ramp takes: it catches up with it
constexpr double braking_reserve = 0.7;  // of the acceleration is planned with, the rest is the loop's

}  // namespace

void PositionLoop::reset() {
  feed_forward_rad_s_ = velocity_rad_s_ = asked_rad_s_ = 0;
  awake_ = saturated_ = false;
}

double PositionLoop::step(double demand, double demand_velocity, double actual, double rad_per_count, double dt_s, bool smooth) {
  const double error_counts = demand - actual;
  const double share = smooth ? 1.0 : std::min(1.0, dt_s / config_.feed_forward_filter_s);
  feed_forward_rad_s_ += (demand_velocity * rad_per_count - feed_forward_rad_s_) * share;
  const bool moving = std::abs(feed_forward_rad_s_) > config_.still_rad_s;
  if (moving || std::abs(error_counts) > config_.wake_counts) awake_ = true;
  if (!moving && std::abs(error_counts) < config_.sleep_counts) awake_ = false;
  if (!moving) feed_forward_rad_s_ = 0;
  if (!awake_) {
    velocity_rad_s_ = asked_rad_s_ = 0;
    saturated_ = false;
    return 0;
  }
  return wanted(error_counts * rad_per_count, error_counts, (smooth ? ramp_reserve : 1) * config_.max_acceleration_rad_s2 * dt_s);
}

// Proportional near the target; far from it no faster than the acceleration can brake.
double PositionLoop::wanted(double error_rad, double error_counts, double step) {
  const double braking = std::sqrt(2 * braking_reserve * config_.max_acceleration_rad_s2 * std::abs(error_rad));
  const double correction = std::copysign(std::min(config_.gain_per_s * std::abs(error_rad), braking), error_rad);
  asked_rad_s_ = feed_forward_rad_s_ + (error_counts == 0 ? 0 : correction);
  const double limited = std::clamp(asked_rad_s_, -config_.max_velocity_rad_s, config_.max_velocity_rad_s);
  velocity_rad_s_ = std::clamp(limited, velocity_rad_s_ - step, velocity_rad_s_ + step);
  saturated_ = velocity_rad_s_ != asked_rad_s_;
  return velocity_rad_s_;
}

}  // namespace lf::devices
