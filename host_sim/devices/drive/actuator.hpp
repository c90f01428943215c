// Motor counts of a joint's angle, through the arm's screws and gears.
//
// Screw: its length closes a triangle with two fixed sides, length^2 = a^2 + b^2 - 2 a b cos(q + offset), and counts are proportional to what it
// grew since q = 0. So counts per radian vary over the stroke: d counts / d q = counts_per_m a b sin(q + offset) / length.
#pragma once

#include "shared/arm/arm_description.hpp"

namespace lf::devices {

class Actuator {
 public:
  explicit Actuator(const ArmActuator& geometry);

  double counts(double angle_rad) const;
  double counts_per_rad(double angle_rad) const;  // negative where the motor turns against the joint

 private:
  double length_m(double angle_rad) const;

  ArmActuator geometry_;
  double zero_length_m_ = 0;
};

}  // namespace lf::devices
