// What is asked of a tool pose: always its position; the direction of its approach axis, the roll about it, both or neither.
//
// The tool's z axis approaches and its x axis opens. A robot whose description has other axes there turns its tool frame when the chain is made:
// tool_with_axes(). Fewer than six joints cannot hold every pose, so a task asks for what matters:
//   position           a laser point, a push button for a round tip
//   position + axis    a push button, a hot stab
//   position + roll    a bar for an arm with four joints: z follows from the position, x stays square to the target's y
//   position + both    the whole pose
// Each part has its tolerance. A tolerance above 1 mrad, or 1 mm on an arm of 1 m, frees joints: within it the part asks for nothing. A smaller one
// only lets the solver stop sooner.
#pragma once

#include <array>
#include <optional>

#include "firmware/arm/chain/chain.hpp"

namespace lf::chain {

struct IkTask {
  Pose base_from_tool = Pose::Identity();
  bool axis = true;
  bool roll = true;
  // 0: as exact as the solvers are, `exact`.
  double position_tolerance_m = 0;
  double axis_tolerance_rad = 0;
  double roll_tolerance_rad = 0;

  // How many numbers it fixes.
  int constraints() const { return 3 + (axis ? 2 : 0) + (roll ? 1 : 0); }
  bool valid() const;  // all numbers finite, a rotation, no negative tolerance
};

// A part with tolerance 0 is met within this: rad, and the same share of the arm's length for positions. It is 1 nm on one metre.
inline constexpr double exact = 1e-9;

// What a tool pose lacks of a task.
struct TaskError {
  double position_m = 0;
  double axis_rad = 0;  // 0 where the task does not ask
  double roll_rad = 0;
  // The whole rotation's angle where the task asks for all of it, else the larger of the two above.
  double orientation_rad = 0;
};
TaskError task_error(const IkTask& task, const Mat3& tool, const Vec3& tool_m);
bool met(const IkTask& task, const TaskError& error, double length_m);

// The error as a vector that is to become zero, and how it falls with the tool's motion.
// Rows 0 to 2 are the position's, divided by the arm's length so that they weigh like angles; rows 3 to 5 the orientation's, rad.
struct TaskResidual {
  Eigen::Matrix<double, 6, 1> value = Eigen::Matrix<double, 6, 1>::Zero();
  Mat3 from_linear = Mat3::Zero();   // the rate at which rows 0 to 2 fall = this * linear velocity
  Mat3 from_angular = Mat3::Zero();  // the rate at which rows 3 to 5 fall = this * angular velocity
  bool is_met = false;
};
// `position_weight` multiplies rows 0 to 2.
void residual(const IkTask& task, const ChainState& state, double length_m, double position_weight, TaskResidual& out);

// One of the six axes of a frame.
enum class FrameAxis : std::uint8_t { x, y, z, minus_x, minus_y, minus_z };
// The tool frame for the solvers: its z is `approach` and its x is `opening` of `tool`. Nothing when both are on one line.
std::optional<Pose> tool_with_axes(const Pose& tool, FrameAxis approach, FrameAxis opening);

}  // namespace lf::chain
