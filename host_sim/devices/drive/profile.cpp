#include "host_sim/devices/drive/profile.hpp"

#include <algorithm>
#include <cmath>

namespace lf::devices {

void Profile::hold(double position) {
  position_ = position;
  velocity_ = 0;
}

void Profile::move(double position, double velocity) {
  position_ = position;
  velocity_ = velocity;
}

void Profile::run_at(double velocity, double acceleration, double dt_s) {
  const double step = acceleration * dt_s;
  velocity_ = std::clamp(velocity, velocity_ - step, velocity_ + step);
  position_ += velocity_ * dt_s;
}

void Profile::go_to(double target, double velocity, double acceleration, double deceleration, double dt_s) {
  const double distance = target - position_;
  // The speed from which the rest of the way is just enough to brake, one step ahead.
  const double brake_step = deceleration * dt_s;
  const double braking =
      std::max(0.0, std::sqrt(2 * deceleration * std::abs(distance) + 0.25 * brake_step * brake_step) - 0.5 * brake_step);
  const double wanted = std::copysign(std::min(velocity, braking), distance);
  const bool slower = std::abs(wanted) < std::abs(velocity_) || wanted * velocity_ < 0;
  const double step = (slower ? deceleration : acceleration) * dt_s;
  velocity_ = std::clamp(wanted, velocity_ - step, velocity_ + step);
  position_ += velocity_ * dt_s;
  if (std::abs(target - position_) < 0.5 && std::abs(velocity_) <= 2 * brake_step) hold(target);
}

void CyclicPosition::target(double now_at, double position, Time sync, Duration period) {
  from_ = now_at;
  to_ = position;
  sync_ = sync;
  period_ = std::max(period, Duration::from_us(1));
}

double CyclicPosition::position(Time now) const {
  const double part = std::clamp((now - sync_).s() / period_.s(), 0.0, 1.0);
  return from_ + part * (to_ - from_);
}

double CyclicPosition::velocity(Time now) const { return now - sync_ <= period_ ? (to_ - from_) / period_.s() : 0; }

}  // namespace lf::devices
