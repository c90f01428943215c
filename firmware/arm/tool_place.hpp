// Joint angles for the tool at a place of its work, of arms of every form that jobs are planned for.
#pragma once

#include "firmware/arm/inverse_kinematics.hpp"

namespace lf::arm {

// Jobs are planned for arms of the planar form, and for those that can point their tool (pointing.hpp).
bool can_work(const Arm& arm);

// The tool point at `tool_m` with the given roll. An arm that can point has its approach axis along `approach` (base frame, any length) there; of the planar form
// the place itself makes the axis. Within the limits less `limit_margin_rad`, of several postures the one nearest to `near_rad`.
IkResult place_tool(const Arm& arm, const Vec3& tool_m, const Vec3& approach, double roll_rad, double limit_margin_rad,
                    const JointVector& near_rad);

// The same for a place beside the one where the tool is at `beside_rad`, in the same posture: the arm can go straight from one to the other.
IkResult place_tool_beside(const Arm& arm, const JointVector& beside_rad, const Vec3& tool_m, const Vec3& approach, double roll_rad,
                           double limit_margin_rad);

}  // namespace lf::arm
