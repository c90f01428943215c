// The arm's dynamics: links and masses from its description, drives with play, weight in water, drag. Internal to this folder.
#pragma once

#include <array>

#include "host_sim/world/drive_rows.hpp"
#include "host_sim/world/link_drag.hpp"
#include "host_sim/world/multibody_part.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::world {

class ArmBody {
 public:
  struct Config {
    std::array<double, joint_count> start_rad{};
    double joint_drag_nm_s = 0;
    std::array<double, joint_count> drive_stiffness_nm_rad{};
    double step_s = 0.001;
    double drag_coefficient = 0;  // of the links, across
  };

  ArmBody(const ArmDescription& arm, const scene::Scene& scene, const Config& config);

  void set_drives(const JointDrives& drives) { drives_ = drives; }
  // New stops of a joint, which stands between them.
  void limit(Joint joint, double lower_rad, double upper_rad);
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
  static constexpr int bullet_links = int(ArmDescription::link_count) - 1;  // Bullet counts the base as -1

  void set_up_links();
  struct LinkMotions {
    std::array<Vec3, ArmDescription::link_count> turn_rad_s;
    std::array<Vec3, ArmDescription::link_count> speed_m_s;  // of the centre of mass
  };
  LinkMotions link_motions() const;
  void add_drag();
  void start_at(const std::array<double, joint_count>& start_rad);
  double position_rad(std::size_t joint) const;
  double velocity_rad_s(std::size_t joint) const;

  ArmDescription arm_;
  Config config_;
  MultibodyPart part_;
  std::array<DrivenJoint, joint_count> joints_;
  std::array<JointRows*, joint_count> rows_{};
  std::array<double, joint_count> stall_nm_{};
  std::array<Pose, ArmDescription::link_count> link_from_frame_;  // Bullet's link frames: centre of mass, principal axes
  std::array<Vec3, ArmDescription::link_count> principal_kg_m2_;
  std::array<LinkDrag, ArmDescription::link_count> drag_;  // in Bullet's link frames
  std::array<DriveStep, joint_count> plan_{};
  std::array<double, joint_count> motor_rad_{};
  JointDrives drives_{};
  JointReadings readings_{};
};

}  // namespace lf::world
