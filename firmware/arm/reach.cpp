#include "firmware/arm/reach.hpp"

#include <cmath>

namespace lf::arm {

Reach reach(const Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double limit_margin_rad) {
  const IkResult ik = inverse_kinematics(arm, base_from_panel * panel_point_m, 0, limit_margin_rad);
  Reach reach{ik.outcome, ik.q_rad, 0};
  const Vec3 inward = -base_from_panel.linear().col(2);
  const Vec3 axis = arm.approach_axis(ik.q_rad);
  reach.tilt_rad = std::atan2(axis.cross(inward).norm(), axis.dot(inward));
  return reach;
}

}  // namespace lf::arm
