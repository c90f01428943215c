// The arm's plane for given joint angles, as the closed forms use it. Internal to the arm's kinematics.
#pragma once

#include <cmath>

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

// The arm's plane and the forearm's direction in it, for slew, shoulder and elbow.
struct PlanarChain {
  PlanarChain(const ArmModel::Planar& n, const JointVector& q_rad) {
    const double psi = q_rad[0] + n.mount_yaw_rad;
    const double beta = q_rad[1] + n.shoulder_offset_rad;
    const double gamma = beta + q_rad[2] + n.elbow_offset_rad;
    cos_psi = std::cos(psi);
    sin_psi = std::sin(psi);
    elbow_r_m = n.a0_m + n.a1_m * std::cos(beta);
    elbow_z_m = n.a1_m * std::sin(beta);
    cos_gamma = std::cos(gamma);
    sin_gamma = std::sin(gamma);
    tool_r_m = elbow_r_m + n.a2_m * cos_gamma + n.d_m * sin_gamma;
    tool_z_m = elbow_z_m + n.a2_m * sin_gamma - n.d_m * cos_gamma;
  }

  // A vector of the arm's plane in the base frame.
  Vec3 in_base(double r, double z) const { return {cos_psi * r, sin_psi * r, z}; }
  // Square to the plane: the axis of shoulder and elbow, and the tool's y at roll 0.
  Vec3 across() const { return {sin_psi, -cos_psi, 0}; }
  Vec3 tool_x() const { return in_base(cos_gamma, sin_gamma); }  // at roll 0
  Vec3 tool_z() const { return in_base(sin_gamma, -cos_gamma); }
  Vec3 tool() const { return in_base(tool_r_m, tool_z_m); }

  double cos_psi, sin_psi, cos_gamma, sin_gamma;
  double elbow_r_m, elbow_z_m, tool_r_m, tool_z_m;
};

}  // namespace lf::arm
