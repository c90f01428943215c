// Which points in front of the panel the tool can work at, and how squarely.
#pragma once

#include "firmware/arm/inverse_kinematics.hpp"

namespace lf::arm {

struct Reach {
  IkOutcome outcome = IkOutcome::not_a_number;
  JointVector q_rad = JointVector::Zero();  // at roll 0
  double tilt_rad = 0;                      // between the approach axis and the panel's inward normal
};

// For a point in the panel frame (m) with the panel at `base_from_panel`.
Reach reach(const Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double limit_margin_rad = default_limit_margin_rad);

}  // namespace lf::arm
