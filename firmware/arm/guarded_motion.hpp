// Knows from the drives alone that the arm touches something: torque above what free motion takes, or a joint that no longer follows.
//
// The torque of free motion (screw friction, the arm's wet weight, drag) is learned on the way: over the first samples of a motion, and slowly
// after that, so that a pose-dependent weight does not add up to a contact. A contact is many times faster than this drift.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/joint_observer.hpp"
#include "firmware/arm/joint_torques.hpp"
#include "firmware/arm/kinematics.hpp"
#include "shared/messages/time.hpp"

namespace lf::arm {

struct GuardConfig {
  explicit GuardConfig(std::size_t arm_joints, bool rolls = true)
      : contact_torque_nm(each_joint(arm_joints, 4, 2, rolls)),
        overload_torque_nm(each_joint(arm_joints, 45, 9, rolls)),
        following_rad(each_joint(arm_joints, 0.03, 0.12, rolls)) {}
  explicit GuardConfig(const Arm& arm) : GuardConfig(arm.arm_joints(), arm.rolls()) {}

  JointVector contact_torque_nm;   // rise over the baseline. 10 N at the tool, 0.4 m from the shoulder, are 4 N m
  JointVector overload_torque_nm;  // without regard to the baseline; 1.5 x the rated torque
  JointVector following_rad;       // command less position; 3 x the lag at full speed with a position loop of 20 / s
  double filter_s = 0.012;         // first-order low pass of the torque: 3 SYNCs, against single outliers
  double baseline_s = 1.0;         // time constant with which the baseline follows while free
  std::uint32_t learning = 25;     // samples averaged into the first baseline: 0.1 s; no contact is reported meanwhile, an overload is
  std::uint32_t debounce = 3;      // samples in a row that say so before it is believed
};

enum class GuardState : std::uint8_t {
  learning,
  free,
  contact,   // latched until reset()
  overload,  // latched
};

enum class GuardCause : std::uint8_t { none, torque, following_error };

class GuardedMotion {
 public:
  explicit GuardedMotion(const GuardConfig& config) : config_(config) {}

  // Starts anew: forgets the baseline.
  void reset();

  // One SYNC's measurements. What the torque surely is, given its bounds, is held against the thresholds: what it may be is no contact. A sample with a value that is not a number is refused and counted, and so is one not later than the one before.
  GuardState update(Time t, const JointVector& command_rad, const JointVector& position_rad, const JointVector& velocity_rad_s,
                    const JointTorques& torque);

  GuardState state() const { return state_; }
  GuardCause cause() const { return cause_; }
  std::size_t joint() const { return joint_; }  // that showed it first
  bool touched() const { return state_ == GuardState::contact || state_ == GuardState::overload; }
  const JointVector& excess_torque_nm() const { return excess_nm_; }  // filtered torque less baseline
  const JointVector& baseline_nm() const { return baseline_nm_; }     // of free motion, as far as it is learned
  const JointVector& error_rad() const { return error_rad_; }         // command less position
  const JointVector& position_rad() const { return position_rad_; }
  const JointVector& velocity_rad_s() const { return velocity_rad_s_; }
  // Observed as a joint's speed is (joint_observer.hpp), and late by as much: 0 with the first sample.
  const JointVector& command_rad_s() const { return command_rad_s_; }
  // How far each joint went, and was to go, since its excess torque was last below a quarter of a contact's.
  JointVector travelled_rad() const { return (position_rad_ - free_position_rad_).cwiseAbs(); }
  JointVector to_travel_rad() const { return (position_rad_ + error_rad_ - free_command_rad_).cwiseAbs(); }
  std::uint32_t refused() const { return refused_; }

 private:
  void observe(const JointVector& command_rad, double dt_s);
  void latch(GuardState state, GuardCause cause, std::size_t joint);

  GuardConfig config_;
  GuardState state_ = GuardState::learning;
  GuardCause cause_ = GuardCause::none;
  std::size_t joint_ = 0;
  Time last_;
  std::uint32_t samples_ = 0;
  std::uint32_t refused_ = 0;
  JointTorques filtered_;
  JointVector baseline_nm_ = JointVector::Zero();
  JointVector excess_nm_ = JointVector::Zero();
  JointVector error_rad_ = JointVector::Zero();
  JointVector position_rad_ = JointVector::Zero();
  JointVector free_position_rad_ = JointVector::Zero(), free_command_rad_ = JointVector::Zero();  // when the excess was hardly there
  PerArmJoint<JointObserver> commands_{};
  JointVector command_rad_s_ = JointVector::Zero();
  JointVector velocity_rad_s_ = JointVector::Zero();
  PerArmJoint<std::uint32_t> torque_run_{}, following_run_{}, overload_run_{};
};

}  // namespace lf::arm
