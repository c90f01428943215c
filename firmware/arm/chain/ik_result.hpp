// What inverse kinematics answers: joint values, or a reason with its amount.
#pragma once

#include "firmware/arm/chain/ik_task.hpp"

namespace lf::chain {

enum class IkOutcome : std::uint8_t {
  solved,
  not_a_number,             // the task or the seed
  out_of_reach,             // no joint values put the tool there; `excess` m are missing
  orientation_unreachable,  // the position is within reach, but not so turned; `excess` rad are missing there
  joint_limit,              // only with `joint` at `excess` past its limit (rad, or m of a slide)
  singular,                 // the start is a posture from which no joint leads toward the target, and restarts are off
  gave_up,                  // none of the above was proved within the restarts allowed
};
const char* name(IkOutcome outcome);

// A solution farther than this from the seed is another posture of the arm: following it blindly would swing the arm through its workspace.
inline constexpr double jump_rad = 0.3;

struct IkResult {
  IkOutcome outcome = IkOutcome::gave_up;
  JointValues q = JointValues::Zero();  // solved: within the limits. joint_limit: what would be needed. Else the nearest that was found
  double excess = 0;
  int joint = -1;         // joint_limit: which
  TaskError error;        // what is left at q
  double travel_rad = 0;  // the largest of a joint from the seed to q
  bool jump = false;      // travel_rad > jump_rad
  bool closed_form = false;
  std::uint32_t iterations = 0;  // of the numeric solver, polishing included
  std::uint32_t restarts = 0;

  bool ok() const { return outcome == IkOutcome::solved; }
};

enum class IkStatus : std::uint8_t { idle, running, solved, failed };

}  // namespace lf::chain
