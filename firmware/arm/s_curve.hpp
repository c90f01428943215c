// A path travelled from rest to rest with bounded speed, acceleration and jerk: the seven segments of constant jerk, in closed form.
//
// Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, ch. 3.4: the shortest such motion for a given distance.
#pragma once

#include <array>
#include <cstddef>

namespace lf::arm {

struct PathState {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
};

// From 0 to `distance` >= 0, in any unit.
class SCurve {
 public:
  SCurve() = default;
  // Bounds must be positive; a distance of 0 makes a motion of 0 s. False, and a motion of 0 s over no distance, when an argument is out of range
  // or not a number.
  bool plan(double distance, double max_velocity, double max_acceleration, double max_jerk);

  double duration_s() const { return duration_s_; }
  double distance() const { return distance_; }
  double peak_velocity() const { return jerk_ * jerk_time_s_ * acceleration_time_s_; }
  // At rest before 0 s and, exactly at `distance`, from duration_s() on.
  PathState sample(double t_s) const;

 private:
  double distance_ = 0, duration_s_ = 0;
  double jerk_ = 0;
  double jerk_time_s_ = 0, acceleration_time_s_ = 0, cruise_time_s_ = 0;  // a ramp lasts both of the first two
};

// From any speed and acceleration to rest, as fast as acceleration and jerk allow; wherever it ends.
class StopCurve {
 public:
  StopCurve() = default;
  // Bounds must be positive.
  StopCurve(const PathState& from, double max_acceleration, double max_jerk);

  double duration_s() const { return segment_s_[0] + segment_s_[1] + segment_s_[2]; }
  PathState sample(double t_s) const;

 private:
  PathState from_;
  std::array<double, 3> segment_s_{};
  std::array<double, 3> jerk_{};
};

}  // namespace lf::arm
