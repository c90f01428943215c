// The arm in KDL, an independent implementation: from the published DH table, not from the URDF.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/jntarray.hpp>

#include "firmware/arm/kinematics.hpp"

namespace lf::arm {

inline KDL::Chain kdl_arm() {
  using KDL::Frame;
  using KDL::Joint;
  using KDL::Segment;
  KDL::Chain chain;
  chain.addSegment(Segment(Joint(Joint::Fixed), Frame(KDL::Rotation::RotZ(M_PI))));
  chain.addSegment(Segment(Joint(Joint::RotZ), Frame::DH(0.08052, M_PI_2, 0, 0)));
  chain.addSegment(Segment(Joint(Joint::RotZ), Frame::DH(0.44278, 0, 0, 0.139277)));
  chain.addSegment(Segment(Joint(Joint::RotZ), Frame::DH(-0.083, M_PI_2, 0, 1.972222)));
  chain.addSegment(Segment(Joint(Joint::RotZ), Frame::DH(0, 0, 0.34407 + 0.1485, 0)));
  return chain;
}

inline KDL::JntArray kdl_joints(const JointVector& q_rad) {
  KDL::JntArray q(4);
  q.data = q_rad.head<4>();
  return q;
}

}  // namespace lf::arm
