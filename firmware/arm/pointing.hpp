// Arms that can point: of the chain form, with five joints or more beside a roll. The tool point and the direction of its approach axis are given, the roll is free.
//
// A roll turns the tool about its own axis, so that it has no part in either. An arm without one holds the tool as its joints turn it. Postures from anywhere come from the solvers of firmware/arm/chain, in closed form
// where the axes allow one. Close by, Newton's steps of least change lead there: along a straight way every tick takes one or two.
#pragma once

#include "firmware/arm/inverse_kinematics.hpp"
#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

inline constexpr std::size_t joints_to_point = 5;  // beside a roll
inline bool can_point(const Arm& arm) {
  return capacity::arm_joints > joints_to_point && !arm.is_planar() && arm.pointing_joints() >= joints_to_point;
}

// How its postures are found: the name of the closed form that its axes allow, or "numeric".
const char* family_of(const Arm& arm);

// Joint angles that put the tool point at `tool_m` with its approach axis along `approach` (base frame, any length), a roll at `roll_rad`, all of them inside
// their limits less `limit_margin_rad`: of the postures that were found the one nearest to `near_rad`. To 1e-9 m and rad.
// 10 us on a desktop in closed form; without one 30 us on the mean, and 1 ms where there is no such posture.
IkResult point_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                    const JointVector& near_rad);
// The same, and why where there is none: 5 ms.
IkResult point_tool_or_why(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                           const JointVector& near_rad);

// Takes the pointing joints from `q_rad` to where the tool is so placed, by steps of least change. False where that is not close by, or the arm is
// singular there: `q_rad` is then of no use. Limits play no part.
bool move_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, JointVector& q_rad);

// Whether the arm is at a posture, or within a degree of one, where the tool cannot be moved or turned some way: a straight line past it would swing joints about.
bool is_singular(const Arm& arm, const JointVector& q_rad);

// The least rates of the pointing joints that move the tool point by `way_m` a unit, its approach axis held. Not finite where the arm is singular.
JointVector tool_rates(const Arm& arm, const JointVector& q_rad, const Vec3& way_m);

}  // namespace lf::arm
