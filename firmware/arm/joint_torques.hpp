// The arm joints' torques of one SYNC, N m: the best estimates, and the bounds that they are surely within (transmission.hpp).
#pragma once

#include <algorithm>

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

struct JointTorques {
  JointVector nm = JointVector::Zero();
  JointVector low_nm = JointVector::Zero();
  JointVector high_nm = JointVector::Zero();

  JointTorques() = default;
  // Known exactly.
  JointTorques(const JointVector& exact_nm) : nm(exact_nm), low_nm(exact_nm), high_nm(exact_nm) {}  // NOLINT(google-explicit-constructor)

  bool finite() const { return nm.allFinite() && low_nm.allFinite() && high_nm.allFinite(); }
  // First-order low pass: the share of the newest.
  void follow(const JointTorques& newest, double share) {
    nm += (newest.nm - nm) * share;
    low_nm += (newest.low_nm - low_nm) * share;
    high_nm += (newest.high_nm - high_nm) * share;
  }
  // By how much a joint's torque surely differs from `base_nm`; 0 where it may be that.
  double sure_excess_nm(Eigen::Index joint, double base_nm) const {
    return std::max(0.0, low_nm[joint] - base_nm) + std::min(0.0, high_nm[joint] - base_nm);
  }
};

}  // namespace lf::arm
