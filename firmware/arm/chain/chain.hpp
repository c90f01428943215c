// An arm as data: a chain of up to eight revolute or prismatic joints, held by value.
//
// Every origin is a pose on the link before, at joint value 0, and every axis is given in its joint's own frame, as URDF has them. When the
// chain is made, each joint's frame is turned so that its axis is z. Motion is then a rotation of two columns, and forward kinematics of six joints
// takes six sines and cosines and six products of 3x3 matrices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/geometry/pose.hpp"

namespace lf::chain {

// Seven is the most that arms on the market have; one more for a rail.
inline constexpr std::size_t max_joints = 8;

// One value a joint: rad, or m where it is prismatic. Those past the chain's number of joints are 0.
using JointValues = Eigen::Matrix<double, max_joints, 1>;
// Linear velocity of the tool point (m/s) above angular velocity (rad/s), both in the base frame, per unit of each joint's speed.
using Jacobian = Eigen::Matrix<double, 6, max_joints>;

enum class JointKind : std::uint8_t { revolute, prismatic };

struct ChainJoint {
  JointKind kind = JointKind::revolute;
  Pose parent_from_joint = Pose::Identity();
  Vec3 axis = Vec3::UnitZ();  // any length but 0
  double lower = 0, upper = 0;
  bool limited = true;  // false: a continuous joint, `lower` and `upper` do not matter
};

enum class ChainFault : std::uint8_t {
  none,
  no_joint,
  too_many_joints,
  not_a_number,
  no_axis,              // shorter than 1e-6
  not_a_rotation,       // an origin's matrix is not orthonormal to 1e-6
  limits_crossed,       // lower above upper
  unlimited_prismatic,  // a slide has ends
};
const char* name(ChainFault fault);

// Where the joints and the tool are for one set of joint values, base frame.
struct ChainState {
  std::array<Vec3, max_joints> axis;     // unit
  std::array<Vec3, max_joints> point_m;  // on the axis
  Mat3 tool;                             // base_from_tool's rotation
  Vec3 tool_m;
};

class Chain {
 public:
  // Takes joints from base to tip and the tool's pose on the last link. On a fault the chain is left as it was.
  ChainFault set(std::span<const ChainJoint> joints, const Pose& last_from_tool);

  std::size_t size() const { return size_; }
  const ChainJoint& joint(std::size_t i) const { return joints_[i]; }
  // No tool point is farther than this from the first joint's origin: the origins' and the tool's distances and the slides' strokes added up.
  // The first origin does not count.
  double length_m() const { return length_m_; }
  // No revolute joint has the tool point farther from its axis: length_m() without what lies before the first of them. At least a tenth of length_m(), so
  // that on a gantry with a short wrist, or with none, not every stroke is a long way.
  double lever_m() const { return lever_m_; }
  // What makes joints comparable, per unit of each: 1 where a joint turns, 1 / lever_m() where it slides.
  const JointValues& weights() const { return weights_; }
  // The middle of each joint's range; 0 where it has none.
  JointValues middle() const;
  // True where a full turn lies within the range, so that the joint reaches every angle.
  bool full_turn(std::size_t i) const { return full_turn_[i]; }

  // O(size), no allocation. `state` is filled for the first size() joints.
  void evaluate(const JointValues& q, ChainState& state) const;
  Pose base_from_tool(const JointValues& q) const;
  // base_from_link of each link that a joint moves, base to tip; identity beyond the last.
  std::array<Pose, max_joints> base_from_links(const JointValues& q) const;
  // Geometric Jacobian of the tool point; columns past the last joint are 0.
  Jacobian jacobian(const JointValues& q) const;

  // How far `value` is past joint i's limits: 0 inside, negative below, positive above.
  double excess(std::size_t i, double value) const;
  // `value` drawn to the nearest end of joint i's range, and exactly there.
  double drawn_in(std::size_t i, double value) const;
  // The same posture with each revolute joint turned by whole turns to where it is nearest to `near` within its limits. Where no whole turn is within the
  // limits it is the one that passes them least.
  JointValues unwound(const JointValues& q, const JointValues& near) const;
  // The largest travel of a joint between two postures, rad. A slide's is divided by lever_m(): then it moves the tool point as far as so many rad of the
  // joint with the longest lever. Whatever the joints are, the tool point moves by at most size() * lever_m() times this.
  double travel_rad(const JointValues& from, const JointValues& to) const;

 private:
  // The fixed part before a joint, in frames whose z is the joint's axis.
  struct Step {
    Mat3 rotation = Mat3::Identity();
    Vec3 translation_m = Vec3::Zero();
  };
  struct Frame {
    Mat3 rotation = Mat3::Identity();
    Vec3 origin_m = Vec3::Zero();
  };
  void move(std::size_t i, double value, Frame& frame) const;

  std::array<ChainJoint, max_joints> joints_{};
  std::array<Step, max_joints> steps_{};
  std::array<Mat3, max_joints> aligned_from_link_{};  // turns a link's own frame into the one whose z is its axis
  Step tool_;
  std::array<bool, max_joints> full_turn_{};
  std::size_t size_ = 0;
  double length_m_ = 0;
  double lever_m_ = 0;
  JointValues weights_ = JointValues::Ones();
};

}  // namespace lf::chain
