// Whether any drive could feel that the arm was pushed.
#include <algorithm>

#include "host_sim/judge/verdict.hpp"

namespace lf::judge {

bool felt_a_push(const Seen& seen, const SafetyFigures& figures) {
  // A joint whose speed changes its sign for a moment is pushed all the same.
  constexpr std::size_t before_ms = 20, judged_ms = 50, within_ms = 60;
  const std::size_t size = seen.moments.size(), free_ms = std::min(before_ms, size);
  for (std::size_t joint = 0; joint < seen.arm_joints; ++joint) {
    double free_nm = 0;
    for (std::size_t t = 0; t < free_ms; ++t) free_nm += double(seen.moments[t].works_nm[joint]) / double(free_ms);
    const auto felt = [&](std::size_t t) {
      return double(seen.moments[t].works_nm[joint]) - free_nm > (joint + 1 < seen.arm_joints ? figures.felt_nm : figures.felt_by_roll_nm);
    };
    std::size_t felt_ms = 0;
    for (std::size_t t = 0; t < size; ++t) {
      felt_ms += felt(t) ? 1 : 0;
      if (t >= within_ms && felt(t - within_ms)) --felt_ms;
      if (felt_ms >= judged_ms) return true;
    }
  }
  return false;
}

}  // namespace lf::judge
