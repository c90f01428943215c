// The arm as its URDF tells it: links, joints, actuators, and the real joints' faults. Hosted side only; the core has numbers made of it (make_model.hpp).
//
// The URDF is plain and opens in any viewer; what URDF has no words for stands in <lanternfish:...> elements inside <joint>.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shared/arm/arm_model.hpp"
#include "shared/arm/joint_names.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/scene/scene.hpp"

namespace lf {

struct ArmLink {
  std::string name;
  double mass_kg = 0;       // in water the arm is trimmed: weight less buoyancy is `wet_weight_n`
  double wet_weight_n = 0;  // acts at the centre of mass, downward
  Pose link_from_com = Pose::Identity();
  Mat3 inertia_kg_m2 = Mat3::Identity();  // about the centre of mass, in its axes
  std::vector<scene::Shape> shapes;       // a URDF's visuals are drawn only, its collisions collide only
};

// Between motor and joint, nominal: what commissioning is to find. Shares of the motor's rated torque, and what of a load's torque gets through.
struct ArmFriction {
  double coulomb_share = 0;
  double viscous_share = 0;    // at the joint's top speed
  double efficiency = 1;       // the motor drives the load
  double back_efficiency = 1;  // the load drives the motor; 0 or less: it cannot
  bool stated = false;         // false: the file has no friction for this joint, and it moves without any
};

struct ArmJoint {
  std::string name;
  Pose parent_from_joint = Pose::Identity();
  Vec3 axis = Vec3::UnitZ();
  double lower_rad = 0, upper_rad = 0;
  double effort_nm = 0;        // what the motor's peak torque gives the joint: driving a load, where the actuator has the most lever
  double rated_torque_nm = 0;  // the same of its rated torque
  double velocity_rad_s = 0;   // the drive's top speed
  double acceleration_rad_s2 = 0;
  double stiction_rad_s = 0;     // asked of a joint that stands, it soon breaks the gear's friction; slower speeds take longer
  double backlash_rad = 0;       // total play
  double holding_torque_nm = 0;  // of the self-locking gear without power
  double stiffness_nm_rad = 0;   // by which links and gear give way under load; 0: the file does not say
  ArmActuator actuator;
  ArmFriction friction;
};

// Bodies in the order of scene::BodyId: base (vehicle), the arm's links, base to tip, finger_a, finger_b.
// Joint i moves body i + 1, whose parent is body i; finger_b hangs on the arm's last link and mimics finger_a (opening positive on both).
// The first joint's parent_from_joint carries the mount, base_from_arm: a body's pose is the product of parent_from_joint and the turn about `axis`, nothing else.
struct ArmDescription {
  std::vector<ArmLink> links;
  std::vector<ArmJoint>
      joints;  // the arm's, base to tip; where it rolls the last of them turns about the tool's axis. After them the jaw's
  bool rolls = true;
  ArmModel::Form form = ArmModel::Form::planar;
  ArmJoint finger_b;                        // mimic of the jaw joint
  Pose wrist_from_tool = Pose::Identity();  // the tool frame on the wrist body
  scene::Shape pad;                         // of finger_a: the box whose +x face holds
  std::vector<std::string> notes;           // of the file, with their lines: what is in it and is of no use

  std::size_t arm_joints() const { return joints.size() - 1; }
  const ArmJoint& last() const { return joints[joints.size() - 2]; }  // of the arm's
  // The tool at roll 0 on the link that carries the laser: the one before the roll, or the last where there is none.
  Pose laser_link_from_tool() const { return rolls ? last().parent_from_joint * wrist_from_tool : wrist_from_tool; }
  const ArmJoint& jaw() const { return joints.back(); }
  ArmJoint& jaw() { return joints.back(); }
  JointNames names() const;
};

// Reads and checks a URDF. Throws InputError with file and line: unreadable file, missing joint or link, limits that are not numbers or
// out of order, non-positive mass or effort, an inertia that is not positive definite, a chain that is not this arm's.
ArmDescription load_arm_urdf(const std::string& path);

}  // namespace lf
