// Lets a gripping arm give way: what it holds may not be just where it was seen, and a rigid arm would force it there.
//
// An admittance of joints: a torque that has risen over what it was before the grip moves the joint's target the way it is pushed, at a speed in
// proportion, down to a dead band and up to a largest offset. The joints before the roll give way; the roll does the turning and does not.
#pragma once

#include <cstdint>

#include "firmware/arm/joint_torques.hpp"
#include "firmware/arm/kinematics.hpp"
#include "shared/messages/time.hpp"

namespace lf::arm {

struct ComplianceConfig {
  explicit ComplianceConfig(std::size_t arm_joints) : give_rad_s_nm(each_joint(arm_joints, 0.0015, 0)) {}

  // With 4000 N m/rad of drives and contact a load decays within 1 / (0.0015 * 4000) s = 0.17 s; loop and filter lag by 0.07 s.
  JointVector give_rad_s_nm;
  double dead_nm = 2;  // the drift of the torque's baseline moves nothing
  double largest_rad_s = 0.05;
  double largest_rad = 0.05;     // 20 mm at the elbow's 0.4 m
  double filter_s = 0.02;        // first-order low pass of the torque
  std::uint32_t learning = 25;   // samples averaged into the torque that is nobody's push: 0.1 s
  double largest_step_s = 0.02;  // a longer gap between samples, as after a hold, counts as this
};

class Compliance {
 public:
  explicit Compliance(const ComplianceConfig& config) : config_(config) {}

  // No offset, nothing learned.
  void reset() { *this = Compliance(config_); }

  // One SYNC's torques that the drives give the joints: positive drives the joint forward. What a torque has surely risen by, given its bounds, moves the joint. A sample with a value that is not a number is refused and counted,
  // and so is one not later than the one before.
  void update(Time t, const JointTorques& torque);

  // To be added to the joints' targets.
  const JointVector& offset_rad() const { return offset_rad_; }
  std::uint32_t refused() const { return refused_; }

 private:
  ComplianceConfig config_;
  Time last_;
  std::uint32_t samples_ = 0;
  std::uint32_t refused_ = 0;
  JointTorques filtered_;
  JointVector baseline_nm_ = JointVector::Zero();
  JointVector offset_rad_ = JointVector::Zero();
};

}  // namespace lf::arm
