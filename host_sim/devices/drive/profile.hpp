// The demand that a drive's position loop follows, in counts and counts/s, and the ramps that move it.
#pragma once

#include "shared/messages/time.hpp"

namespace lf::devices {

class Profile {
 public:
  double position() const { return position_; }
  double velocity() const { return velocity_; }
  bool standing() const { return velocity_ == 0; }

  void hold(double position);                   // stands there
  void move(double position, double velocity);  // another generator's demand
  // Each advances by `dt_s`. Limits are positive.
  void go_to(double target, double velocity, double acceleration, double deceleration, double dt_s);  // trapezoidal
  void run_at(double velocity, double acceleration, double dt_s);                                     // ramps to a speed
  void stop(double deceleration, double dt_s) { run_at(0, deceleration, dt_s); }

 private:
  double position_ = 0;
  double velocity_ = 0;
};

// Cyclic synchronous position: from one SYNC's target to the next on a straight line over the interpolation period 60C2.
class CyclicPosition {
 public:
  void hold(double position) { from_ = to_ = position; }
  void target(double now_at, double position, Time sync, Duration period);
  // Demand at `now`; past the period it waits at the target.
  double position(Time now) const;
  double velocity(Time now) const;

 private:
  double from_ = 0, to_ = 0;
  Time sync_;
  Duration period_ = Duration::from_ms(1);
};

}  // namespace lf::devices
