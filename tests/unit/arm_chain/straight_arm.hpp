// A six-joint arm whose geometry is known by heart: yaw and pitch at the shoulder, pitch at the elbow, a spherical wrist at the forearm's end, no
// offsets. At joint values 0 it is stretched along x.
#pragma once

#include <array>

#include "firmware/arm/chain/chain.hpp"

namespace lf::chain {

class StraightArm {
 public:
  explicit StraightArm(double upper_m = 0.5, double fore_m = 0.4, double hand_m = 0.1, double limit_rad = 3)
      : upper_m_(upper_m), fore_m_(fore_m), hand_m_(hand_m), limit_rad_(limit_rad) {}

  // The tool point's farthest distance from the shoulder.
  double reach_m() const { return upper_m_ + fore_m_ + hand_m_; }
  Vec3 shoulder_m() const { return {0, 0, 0.3}; }

  Chain chain() const {
    const auto joint = [this](const Vec3& origin, const Vec3& axis) {
      ChainJoint j;
      j.parent_from_joint.translation() = origin;
      j.axis = axis;
      j.lower = -limit_rad_;
      j.upper = limit_rad_;
      return j;
    };
    const Vec3 none = Vec3::Zero();
    const std::array joints{joint(shoulder_m(), Vec3::UnitZ()),    joint(none, Vec3::UnitY()), joint({upper_m_, 0, 0}, Vec3::UnitY()),
                            joint({fore_m_, 0, 0}, Vec3::UnitX()), joint(none, Vec3::UnitY()), joint(none, Vec3::UnitX())};
    Pose tool = Pose::Identity();
    tool.translation().x() = hand_m_;
    tool.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // z forward
    Chain chain;
    chain.set(joints, tool);
    return chain;
  }

 private:
  double upper_m_, fore_m_, hand_m_, limit_rad_;
};

}  // namespace lf::chain
