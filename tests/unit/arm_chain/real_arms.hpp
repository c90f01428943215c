// The five arms of the project's reference as chains: the numbers of their URDFs, written by hand.
//
// Oberon 7 (Apache-2.0), Kraft Predator mock-up (Apache-2.0), UR5 (BSD-3), Franka Panda (Apache-2.0) and OpenMANIPULATOR-X (Apache-2.0): facts of
// their makers' files. Fixed joints before and after a moving one are multiplied in.
#pragma once

#include <string>
#include <vector>

#include "firmware/arm/chain/ik_task.hpp"

namespace lf::chain {

// A joint as URDF has it: origin xyz and rpy, axis, limits. Fixed joints are those of kind `fixed`.
struct UrdfJoint {
  enum class Kind : std::uint8_t { revolute, continuous, prismatic, fixed };
  Kind kind = Kind::revolute;
  Vec3 xyz, rpy;
  Vec3 axis = Vec3::UnitZ();
  double lower = 0, upper = 0;
};

struct RealArm {
  std::string name;
  std::vector<UrdfJoint> joints;
  // Which of the tool's axes approaches and which opens.
  FrameAxis approach = FrameAxis::z, opening = FrameAxis::x;
};

inline Pose pose_of(const Vec3& xyz, const Vec3& rpy) {
  Pose pose = Pose::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) * Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()))
          .toRotationMatrix();
  pose.translation() = xyz;
  return pose;
}

// With `raw_tool` the tool's frame is the file's own; without, its z approaches and its x opens.
inline Chain chain_of(const RealArm& arm, bool raw_tool = false) {
  std::vector<ChainJoint> joints;
  Pose fixed = Pose::Identity();
  for (const UrdfJoint& j : arm.joints) {
    fixed = fixed * pose_of(j.xyz, j.rpy);
    if (j.kind == UrdfJoint::Kind::fixed) continue;
    ChainJoint joint;
    joint.kind = j.kind == UrdfJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
    joint.parent_from_joint = fixed;
    joint.axis = j.axis;
    joint.lower = j.lower;
    joint.upper = j.upper;
    joint.limited = j.kind != UrdfJoint::Kind::continuous;
    joints.push_back(joint);
    fixed = Pose::Identity();
  }
  Chain chain;
  const Pose tool = raw_tool ? fixed : *tool_with_axes(fixed, arm.approach, arm.opening);
  chain.set(joints, tool);  // of size 0 on a fault, which no test survives
  return chain;
}

inline RealArm oberon7() {
  constexpr double right = 1.57079632679;
  return {"oberon7",
          {{UrdfJoint::Kind::revolute, {0, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -1.04719758, 1.04719758},
           {UrdfJoint::Kind::revolute, {0.06955, 0.00015, 0.01536}, {right, 0, 0}, Vec3::UnitZ(), -1.57079637, 1.57079637},
           {UrdfJoint::Kind::revolute, {0.55616, -0.01229, 0}, {0, 0, 0}, Vec3::UnitZ(), -1.57079637, 1.04719758},
           {UrdfJoint::Kind::revolute, {0.1349014, -0.1936267, 0}, {right, 0, 0}, Vec3::UnitZ(), -2.356194555, 2.356194555},
           {UrdfJoint::Kind::revolute, {0, 0, 0.31595760629823427}, {-right, -right, 0}, Vec3::UnitZ(), -1.57079637, 1.57079637},
           {UrdfJoint::Kind::continuous, {0.19304, 0, 0}, {0, 0, 0}, Vec3::UnitX()},
           {UrdfJoint::Kind::fixed, {0.16, 0, 0}, {0, 1.5707963267948966, 0}}}};
}

inline RealArm predator() {
  return {"predator",
          {{UrdfJoint::Kind::revolute, {0, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -1.04719758, 1.04719758},
           {UrdfJoint::Kind::revolute, {0.200369, 0, 0.209467}, {1.5707963267948966, 0, 0}, Vec3::UnitZ(), -1.57079637, 1.57079637},
           {UrdfJoint::Kind::revolute, {0.87315, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -1.57079637, 1.04719758},
           {UrdfJoint::Kind::revolute, {0.11275, -0.55503, 0}, {0, 0, -1.57079632679}, Vec3::UnitZ(), -2.356194555, 2.356194555},
           {UrdfJoint::Kind::revolute, {0.12137, -0.00038, 0}, {1.5707963267948966, 0, 0}, Vec3::UnitZ(), -6.283185307, 6.283185307},
           {UrdfJoint::Kind::fixed, {0.34, 0, -0.017121}, {0, 1.5707963267948966, 0}}}};
}

inline RealArm ur5() {
  constexpr double turn = 6.283185307179586;
  constexpr double right = 1.5707963267948966;
  return {"ur5",
          {{UrdfJoint::Kind::fixed, {0, 0, 0}, {0, 0, 3.141592653589793}},
           {UrdfJoint::Kind::revolute, {0, 0, 0.089159}, {0, 0, 0}, Vec3::UnitZ(), -turn, turn},
           {UrdfJoint::Kind::revolute, {0, 0, 0}, {1.570796327, 0, 0}, Vec3::UnitZ(), -turn, turn},
           {UrdfJoint::Kind::revolute, {-0.425, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -turn / 2, turn / 2},
           {UrdfJoint::Kind::revolute, {-0.39225, 0, 0.10915}, {0, 0, 0}, Vec3::UnitZ(), -turn, turn},
           {UrdfJoint::Kind::revolute, {0, -0.09465, -1.941303950897609e-11}, {1.570796327, 0, 0}, Vec3::UnitZ(), -turn, turn},
           {UrdfJoint::Kind::revolute,
            {0, 0.0823, -1.688001216681175e-11},
            {1.570796326589793, 3.141592653589793, 3.141592653589793},
            Vec3::UnitZ(),
            -turn,
            turn},
           {UrdfJoint::Kind::fixed, {0, 0, 0}, {0, -right, -right}},
           {UrdfJoint::Kind::fixed, {0, 0, 0}, {right, 0, right}}}};
}

inline RealArm panda() {
  constexpr double right = 1.57079632679;
  return {"panda",
          {{UrdfJoint::Kind::revolute, {0, 0, 0.333}, {0, 0, 0}, Vec3::UnitZ(), -2.8973, 2.8973},
           {UrdfJoint::Kind::revolute, {0, 0, 0}, {-right, 0, 0}, Vec3::UnitZ(), -1.7628, 1.7628},
           {UrdfJoint::Kind::revolute, {0, -0.316, 0}, {right, 0, 0}, Vec3::UnitZ(), -2.8973, 2.8973},
           {UrdfJoint::Kind::revolute, {0.0825, 0, 0}, {right, 0, 0}, Vec3::UnitZ(), -3.0718, -0.0698},
           {UrdfJoint::Kind::revolute, {-0.0825, 0.384, 0}, {-right, 0, 0}, Vec3::UnitZ(), -2.8973, 2.8973},
           {UrdfJoint::Kind::revolute, {0, 0, 0}, {right, 0, 0}, Vec3::UnitZ(), -0.0175, 3.7525},
           {UrdfJoint::Kind::revolute, {0.088, 0, 0}, {right, 0, 0}, Vec3::UnitZ(), -2.8973, 2.8973},
           {UrdfJoint::Kind::fixed, {0, 0, 0.107}, {0, 0, 0}},
           {UrdfJoint::Kind::fixed, {0, 0, 0}, {0, 0, -0.785398163397}},
           {UrdfJoint::Kind::fixed, {0, 0, 0.1034}, {0, 0, 0}}}};
}

inline RealArm open_manipulator_x() {
  return {"open_manipulator_x",
          {{UrdfJoint::Kind::revolute, {0.012, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -3.141592653589793, 3.141592653589793},
           {UrdfJoint::Kind::revolute, {0, 0, 0.0595}, {0, 0, 0}, Vec3::UnitY(), -1.5, 1.5},
           {UrdfJoint::Kind::revolute, {0.024, 0, 0.128}, {0, 0, 0}, Vec3::UnitY(), -1.5, 1.4},
           {UrdfJoint::Kind::revolute, {0.124, 0, 0}, {0, 0, 0}, Vec3::UnitY(), -1.7, 1.97},
           {UrdfJoint::Kind::fixed, {0.126, 0, 0}, {0, 0, 0}}},
          FrameAxis::x,
          FrameAxis::y};
}

inline std::vector<RealArm> real_arms() { return {oberon7(), predator(), ur5(), panda(), open_manipulator_x()}; }

}  // namespace lf::chain
