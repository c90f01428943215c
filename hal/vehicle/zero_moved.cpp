#include "hal/vehicle/zero_moved.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "firmware/arm/actuator.hpp"

namespace lf::hal {

double zero_moved_rad(const ArmModel::Joint& joint, double place_rad, double moved_counts) {
  const double counts = arm::exact_counts_from_rad(joint, place_rad);
  double most_rad = 0;
  for (const double way : {-1.0, 1.0}) {
    const auto there = static_cast<std::int32_t>(std::lround(counts + way * moved_counts));
    most_rad = std::max(most_rad, std::abs(std::clamp(arm::rad_from_counts(joint, there), joint.lower_rad, joint.upper_rad) - place_rad));
  }
  return most_rad;
}

}  // namespace lf::hal
