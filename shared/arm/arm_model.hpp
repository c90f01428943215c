// An arm in the numbers that the core works with: made of a URDF when a program starts, or by the build for a core without files.
//
// The arm is of one form. The slew turns a vertical plane about base z; shoulder and elbow, parallel, move within that plane; the roll axis lies in it, and the
// tool point on the roll axis. Two fingers, each the other's mirror image, turn about axes square to the tool's x-z plane.
#pragma once

#include <array>
#include <cstddef>

#include "shared/geometry/pose.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf {

// A screw or gear between motor counts and the joint's angle.
// Screw: its length closes a triangle, length^2 = pivot_a^2 + pivot_b^2 - 2 pivot_a pivot_b cos(q + offset); counts = counts_per_m (length - length(q = 0)).
// Gear (pivot lengths 0): counts = counts_per_rad q.
struct ArmActuator {
  double pivot_a_m = 0;
  double pivot_b_m = 0;
  double offset_rad = 0;
  double counts_per_m = 0;
  double counts_per_rad = 0;
};

struct ArmModel {
  // Denavit and Hartenberg's numbers, as far as this form has any that are not 0 or a quarter turn.
  struct Planar {
    double mount_yaw_rad = 0;  // base_from_arm is a turn by this about z
    double a0_m = 0;           // slew axis to shoulder
    double a1_m = 0;           // shoulder to elbow
    double a2_m = 0;           // elbow to the roll axis, across it
    double d_m = 0;            // elbow to the tool point, along the roll axis
    double shoulder_offset_rad = 0;
    double elbow_offset_rad = 0;
  };
  struct Joint {
    double lower_rad = 0, upper_rad = 0;
    double velocity_rad_s = 0, acceleration_rad_s2 = 0;
    double effort_nm = 0;        // what the motor's peak torque gives the joint
    double rated_torque_nm = 0;  // the same of its rated torque
    ArmActuator actuator;
  };
  // In the tool frame's x-z plane: finger_a turns about -y at (pivot_x_m, pivot_z_m), its pad's face lies (face_x_m, face_z_m) from there at jaw angle 0
  // and looks along +x. Pads are pad_width_m along y and pad_depth_m along z.
  struct Jaw {
    double pivot_x_m = 0, pivot_z_m = 0;
    double face_x_m = 0, face_z_m = 0;
    double pad_width_m = 0, pad_depth_m = 0;
    double lower_rad = 0, upper_rad = 0;
  };
  // All points within `radius_m` of the segment a-b.
  struct Capsule {
    std::size_t link = 0;  // its scene::BodyId: 1 slew .. 6 finger_b
    Vec3 a_m = Vec3::Zero();
    Vec3 b_m = Vec3::Zero();
    double radius_m = 0;
  };

  Planar planar;
  std::array<Joint, joint_count> joints;
  // parent_from_joint of slew, shoulder, elbow, roll, jaw (finger_a) and finger_b.
  std::array<Pose, joint_count + 1> origins{Pose::Identity(), Pose::Identity(), Pose::Identity(),
                                            Pose::Identity(), Pose::Identity(), Pose::Identity()};
  Jaw jaw;
  // Contain the collision shapes of the moving links; each in its link's frame.
  StaticVector<Capsule, capacity::arm_shapes> capsules;
};

}  // namespace lf
