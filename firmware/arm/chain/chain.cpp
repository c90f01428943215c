#include "firmware/arm/chain/chain.hpp"

#include <algorithm>
#include <cmath>

namespace lf::chain {
namespace {

constexpr double orthonormal = 1e-6;  // ten-digit rpy give 1e-10; a scaled or sheared matrix is far above
constexpr double turn_rad = 2 * pi;
constexpr double least_lever = 0.1;     // of the length
constexpr double rounding_rad = 1e-12;  // what adding whole turns makes of an angle at its limit

bool is_finite(const Pose& pose) { return pose.matrix().allFinite(); }

bool is_rotation(const Mat3& r) {
  return (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff() < orthonormal && r.determinant() > 0;
}

// A rotation that takes z to the unit vector `axis`.
Mat3 z_to(const Vec3& axis) {
  const Vec3 x = axis.unitOrthogonal();
  Mat3 r;
  r << x, axis.cross(x), axis;
  return r;
}

ChainFault check(const ChainJoint& joint) {
  if (!is_finite(joint.parent_from_joint) || !joint.axis.allFinite()) return ChainFault::not_a_number;
  if (joint.limited && !std::isfinite(joint.lower + joint.upper)) return ChainFault::not_a_number;
  if (!is_rotation(joint.parent_from_joint.linear())) return ChainFault::not_a_rotation;
  if (joint.axis.norm() < 1e-6) return ChainFault::no_axis;
  if (joint.limited && joint.lower > joint.upper) return ChainFault::limits_crossed;
  if (!joint.limited && joint.kind == JointKind::prismatic) return ChainFault::unlimited_prismatic;
  return ChainFault::none;
}

}  // namespace

const char* name(ChainFault fault) {
  switch (fault) {
    case ChainFault::none: return "none";
    case ChainFault::no_joint: return "no joint";
    case ChainFault::too_many_joints: return "too many joints";
    case ChainFault::not_a_number: return "not a number";
    case ChainFault::no_axis: return "no axis";
    case ChainFault::not_a_rotation: return "not a rotation";
    case ChainFault::limits_crossed: return "lower limit above upper";
    case ChainFault::unlimited_prismatic: return "slide without limits";
  }
  return "unknown";
}

ChainFault Chain::set(std::span<const ChainJoint> joints, const Pose& last_from_tool) {
  if (joints.empty()) return ChainFault::no_joint;
  if (joints.size() > max_joints) return ChainFault::too_many_joints;
  for (const ChainJoint& joint : joints) {
    const ChainFault fault = check(joint);
    if (fault != ChainFault::none) return fault;
  }
  if (!is_finite(last_from_tool)) return ChainFault::not_a_number;
  if (!is_rotation(last_from_tool.linear())) return ChainFault::not_a_rotation;

  *this = Chain();
  size_ = joints.size();
  Mat3 link_from_aligned = Mat3::Identity();  // of the link before
  bool turns = false;                         // this joint or one before
  for (std::size_t i = 0; i < size_; ++i) {
    ChainJoint& joint = joints_[i];
    joint = joints[i];
    joint.axis.normalize();
    const Mat3 aligned = z_to(joint.axis);
    steps_[i].rotation = link_from_aligned.transpose() * joint.parent_from_joint.linear() * aligned;
    steps_[i].translation_m = link_from_aligned.transpose() * joint.parent_from_joint.translation();
    aligned_from_link_[i] = aligned.transpose();
    link_from_aligned = aligned;
    full_turn_[i] = joint.kind == JointKind::revolute && (!joint.limited || joint.upper - joint.lower >= turn_rad - 1e-9);
    const bool slides = joint.kind == JointKind::prismatic;
    const double part_m =
        (i > 0 ? joint.parent_from_joint.translation().norm() : 0) + (slides ? std::max(std::abs(joint.lower), std::abs(joint.upper)) : 0);
    length_m_ += part_m;
    if (turns) lever_m_ += part_m;
    turns = turns || !slides;
  }
  tool_.rotation = link_from_aligned.transpose() * last_from_tool.linear();
  tool_.translation_m = link_from_aligned.transpose() * last_from_tool.translation();
  length_m_ += last_from_tool.translation().norm();
  length_m_ = std::max(length_m_, 1e-3);  // a pan-tilt head without a tool still divides by it
  if (turns) lever_m_ += last_from_tool.translation().norm();
  lever_m_ = std::max(lever_m_, least_lever * length_m_);
  for (std::size_t i = 0; i < size_; ++i)
    if (joints_[i].kind == JointKind::prismatic) weights_[i] = 1 / lever_m_;
  return ChainFault::none;
}

JointValues Chain::middle() const {
  JointValues q = JointValues::Zero();
  for (std::size_t i = 0; i < size_; ++i) q[i] = joints_[i].limited ? (joints_[i].lower + joints_[i].upper) / 2 : 0;
  return q;
}

void Chain::move(std::size_t i, double value, Frame& frame) const {
  frame.origin_m += frame.rotation * steps_[i].translation_m;
  frame.rotation = (frame.rotation * steps_[i].rotation).eval();
  if (joints_[i].kind == JointKind::prismatic) {
    frame.origin_m += value * frame.rotation.col(2);
    return;
  }
  const double c = std::cos(value);
  const double s = std::sin(value);
  const Vec3 x = frame.rotation.col(0);
  const Vec3 y = frame.rotation.col(1);
  frame.rotation.col(0) = c * x + s * y;
  frame.rotation.col(1) = c * y - s * x;
}

void Chain::evaluate(const JointValues& q, ChainState& state) const {
  Frame frame;
  for (std::size_t i = 0; i < size_; ++i) {
    move(i, q[i], frame);
    state.axis[i] = frame.rotation.col(2);
    state.point_m[i] = frame.origin_m;
  }
  state.tool_m = frame.origin_m + frame.rotation * tool_.translation_m;
  state.tool = frame.rotation * tool_.rotation;
}

Pose Chain::base_from_tool(const JointValues& q) const {
  ChainState state;
  evaluate(q, state);
  Pose pose = Pose::Identity();
  pose.linear() = state.tool;
  pose.translation() = state.tool_m;
  return pose;
}

std::array<Pose, max_joints> Chain::base_from_links(const JointValues& q) const {
  std::array<Pose, max_joints> links;
  links.fill(Pose::Identity());
  Frame frame;
  for (std::size_t i = 0; i < size_; ++i) {
    move(i, q[i], frame);
    links[i].linear() = frame.rotation * aligned_from_link_[i];
    links[i].translation() = frame.origin_m;
  }
  return links;
}

Jacobian Chain::jacobian(const JointValues& q) const {
  ChainState state;
  evaluate(q, state);
  Jacobian j = Jacobian::Zero();
  for (std::size_t i = 0; i < size_; ++i) {
    if (joints_[i].kind == JointKind::prismatic) {
      j.col(i).head<3>() = state.axis[i];
      continue;
    }
    j.col(i).head<3>() = state.axis[i].cross(state.tool_m - state.point_m[i]);
    j.col(i).tail<3>() = state.axis[i];
  }
  return j;
}

double Chain::excess(std::size_t i, double value) const {
  const ChainJoint& joint = joints_[i];
  if (!joint.limited) return 0;
  if (value > joint.upper) return value - joint.upper;
  return value < joint.lower ? value - joint.lower : 0;
}

double Chain::drawn_in(std::size_t i, double value) const {
  return joints_[i].limited ? std::clamp(value, joints_[i].lower, joints_[i].upper) : value;
}

JointValues Chain::unwound(const JointValues& q, const JointValues& near) const {
  JointValues out = q;
  for (std::size_t i = 0; i < size_; ++i) {
    if (joints_[i].kind == JointKind::prismatic || (!full_turn_[i] && excess(i, q[i]) == 0)) continue;
    const double turns = std::round((near[i] - q[i]) / turn_rad);
    out[i] = q[i] + turn_rad * turns;
    const double past = excess(i, out[i]);
    if (past == 0) continue;
    // Back inside by whole turns, if that is possible; else the side that it passes less.
    const double back = std::ceil((std::abs(past) - rounding_rad) / turn_rad);
    const double other = q[i] + turn_rad * (turns - std::copysign(back, past));
    if (std::abs(excess(i, other)) < std::abs(past)) out[i] = other;
    if (std::abs(excess(i, out[i])) < rounding_rad) out[i] = drawn_in(i, out[i]);
  }
  return out;
}

double Chain::travel_rad(const JointValues& from, const JointValues& to) const {
  double travel = 0;
  for (std::size_t i = 0; i < size_; ++i) travel = std::max(travel, weights_[i] * std::abs(to[i] - from[i]));
  return travel;
}

}  // namespace lf::chain
