#include "host_sim/devices/drive/actuator.hpp"

#include <cmath>

namespace lf::devices {

Actuator::Actuator(const ArmActuator& geometry) : geometry_(geometry) { zero_length_m_ = length_m(0); }

double Actuator::length_m(double angle_rad) const {
  const double a = geometry_.pivot_a_m, b = geometry_.pivot_b_m;
  return std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle_rad + geometry_.offset_rad));
}

double Actuator::counts(double angle_rad) const {
  if (geometry_.pivot_a_m == 0) return geometry_.counts_per_rad * angle_rad;
  return geometry_.counts_per_m * (length_m(angle_rad) - zero_length_m_);
}

double Actuator::counts_per_rad(double angle_rad) const {
  if (geometry_.pivot_a_m == 0) return geometry_.counts_per_rad;
  const double arm_m = geometry_.pivot_a_m * geometry_.pivot_b_m * std::sin(angle_rad + geometry_.offset_rad) / length_m(angle_rad);
  return geometry_.counts_per_m * arm_m;
}

}  // namespace lf::devices
