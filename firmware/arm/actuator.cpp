#include "firmware/arm/actuator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::arm {
namespace {

using arm_geometry::JointNumbers;

constexpr double widening_rad = 0.1;

bool is_gear(const JointNumbers& joint) { return joint.counts_per_rad > 0; }

double clamp_angle(const JointNumbers& joint, double q_rad) {
  return std::clamp(q_rad, joint.lower_rad - widening_rad, joint.upper_rad + widening_rad);
}

double screw_length_m(const JointNumbers& joint, double q_rad) {
  const double a = joint.pivot_a_m;
  const double b = joint.pivot_b_m;
  return std::sqrt(a * a + b * b - 2 * a * b * std::cos(q_rad + joint.offset_rad));
}

}  // namespace

double exact_counts_from_rad(Joint joint, double q_rad) {
  const JointNumbers& n = numbers(joint);
  if (std::isnan(q_rad)) return 0;
  const double q = clamp_angle(n, q_rad);
  return is_gear(n) ? n.counts_per_rad * q : n.counts_per_m * (screw_length_m(n, q) - screw_length_m(n, 0));
}

std::int32_t counts_from_rad(Joint joint, double q_rad) {
  return static_cast<std::int32_t>(std::lround(exact_counts_from_rad(joint, q_rad)));
}

double rad_from_counts(Joint joint, std::int32_t counts) {
  const JointNumbers& n = numbers(joint);
  if (is_gear(n)) return clamp_angle(n, counts / n.counts_per_rad);
  const double length = screw_length_m(n, 0) + counts / n.counts_per_m;
  const double a = n.pivot_a_m;
  const double b = n.pivot_b_m;
  // A length shorter or longer than the triangle allows is the nearest end's; a negative one the shorter end's.
  const double cosine = length > 0 ? std::clamp((a * a + b * b - length * length) / (2 * a * b), -1.0, 1.0) : 1.0;
  return clamp_angle(n, std::acos(cosine) - n.offset_rad);
}

double rad_per_count(Joint joint, double q_rad) {
  const JointNumbers& n = numbers(joint);
  if (is_gear(n)) return 1 / n.counts_per_rad;
  const double q = std::isnan(q_rad) ? 0 : clamp_angle(n, q_rad);
  return screw_length_m(n, q) / (n.counts_per_m * n.pivot_a_m * n.pivot_b_m * std::sin(q + n.offset_rad));
}

}  // namespace lf::arm
