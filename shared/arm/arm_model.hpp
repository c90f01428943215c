// An arm in the numbers that the core works with: made of a URDF when a program starts, or by the build for a core without files.
//
// An arm is a chain of joints that turn. The last of them, the roll, turns about the tool's own axis; an arm without a roll points its tool by the last joint, too.
// Two fingers, each the other's mirror image, turn about axes square to the tool's x-z plane. Arms of one form have closed forms of their own: the slew turns a vertical plane about base z; shoulder and elbow, parallel, move
// within that plane; the roll axis lies in it, and the tool point on the roll axis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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
  enum class Form : std::uint8_t {
    planar,  // slew, shoulder, elbow, roll
    chain,   // any other
  };
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
    float stiffness_nm_rad = 0;  // by which links and gear give way under load
  };
  // Of a joint whose description does not say: the ARM 5E's.
  static constexpr float usual_stiffness_nm_rad(std::size_t joint, std::size_t arm_joints) {
    constexpr float first = 1500, between = 4000, roll_and_jaw = 1000;
    return joint + 1 >= arm_joints ? roll_and_jaw : joint == 0 ? first : between;
  }
  // In the tool frame's x-z plane: finger_a turns about -y at (pivot_x_m, pivot_z_m), its pad's face lies (face_x_m, face_z_m) from there at jaw angle 0
  // and looks along +x. Pads are pad_width_m along y and pad_depth_m along z.
  struct Jaw {
    double pivot_x_m = 0, pivot_z_m = 0;
    double face_x_m = 0, face_z_m = 0;
    double pad_width_m = 0, pad_depth_m = 0;
    double lower_rad = 0, upper_rad = 0;
  };
  // All points within a radius of the segment a-b. Small, since a core holds many: figures are rounded, and the radius is grown by what that may be.
  class Capsule {
   public:
    Capsule() = default;
    Capsule(std::size_t link, const Vec3& a_m, const Vec3& b_m, double radius_m)
        : a_m_(a_m.cast<float>()),
          b_m_(b_m.cast<float>()),
          radius_m_(static_cast<float>(radius_m + rounding_m)),
          link_(static_cast<std::uint8_t>(link)) {}

    std::size_t link() const { return link_; }  // its scene::BodyId
    Vec3 a_m() const { return a_m_.cast<double>(); }
    Vec3 b_m() const { return b_m_.cast<double>(); }
    double radius_m() const { return radius_m_; }
    static constexpr double rounding_m = 1e-6;  // of numbers below 4 m, and of the radius itself

   private:
    Eigen::Vector3f a_m_ = Eigen::Vector3f::Zero(), b_m_ = Eigen::Vector3f::Zero();
    float radius_m_ = 0;
    std::uint8_t link_ = 0;
  };

  // Those that place the tool, base to tip. The jaw comes after them.
  std::size_t arm_joints = 4;
  bool rolls = true;  // the last of them turns about the tool's own axis
  std::size_t joint_count() const { return arm_joints + 1; }

  Form form = Form::planar;
  Planar planar;        // of that form
  double tool_z_m = 0;  // with a roll: the tool point on its axis, in the last link's frame
  PerJoint<Joint> joints;
  // parent_from_joint of the arm's joints, of the jaw (finger_a) and of finger_b; without a roll the tool's pose on the last link comes after them. Links' frames
  // are turned so that each of the arm's joints turns about its z.
  static constexpr std::size_t max_links = capacity::joints + 1;
  static constexpr std::size_t most_joints_without_roll = capacity::joints - 2;
  const Pose& last_from_tool() const { return origins[arm_joints + 2]; }  // without a roll
  std::array<Pose, max_links> origins = at_the_parent();
  Jaw jaw;
  // Contain the collision shapes of the moving links; each in its link's frame.
  StaticVector<Capsule, capacity::arm_shapes> capsules;

 private:
  static std::array<Pose, max_links> at_the_parent() {
    std::array<Pose, max_links> origins;
    origins.fill(Pose::Identity());
    return origins;
  }
};

}  // namespace lf
