// The protocol of the reference, after TRAC-IK's: random reachable poses, from the middle of the limits or from near the answer.
//
// Every success is checked by KDL's forward kinematics and against the limits.
#pragma once

#include <ostream>
#include <string>

#include "firmware/arm/chain/ik.hpp"
#include "tests/unit/arm_chain/random_postures.hpp"
#include "tests/unit/arm_chain/referee.hpp"

namespace lf::chain {

struct Mask {
  const char* name;
  const char* id;
  bool axis, roll;
  double position_m = 0, axis_rad = 0, roll_rad = 0;
};

inline IkTask task_of(const Mask& mask, const Pose& pose) {
  IkTask task;
  task.base_from_tool = pose;
  task.axis = mask.axis;
  task.roll = mask.roll;
  task.position_tolerance_m = mask.position_m;
  task.axis_tolerance_rad = mask.axis_rad;
  task.roll_tolerance_rad = mask.roll_rad;
  return task;
}

inline constexpr Mask masks[] = {{"pose", "Pose", true, true},
                                 {"position", "Position", false, false},
                                 {"position and axis", "PositionAndAxis", true, false},
                                 {"position and roll", "PositionAndRoll", false, true},
                                 {"pose to 1e-5", "PoseTo1e5", true, true, 1e-5, 1e-5, 1e-5},
                                 {"pose within 1 mm, 0.2 and 0.05 rad", "PoseWithinWideTolerances", true, true, 1e-3, 0.2, 0.05}};

// What so many joints can hold.
inline const Mask& mask_for(std::size_t joints) { return masks[joints >= 6 ? 0 : joints == 5 ? 2 : joints == 4 ? 3 : 1]; }

inline void PrintTo(const Mask& mask, std::ostream* out) { *out << mask.name; }

struct Tally {
  int solved = 0, wrong = 0, outside = 0, jumps = 0, unflagged = 0, closed = 0;
  std::uint32_t most_restarts = 0;
  double iterations = 0;
};

// `solve(task, seed)` returns an IkResult. With `near_rad` > 0 the seed is that near to the posture the pose was made of.
template <class Solve>
Tally run_protocol(const RealArm& arm, const Mask& mask, int poses, std::uint64_t seed, double near_rad, const Solve& solve) {
  const Chain chain = chain_of(arm);
  Referee kdl(arm);
  RandomPostures random(chain, seed);
  Tally tally;
  for (int k = 0; k < poses; ++k) {
    const JointValues q = random.next();
    const JointValues start = near_rad > 0 ? random.near(q, near_rad) : chain.middle();
    const IkTask task = task_of(mask, kdl.tool(q));
    const IkResult& result = solve(task, start);
    tally.iterations += result.iterations;
    tally.most_restarts = std::max(tally.most_restarts, result.restarts);
    if (!result.ok()) continue;
    ++tally.solved;
    tally.closed += result.closed_form ? 1 : 0;
    tally.wrong += kdl.fulfils(task, result.q) ? 0 : 1;
    tally.outside += within_limits(chain, result.q) ? 0 : 1;
    tally.jumps += result.jump ? 1 : 0;
    tally.unflagged += (result.q - start).cwiseAbs().maxCoeff() > 0.3 && !result.jump ? 1 : 0;
  }
  return tally;
}

}  // namespace lf::chain
