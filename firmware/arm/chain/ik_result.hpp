// What inverse kinematics answers: joint values, or a reason with its amount.
//
// A solution is certain: it was evaluated on the chain. A reason is what was found, not a proof: a descent that did not arrive says nothing of the
// starts that were not made. Of 100,000 reachable poses of 2000 arms made at random (slides, seven and eight joints, crooked axes) none is refused,
// and the hardest takes 247 of 500 restarts (`lanternfish bench chain`, 2026-11-28); 400,000 more, of other seeds, took up to 341. Two refusals are
// certain. A target farther from the first joint than Chain::length_m() is never reached. And a closed form of finitely many postures has them all,
// so that its joint_limit is the least excess.
#pragma once

#include "firmware/arm/chain/ik_task.hpp"

namespace lf::chain {

enum class IkOutcome : std::uint8_t {
  solved,
  not_a_number,             // the task or the seed, or a number beyond `largest_value`
  out_of_reach,             // nothing within the limits was found that puts the tool there; `excess` m are missing at `nearest`
  orientation_unreachable,  // the position is within reach, but not so turned; `excess` rad are missing at `nearest`, which is close by
  joint_limit,              // all that is asked was found only with `joint` at `excess` past its limit (rad, or m of a slide)
  jump_needed,              // found only `excess` rad beyond jump_rad from the seed, and the arm is to stay
  singular,                 // the start is a posture from which no joint leads toward the target, and restarts are off
  gave_up,                  // none of the above was found within the restarts allowed
};
const char* name(IkOutcome outcome);

// A solution farther than this from the seed may be another posture of the arm: following it blindly would swing the arm through its workspace.
inline constexpr double jump_rad = 0.3;
// A seed's joint beyond it, rad or m, is no number of an arm: from 1e7 on a double does not hold an angle to `exact`.
inline constexpr double largest_value = 1e6;

struct IkResult {
  IkOutcome outcome = IkOutcome::gave_up;
  // Always finite and within the limits, before there is an answer, too. Solved: the answer. Failed, or running: the seed, each joint drawn into its limits; a joint
  // whose seed is no number, or beyond largest_value, at the middle of its range.
  JointValues q = JointValues::Zero();
  // The posture that `error`, `excess` and `joint` speak of. Solved: q. Failed: not to be commanded, as it may be past limits or far away: what
  // joint_limit and jump_needed would take, else the nearest that was found. not_a_number: q.
  JointValues nearest = JointValues::Zero();
  double excess = 0;
  int joint = -1;   // joint_limit: which
  TaskError error;  // what is left at `nearest`
  // Chain::travel_rad() from the seed as it was given, also where that is past limits, to q; infinite of a seed that is no number.
  double travel_rad = 0;
  bool jump = false;  // travel_rad > jump_rad
  bool closed_form = false;
  std::uint32_t iterations = 0;  // in the measure of advance(), all counted
  std::uint32_t restarts = 0;

  bool ok() const { return outcome == IkOutcome::solved; }
};

// True where each joint's seed is a number within largest_value.
bool usable(const JointValues& seed);
// A posture with each joint drawn into its limits, as IkResult::q says of a seed; zeros past the last joint.
JointValues drawn_in(const Chain& chain, const JointValues& q);
// Writes outcome, excess, q, nearest, travel_rad and jump. An answer that jumps is none where the arm is to `stay`.
void conclude(const Chain& chain, const JointValues& seed, bool stay, IkOutcome outcome, double excess, const JointValues& posture,
              IkResult& result);

enum class IkStatus : std::uint8_t { idle, running, solved, failed };

}  // namespace lf::chain
