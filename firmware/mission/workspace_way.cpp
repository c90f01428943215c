#include "firmware/mission/workspace_way.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {

bool keeps_to_workspace(const arm::Arm& arm, const safety::Limits& limits, const arm::JointVector& from_rad,
                        const arm::JointVector& to_rad) {
  constexpr double apart_rad =
      0.35;  // that the farthest joint goes from one check to the next: the tool of an arm of 1 m leaves the box by 15 mm unseen
  const int checks = std::max(18, static_cast<int>(std::ceil((to_rad - from_rad).cwiseAbs().maxCoeff() / apart_rad)));
  constexpr double noise_m = 0.0005;  // what the tool may be farther out at one check than at the one before, for the count of a joint
  double before_m = safety::workspace_excursion_m(limits, arm.base_from_tool(from_rad).translation());
  for (int i = 1; i <= checks; ++i) {
    const arm::JointVector q = from_rad + (to_rad - from_rad) * i / checks;
    const double excursion_m = safety::workspace_excursion_m(limits, arm.base_from_tool(q).translation());
    if (excursion_m > before_m + noise_m) return false;
    before_m = std::min(before_m, excursion_m);
  }
  return true;
}

}  // namespace lf::mission
