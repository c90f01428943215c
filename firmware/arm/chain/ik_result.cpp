#include "firmware/arm/chain/ik_result.hpp"

#include <cmath>
#include <limits>

namespace lf::chain {
namespace {

bool is_value(double value) { return std::abs(value) <= largest_value; }  // false of what is not a number

}  // namespace

const char* name(IkOutcome outcome) {
  switch (outcome) {
    case IkOutcome::solved: return "solved";
    case IkOutcome::not_a_number: return "not a number";
    case IkOutcome::out_of_reach: return "out of reach";
    case IkOutcome::orientation_unreachable: return "orientation unreachable";
    case IkOutcome::joint_limit: return "joint limit";
    case IkOutcome::jump_needed: return "jump needed";
    case IkOutcome::singular: return "singular";
    case IkOutcome::gave_up: return "gave up";
  }
  return "unknown";
}

bool usable(const JointValues& seed) {
  for (std::size_t i = 0; i < max_joints; ++i)
    if (!is_value(seed[i])) return false;
  return true;
}

JointValues drawn_in(const Chain& chain, const JointValues& q) {
  JointValues out = chain.middle();
  for (std::size_t i = 0; i < chain.size(); ++i)
    if (is_value(q[i])) out[i] = chain.drawn_in(i, q[i]);
  return out;
}

void conclude(const Chain& chain, const JointValues& seed, bool stay, IkOutcome outcome, double excess, const JointValues& posture,
              IkResult& result) {
  result.outcome = outcome;
  result.excess = excess;
  // A joint that turns round may have been left a rounding past its limits.
  result.nearest = outcome == IkOutcome::solved ? drawn_in(chain, posture) : posture;
  const double travel_rad = chain.travel_rad(seed, posture);
  if (outcome == IkOutcome::solved && stay && travel_rad > jump_rad) {
    result.outcome = IkOutcome::jump_needed;
    result.excess = travel_rad - jump_rad;
  }
  result.q = result.outcome == IkOutcome::solved ? result.nearest : drawn_in(chain, seed);
  result.travel_rad = seed.allFinite() ? chain.travel_rad(seed, result.q) : std::numeric_limits<double>::infinity();
  result.jump = result.travel_rad > jump_rad;
}

}  // namespace lf::chain
