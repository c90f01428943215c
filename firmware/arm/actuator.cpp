#include "firmware/arm/actuator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::arm {
namespace {

constexpr double widening_rad = 0.1;

bool is_gear(const ArmModel::Joint& joint) { return joint.actuator.counts_per_rad > 0; }

double clamp_angle(const ArmModel::Joint& joint, double q_rad) {
  return std::clamp(q_rad, joint.lower_rad - widening_rad, joint.upper_rad + widening_rad);
}

double screw_length_m(const ArmModel::Joint& joint, double q_rad) {
  const double a = joint.actuator.pivot_a_m;
  const double b = joint.actuator.pivot_b_m;
  return std::sqrt(a * a + b * b - 2 * a * b * std::cos(q_rad + joint.actuator.offset_rad));
}

}  // namespace

double exact_counts_from_rad(const ArmModel::Joint& joint, double q_rad) {
  if (std::isnan(q_rad)) return 0;
  const double q = clamp_angle(joint, q_rad);
  return is_gear(joint) ? joint.actuator.counts_per_rad * q
                        : joint.actuator.counts_per_m * (screw_length_m(joint, q) - screw_length_m(joint, 0));
}

std::int32_t counts_from_rad(const ArmModel::Joint& joint, double q_rad) {
  return static_cast<std::int32_t>(std::lround(exact_counts_from_rad(joint, q_rad)));
}

double rad_from_counts(const ArmModel::Joint& joint, std::int32_t counts) {
  if (is_gear(joint)) return clamp_angle(joint, counts / joint.actuator.counts_per_rad);
  const double length = screw_length_m(joint, 0) + counts / joint.actuator.counts_per_m;
  const double a = joint.actuator.pivot_a_m;
  const double b = joint.actuator.pivot_b_m;
  // A length shorter or longer than the triangle allows is the nearest end's; a negative one the shorter end's.
  const double cosine = length > 0 ? std::clamp((a * a + b * b - length * length) / (2 * a * b), -1.0, 1.0) : 1.0;
  return clamp_angle(joint, std::acos(cosine) - joint.actuator.offset_rad);
}

double rad_per_count(const ArmModel::Joint& joint, double q_rad) {
  if (is_gear(joint)) return 1 / joint.actuator.counts_per_rad;
  const double q = std::isnan(q_rad) ? 0 : clamp_angle(joint, q_rad);
  return screw_length_m(joint, q) /
         (joint.actuator.counts_per_m * joint.actuator.pivot_a_m * joint.actuator.pivot_b_m * std::sin(q + joint.actuator.offset_rad));
}

}  // namespace lf::arm
