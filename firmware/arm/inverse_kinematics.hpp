// From a tool point and a roll to joint angles, in closed form: no iteration, no starting guess, and a reason where there is no answer.
//
// A position fixes the approach axis: the arm has three joints besides the roll. The slew faces the target (front) or looks away from it with the arm
// folded under (folded); its range is less than half a turn, so at most one of the two is within its limits. The elbow's triangle of upper arm and
// forearm then gives shoulder and elbow.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

enum class IkOutcome : std::uint8_t {
  ok,
  not_a_number,
  too_far,   // beyond the stretched arm
  too_near,  // inside of what the folded arm can reach
  slew_limit,
  shoulder_limit,
  elbow_limit,
  roll_limit,
};
const char* name(IkOutcome outcome);

enum class IkBranch : std::uint8_t { front, folded };

struct IkResult {
  IkOutcome outcome = IkOutcome::not_a_number;
  IkBranch branch = IkBranch::folded;
  JointVector q_rad = JointVector::Zero();  // when ok; else the angles that would be needed, where there are any
  double excess = 0;                        // by how much: rad past the limit, or m too far or too near

  bool ok() const { return outcome == IkOutcome::ok; }
};

// The field's drivers stop within 0.05 rad of a limit; the laser sweep's start comes as near as 0.008 rad and has a margin of its own.
inline constexpr double default_limit_margin_rad = 0.05;

// Joint angles that put the tool point at `tool_m` (base frame) with the given roll, all of them inside their limits less `limit_margin_rad`.
// Exact to 1e-12 m. The roll's own limits, at +/- half a turn, are drawn in by the margin, too.
IkResult inverse_kinematics(const Vec3& tool_m, double roll_rad, double limit_margin_rad = default_limit_margin_rad);

// The two rolls, half a turn apart, that lay the tool's y axis along a bar: fingers close along x, across it.
// `tilt_rad` is what remains between bar and tool y: the bar's angle out of the plane square to the approach axis.
struct BarRolls {
  std::array<double, 2> roll_rad{};
  double tilt_rad = 0;
};

// For a tool at slew, shoulder and elbow of `q_rad` and a bar along `bar` (base frame, any length). Nothing when the bar points along the
// approach axis within 0.2 rad, or is not a number.
std::optional<BarRolls> rolls_for_bar(const JointVector& q_rad, const Vec3& bar);

// Of the two rolls, the one from which the wrist can turn by `turn_rad` (of roll; either sign) and stay inside its limits less `limit_margin_rad`,
// the one that stays farther from them. Nothing when neither can.
std::optional<double> roll_for_turn(const BarRolls& rolls, double turn_rad, double limit_margin_rad = default_limit_margin_rad);

}  // namespace lf::arm
