// An arm held by value, and where its parts are for given joint angles, in closed form.
//
// Of an arm of any form: from joint to joint along the chain. Of the planar form:
// The slew turns a vertical plane about base z; shoulder and elbow move within that plane; the roll axis lies in it. So a pose is a planar sum:
// with psi = slew + mount yaw, e = (cos psi, sin psi, 0), beta = shoulder + its offset, gamma = beta + elbow + its offset,
//   elbow = (a0 + a1 cos beta) e + (a1 sin beta) z,   tool = elbow + a2 (cos gamma e + sin gamma z) + d (sin gamma e - cos gamma z).
#pragma once

#include <array>
#include <cstddef>

#include "shared/arm/arm_model.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::arm {

// One row for each of the arm's joints, base to tip, in radians (or rad/s, rad/s^2 where so named). Rows past an arm's own joints are 0.
using JointVector = Eigen::Matrix<double, capacity::arm_joints, 1>;
// Of an arm of this form.
inline JointVector planar_joints(double slew_rad, double shoulder_rad, double elbow_rad, double roll_rad) {
  JointVector all = JointVector::Zero();
  all.head<4>() << slew_rad, shoulder_rad, elbow_rad, roll_rad;
  return all;
}
// Of an arm of so many joints: `pointing` for those that point the tool, and `roll` for the last where that one rolls it.
inline JointVector each_joint(std::size_t arm_joints, double pointing, double roll, bool rolls = true) {
  JointVector all = JointVector::Zero();
  for (std::size_t i = 0; i < arm_joints; ++i) all[static_cast<Eigen::Index>(i)] = rolls && i + 1 == arm_joints ? roll : pointing;
  return all;
}
// Linear velocity of the tool point (m/s) above angular velocity (rad/s), both in the base frame, per rad/s of each joint.
using Jacobian = Eigen::Matrix<double, 6, capacity::arm_joints>;

// base_from_link of the arm's links, base to tip, then of finger_a and finger_b.
using LinkPoses = std::array<Pose, ArmModel::max_links>;

// A link's outline for clearances, in the base frame: all points within `radius_m` of the segment a-b. Contains the link's collision shape.
struct Capsule {
  std::size_t link;  // its scene::BodyId: 1 slew .. 6 finger_b
  Vec3 a_m, b_m;
  double radius_m;
};

// Of one pose. Without a value beyond its size: a pose is asked for every microsecond, and most of the room is not used.
class LinkCapsules {
 public:
  // Of an arm with so many joints that place the tool: links beyond are fingers.
  explicit LinkCapsules(std::size_t arm_joints = 4, bool rolls = true)
      : arm_joints_(arm_joints), rolls_(rolls) {}  // items_ stays as it is: setting it to zero would take its time

  std::size_t arm_joints() const { return arm_joints_; }
  bool rolls() const { return rolls_; }

  std::size_t size() const { return size_; }
  const Capsule& operator[](std::size_t i) const { return items_[i]; }
  const Capsule* begin() const { return items_.data(); }
  const Capsule* end() const { return items_.data() + size_; }
  void push_back(const Capsule& capsule) {  // of a model's capsules, which are no more than there is room for
    if (size_ < items_.size()) items_[size_++] = capsule;
  }

 private:
  std::array<Capsule, capacity::arm_shapes> items_;
  std::size_t size_ = 0;
  std::size_t arm_joints_;
  bool rolls_;
};

// What each joint may do; by default what the arm can.
struct JointLimits {
  std::size_t joints = 0;  // whose rows count
  JointVector lower_rad = JointVector::Zero(), upper_rad = JointVector::Zero();
  JointVector velocity_rad_s = JointVector::Zero(), acceleration_rad_s2 = JointVector::Zero(), jerk_rad_s3 = JointVector::Zero();
};

class Arm {
 public:
  // Whoever makes the model has checked it: lengths of upper arm and forearm above 0, limits in order, screws that close their triangle.
  explicit Arm(const ArmModel& model);

  const ArmModel& model() const { return model_; }
  bool is_planar() const { return model_.form == ArmModel::Form::planar; }
  const ArmModel::Planar& planar() const { return model_.planar; }  // of that form
  const ArmModel::Joint& joint(std::size_t i) const { return model_.joints[i]; }
  // Those that place the tool, and all, the jaw's too.
  std::size_t arm_joints() const { return model_.arm_joints; }
  std::size_t joint_count() const { return model_.joint_count(); }
  bool rolls() const { return model_.rolls; }
  std::size_t roll_joint() const { return model_.arm_joints - 1; }  // of an arm that rolls
  // Those that place the tool point and turn the tool's axis: the first so many.
  std::size_t pointing_joints() const { return model_.arm_joints - (model_.rolls ? 1 : 0); }
  Vec3 tool_on_last_m() const { return rolls() ? Vec3(0, 0, model_.tool_z_m) : Vec3(model_.last_from_tool().translation()); }
  // About the tool's own axis: 0 on an arm without a roll, whose tool stays as its joints turn it.
  double roll_rad(const JointVector& q_rad) const { return rolls() ? q_rad[static_cast<Eigen::Index>(roll_joint())] : 0; }
  void set_roll(JointVector& q_rad, double roll_rad) const {
    if (rolls()) q_rad[static_cast<Eigen::Index>(roll_joint())] = roll_rad;
  }
  std::size_t jaw_joint() const { return model_.arm_joints; }
  std::size_t link_count() const { return model_.joint_count() + 1; }  // that move
  const ArmModel::Jaw& jaw() const { return model_.jaw; }
  // From the elbow straight to the tool point, of the planar form.
  struct Forearm {
    double length_squared_m2 = 0, length_m = 0;
    double angle_rad = 0;  // from the forearm's own x direction
  };
  const Forearm& forearm() const { return forearm_; }

  // The tool frame in the base frame.
  Pose base_from_tool(const JointVector& q_rad) const;
  // The tool axis (tool z) in the base frame; it does not depend on a roll.
  Vec3 approach_axis(const JointVector& q_rad) const;
  // The tool frame at roll 0: what the pointing joints make of it.
  Pose base_from_unrolled_tool(const JointVector& q_rad) const;
  // The laser, given in the tool frame at roll 0 and carried by the pointing joints: a roll in `q_rad` is ignored.
  Pose base_from_laser(const JointVector& q_rad, const LaserCalibration& laser) const;
  // Geometric Jacobian of the tool point.
  Jacobian jacobian(const JointVector& q_rad) const;
  // `jaw_rad` is the jaw's angle.
  LinkPoses base_from_links(const JointVector& q_rad, double jaw_rad) const;
  LinkCapsules link_capsules(const JointVector& q_rad, double jaw_rad) const;

  // Positions drawn in by `position_margin_rad` on both sides, speeds times `speed_fraction`. The jerk takes `jerk_time_s` to reach full acceleration;
  // 0.1 s is 25 control periods, above the drives' bandwidth and below what sets the arm swinging.
  JointLimits limits(double position_margin_rad = 0, double speed_fraction = 1, double jerk_time_s = 0.1) const;

  // How far from each joint's axis any point of what it moves can be, at most, with the jaw at `jaw_rad`, in whatever pose the joints after it are.
  JointVector reach_m(double jaw_rad) const;

 private:
  JointVector planar_reach_m(double jaw_rad) const;
  ArmModel model_;
  Forearm forearm_;
};

// The default machine's, of the numbers that the build makes of its URDF.
ArmModel arm5e_model();
inline Arm arm5e() { return Arm(arm5e_model()); }

}  // namespace lf::arm
