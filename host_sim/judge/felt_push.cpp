// Whether any drive could feel that the arm was pushed.
#include <algorithm>

#include "host_sim/judge/verdict.hpp"

namespace lf::judge {

bool felt_a_push(const Seen& seen, const SafetyFigures& figures) {
  constexpr std::size_t before_ms = 20, judged_ms = 50;
  for (std::size_t joint = 0; joint < arm_joint_count; ++joint) {
    double free_nm = 0;
    for (std::size_t t = 0; t < std::min(before_ms, seen.moments.size()); ++t)
      free_nm += double(seen.moments[t].works_nm[joint]) / before_ms;
    std::size_t run = 0;
    for (const Moment& moment : seen.moments) {
      run = double(moment.works_nm[joint]) - free_nm > figures.felt_nm[joint] ? run + 1 : 0;
      if (run >= judged_ms) return true;
    }
  }
  return false;
}

}  // namespace lf::judge
