// The arm's dynamics: links and masses from its description, drives with play, weight in water, drag. Internal to this folder.
#pragma once

#include <array>
#include <vector>

#include "host_sim/world/drive_rows.hpp"
#include "host_sim/world/link_drag.hpp"
#include "host_sim/world/multibody_part.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::world {

class ArmBody {
 public:
  struct Config {
    PerJoint<double> start_rad{};
    double joint_drag_nm_s = 0;
    PerJoint<double> drive_stiffness_nm_rad{};
    double step_s = 0.001;
    double drag_coefficient = 0;  // of the links, across
  };

  ArmBody(const ArmDescription& arm, const scene::Scene& scene, const Config& config);

  void set_drives(const JointDrives& drives) { drives_ = drives; }
  // New stops of the jaw, which stands between them.
  void limit_jaw(double lower_rad, double upper_rad);
  // Forces and constraints of the coming step.
  void before_step();
  // Takes what the step did.
  void after_step();

  const JointReadings& readings() const { return readings_; }
  // Of the link with this index in the description (0 the base).
  Pose base_from_link(std::size_t link) const;
  Pose base_from_tool() const;
  double kinetic_energy_j() const;
  MultibodyPart& part() { return part_; }
  const MultibodyPart& part() const { return part_; }

 private:
  // The links that move. Bullet counts the base as -1, finger_a as the jaw's joint, finger_b after it.
  int bullet_links() const { return int(arm_.links.size()) - 1; }
  std::size_t jaw() const { return arm_.joints.size() - 1; }
  int finger_b() const { return bullet_links() - 1; }
  std::size_t joint_of(int link) const { return link == finger_b() ? jaw() : std::size_t(link); }
  const ArmJoint& joint_before(int link) const { return link == finger_b() ? arm_.finger_b : arm_.joints[std::size_t(link)]; }
  // Both fingers hang on the arm's last link.
  int parent_of(int link) const { return link == finger_b() ? link - 2 : link - 1; }
  // One screw turns both fingers: torques are given for each, and it holds the sum.
  double driven_links(std::size_t joint) const { return joint == jaw() ? 2 : 1; }

  void set_up_links();
  struct LinkMotions {
    std::vector<Vec3> turn_rad_s;
    std::vector<Vec3> speed_m_s;  // of the centre of mass
  };
  LinkMotions link_motions() const;
  void add_drag();
  void start_at(const PerJoint<double>& start_rad);
  double position_rad(std::size_t joint) const;
  double velocity_rad_s(std::size_t joint) const;

  ArmDescription arm_;
  Config config_;
  MultibodyPart part_;
  PerJoint<DrivenJoint> joints_;
  PerJoint<JointRows*> rows_{};
  PerJoint<double> stall_nm_{};
  std::vector<Pose> link_from_frame_;  // Bullet's link frames: centre of mass, principal axes
  std::vector<Vec3> principal_kg_m2_;
  std::vector<LinkDrag> drag_;  // in Bullet's link frames
  PerJoint<DriveStep> plan_{};
  PerJoint<double> motor_rad_{};
  JointDrives drives_{};
  JointReadings readings_{};
};

}  // namespace lf::world
