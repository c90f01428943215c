// A joint's speed from its encoder: an alpha-beta observer.
//
// One encoder count in 4 ms is 0.09 rad/s at the elbow, more than the joint's slowest speed; a difference of counts is therefore no speed.
// The observer predicts with a constant speed and corrects by the residual. Critically damped gains for a pole z are alpha = 1 - z^2 and
// beta = (1 - z)^2 (Benedict and Bordner 1962; Kalata 1984).
#pragma once

namespace lf::arm {

class JointObserver {
 public:
  // z = 0.85 at 250 Hz settles in about 0.1 s, and one elbow count shows as 0.002 rad/s.
  static constexpr double pole = 0.85;

  void reset(double position_rad) {
    position_rad_ = position_rad;
    velocity_rad_s_ = 0;
  }

  void update(double measured_rad, double dt_s) {
    const double predicted = position_rad_ + velocity_rad_s_ * dt_s;
    const double residual = measured_rad - predicted;
    position_rad_ = predicted + (1 - pole * pole) * residual;
    velocity_rad_s_ += (1 - pole) * (1 - pole) / dt_s * residual;
  }

  double position_rad() const { return position_rad_; }
  double velocity_rad_s() const { return velocity_rad_s_; }

 private:
  double position_rad_ = 0;
  double velocity_rad_s_ = 0;
};

}  // namespace lf::arm
