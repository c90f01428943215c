// Which points in front of the panel the tool can work at, and how squarely.
#pragma once

#include "firmware/arm/inverse_kinematics.hpp"

namespace lf::arm {

struct Reach {
  IkOutcome outcome = IkOutcome::not_a_number;
  JointVector q_rad = JointVector::Zero();  // at roll 0
  double tilt_rad = 0;                      // between the approach axis and the panel's inward normal
};

// For a point in the panel frame (m) with the panel at `base_from_panel`. Of an arm that can point its tool the posture is the one nearest to `near_rad`, of the
// planar form the one farthest from its limits.
Reach reach(const Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double limit_margin_rad = default_limit_margin_rad,
            const JointVector& near_rad = JointVector::Zero());

}  // namespace lf::arm
