// An independent judge of answers: KDL's forward kinematics on the URDF's numbers, and errors in its own words.
#pragma once

#include <algorithm>
#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/jntarray.hpp>

#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {

// KDL's chain of the file, built as kdl_parser does; its tool frame is the file's own.
inline KDL::Chain kdl_chain_of(const RealArm& arm) {
  using KDL::Joint;
  KDL::Chain chain;
  for (const UrdfJoint& j : arm.joints) {
    const KDL::Frame origin(KDL::Rotation::RPY(j.rpy.x(), j.rpy.y(), j.rpy.z()), KDL::Vector(j.xyz.x(), j.xyz.y(), j.xyz.z()));
    if (j.kind == UrdfJoint::Kind::fixed) {
      chain.addSegment(KDL::Segment(Joint(Joint::Fixed), origin));
      continue;
    }
    const KDL::Vector axis = origin.M * KDL::Vector(j.axis.x(), j.axis.y(), j.axis.z());
    const Joint::JointType type = j.kind == UrdfJoint::Kind::prismatic ? Joint::TransAxis : Joint::RotAxis;
    chain.addSegment(KDL::Segment(Joint(origin.p, axis, type), origin));
  }
  return chain;
}

class Referee {
 public:
  explicit Referee(const RealArm& arm) : arm_(arm), chain_(kdl_chain_of(arm)), fk_(chain_) {}

  const KDL::Chain& chain() const { return chain_; }
  KDL::JntArray joints(const JointValues& q) const {
    KDL::JntArray out(chain_.getNrOfJoints());
    out.data = q.head(static_cast<Eigen::Index>(chain_.getNrOfJoints()));
    return out;
  }
  // The file's own tool frame.
  Pose raw_tool(const JointValues& q) {
    KDL::Frame frame;
    if (fk_.JntToCart(joints(q), frame) < 0) throw std::runtime_error("KDL: " + arm_.name);
    return pose_of(frame);
  }
  // With z the approach axis and x the opening axis.
  Pose tool(const JointValues& q) { return *tool_with_axes(raw_tool(q), arm_.approach, arm_.opening); }

  static Pose pose_of(const KDL::Frame& frame) {
    Pose pose = Pose::Identity();
    for (int r = 0; r < 3; ++r) {
      pose.translation()[r] = frame.p[r];
      for (int c = 0; c < 3; ++c) pose.linear()(r, c) = frame.M(r, c);
    }
    return pose;
  }

  // True when the posture does what the task asks, to the task's tolerances or `least`: in KDL's kinematics and by angles of Eigen's.
  bool fulfils(const IkTask& task, const JointValues& q, double least = 1e-5) {
    const Pose at = tool(q);
    const Mat3& want = task.base_from_tool.linear();
    if ((at.translation() - task.base_from_tool.translation()).norm() > std::max(least, task.position_tolerance_m)) return false;
    const double tilt = Eigen::Quaterniond::FromTwoVectors(at.linear().col(2), want.col(2)).angularDistance(Eigen::Quaterniond::Identity());
    if (task.axis && tilt > std::max(least, task.axis_tolerance_rad)) return false;
    if (!task.roll) return true;
    // Square to the bar, and not the other way round.
    const Vec3 bar = want.col(1) - want.col(1).dot(at.linear().col(2)) * at.linear().col(2);
    const double off = std::acos(std::clamp(bar.normalized().dot(at.linear().col(1)), -1.0, 1.0));
    return off <= std::max(std::max(least, 1e-7), task.roll_tolerance_rad);
  }

 private:
  RealArm arm_;
  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive fk_;
};

}  // namespace lf::chain
