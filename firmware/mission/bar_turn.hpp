// Turns a held bar about the valve's axis with the tool at a tilt to it.
//
// The wrist turns about the tool axis, the bar about the panel's normal. With a tilt between them the two angles differ as over a universal joint, by
// up to 2 degrees at 15 degrees of tilt: the roll is taken from the bar's direction at every instant, not in proportion.
#pragma once

#include "firmware/arm/s_curve.hpp"
#include "firmware/arm/trajectory.hpp"
#include "shared/geometry/pose.hpp"

namespace lf::mission {

class BarTurn {
 public:
  struct Limits {
    double speed_rad_s = 0.35;  // of the bar
    double acceleration_rad_s2 = 1.0;
    double jerk_rad_s3 = 10.0;
  };

  // From handle angle `from_rad` to `to_rad` (shared/geometry/pose.hpp's convention), the tool staying at `start_rad`, whose roll holds the bar.
  // False when the bar cannot be held so at some angle, or the roll leaves [roll_min_rad, roll_max_rad] on the way.
  bool plan(const arm::Arm& arm, const arm::JointVector& start_rad, const Mat3& base_from_panel, double from_rad, double to_rad,
            const Limits& limits, double roll_min_rad, double roll_max_rad);

  double duration_s() const { return curve_.duration_s(); }
  // Where a planned turn ends; on the way only the roll changes, from where it starts to here.
  const arm::JointVector& goal_rad() const { return goal_rad_; }
  // Joints at a time; times must not go backwards, since the roll is followed from the one before.
  arm::JointVector sample(double t_s);
  double handle_rad(double t_s) const;

 private:
  // The roll for a handle angle that is nearest to `near_rad`; not a number when there is none.
  double roll_at(double handle_rad, double near_rad) const;

  const arm::Arm* arm_ = nullptr;
  arm::JointVector q_rad_ = arm::JointVector::Zero();
  arm::JointVector goal_rad_ = arm::JointVector::Zero();
  Mat3 base_from_panel_ = Mat3::Identity();
  double from_rad_ = 0;
  double direction_ = 1;
  arm::SCurve curve_;
};

}  // namespace lf::mission
