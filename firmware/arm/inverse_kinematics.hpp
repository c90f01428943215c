// From a tool point and a roll to joint angles, for arms of the planar form, in closed form: no iteration, no starting guess, and a reason where there is no answer.
//
// A position fixes the approach axis: the arm has three joints besides the roll. The slew faces the target (front) or looks away from it with the arm
// folded under (folded), and the elbow's triangle of upper arm and forearm bends one way or the other: of up to four postures those within the limits
// count.
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
  // Of arms of the chain form:
  joint_limit,  // of IkResult::joint
  turned_away,  // the place is within reach, but not with the approach axis so
  not_found,    // no posture was found, and no reason was sought
  other_form,   // the arm is not of a form that has an answer (ArmModel::Form)
};
const char* name(IkOutcome outcome);

enum class IkBranch : std::uint8_t { front, folded };

// Which of the four.
struct IkPosture {
  IkBranch branch = IkBranch::folded;
  bool bent_back = false;  // the elbow's triangle: false where the elbow's angle is larger than the stretched arm's
  friend bool operator==(const IkPosture&, const IkPosture&) = default;
};
IkPosture posture_of(const Arm& arm, const JointVector& q_rad);

struct IkResult {
  IkOutcome outcome = IkOutcome::not_a_number;
  IkPosture posture;
  JointVector q_rad = JointVector::Zero();  // when ok; else the angles that would be needed, where there are any
  double excess = 0;                        // by how much: rad past the limit or turned away, or m too far or too near
  std::size_t joint = 0;                    // joint_limit: which

  bool ok() const { return outcome == IkOutcome::ok; }
};

// The field's drivers stop within 0.05 rad of a limit; the laser sweep's start comes as near as 0.008 rad and has a margin of its own.
inline constexpr double default_limit_margin_rad = 0.05;

// Joint angles that put the tool point at `tool_m` (base frame) with the given roll, all of them inside their limits less `limit_margin_rad`.
// Exact to 1e-12 m. The roll's own limits are drawn in by the margin, too. Of several postures the one that is nearest to `near_rad`, by the largest travel
// of slew, shoulder or elbow; without it the one farthest from these joints' limits.
IkResult inverse_kinematics(const Arm& arm, const Vec3& tool_m, double roll_rad, double limit_margin_rad = default_limit_margin_rad,
                            const std::optional<JointVector>& near_rad = std::nullopt);

// The same in one posture, for following a way without changing it.
IkResult inverse_kinematics(const Arm& arm, IkPosture posture, const Vec3& tool_m, double roll_rad,
                            double limit_margin_rad = default_limit_margin_rad);

// The two rolls, half a turn apart, that lay the tool's y axis along a bar: fingers close along x, across it.
// `tilt_rad` is what remains between bar and tool y: the bar's angle out of the plane square to the approach axis.
struct BarRolls {
  std::array<double, 2> roll_rad{};
  double tilt_rad = 0;
};

// For a tool at slew, shoulder and elbow of `q_rad` and a bar along `bar` (base frame, any length). Nothing when the bar points along the
// approach axis within 0.2 rad, or is not a number.
std::optional<BarRolls> rolls_for_bar(const Arm& arm, const JointVector& q_rad, const Vec3& bar);

// Of the two rolls, the one from which the wrist can turn by `turn_rad` (of roll; either sign) and stay within `lower_rad` and `upper_rad`, the one that stays
// farther from them. Nothing when neither can.
std::optional<double> roll_for_turn(const BarRolls& rolls, double turn_rad, double lower_rad, double upper_rad);

}  // namespace lf::arm
