// An independent judge of answers: KDL's forward kinematics on the URDF's numbers, and errors in its own words.
#pragma once

#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/jntarray.hpp>
#include <random>

#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {

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

// Seeded postures within a chain's limits.
class RandomPostures {
 public:
  RandomPostures(const Chain& chain, std::uint64_t seed) : chain_(chain), engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  JointValues next() {
    JointValues q = JointValues::Zero();
    for (std::size_t i = 0; i < chain_.size(); ++i)
      q[i] = chain_.joint(i).limited ? uniform(chain_.joint(i).lower, chain_.joint(i).upper) : uniform(-pi, pi);
    return q;
  }
  // Within `width` of `q` on each joint, and within the limits.
  JointValues near(const JointValues& q, double width) {
    JointValues out = q;
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      out[i] += uniform(-width, width);
      out[i] -= chain_.excess(i, out[i]);
    }
    return out;
  }

 private:
  Chain chain_;
  std::mt19937_64 engine_;
};

inline bool within_limits(const Chain& chain, const JointValues& q) {
  for (std::size_t i = 0; i < chain.size(); ++i)
    if (chain.excess(i, q[i]) != 0) return false;
  return q.tail(static_cast<Eigen::Index>(max_joints - chain.size())).isZero(0);
}

}  // namespace lf::chain
