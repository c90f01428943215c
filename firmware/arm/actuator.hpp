// Between motor counts and joint angles. Slew, shoulder and elbow are pushed by linear screws, so the angle per count varies over the stroke.
//
// A screw closes a triangle: length^2 = a^2 + b^2 - 2 a b cos(q + offset), counts = counts_per_m (length - length at q = 0). The gears of roll and jaw are linear.
#pragma once

#include <cstdint>

#include "shared/arm/arm_model.hpp"

namespace lf::arm {

// Motor counts at an angle, rounded to the nearest, halves away from zero. The angle is clamped to the joint's limits widened by 0.1 rad, where the
// screw's triangle still closes; not a number gives 0 counts, the homing position: callers refuse such targets before they get here.
std::int32_t counts_from_rad(const ArmModel::Joint& joint, double q_rad);

// The same without rounding.
double exact_counts_from_rad(const ArmModel::Joint& joint, double q_rad);

// The angle at a count. Counts beyond the widened limits give the angle at these.
double rad_from_counts(const ArmModel::Joint& joint, std::int32_t counts);

// d angle / d count, positive.
double rad_per_count(const ArmModel::Joint& joint, double q_rad);

}  // namespace lf::arm
