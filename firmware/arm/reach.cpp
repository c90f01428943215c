#include "firmware/arm/reach.hpp"

#include <cmath>

#include "firmware/arm/tool_place.hpp"

namespace lf::arm {

Reach reach(const Arm& arm, const Pose& base_from_panel, const Vec3& panel_point_m, double limit_margin_rad, const JointVector& near_rad) {
  const Vec3 tool_m = base_from_panel * panel_point_m, inward = -base_from_panel.linear().col(2);
  const IkResult ik = arm.is_planar() ? inverse_kinematics(arm, tool_m, 0, limit_margin_rad)
                                      : place_tool(arm, tool_m, inward, 0, limit_margin_rad, near_rad);
  Reach reach{ik.outcome, ik.q_rad, 0};
  const Vec3 axis = arm.approach_axis(ik.q_rad);
  reach.tilt_rad = std::atan2(axis.cross(inward).norm(), axis.dot(inward));
  return reach;
}

}  // namespace lf::arm
