// What a commissioning has found, and what of it the homing file and the core take over.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/config/homing_file.hpp"
#include "hal/vehicle/commissioning.hpp"
#include "hal/vehicle/homing_changes.hpp"
#include "hal/vehicle/status_json.hpp"
#include "shared/arm/motor.hpp"

namespace lf::hal {

// {"elbow": {"coulomb_mnm", "viscous_mnm_s", "rms_mnm"}, ...} of the joints whose friction is known: at the motor's shaft, viscous per rad/s of the motor, and
// what the fit left.
Json friction_json(const config::HomingOffsets& offsets);

// What a commissioning has found.
struct Commissioned {
  JointSet found{};
  PerJoint<std::int32_t> zero_counts{};
  JointSet friction_found{};
  PerJoint<config::JointFriction> friction{};
  std::string how;             // and when
  PerJoint<double> place_rad;  // where each zero was found: the joint's stop, or 0 in a jig
  // By how much it was found off its earlier zero, as the commissioning compared it; 0 where that is less than what is told.
  PerJoint<double> moved_rad{};
  JointSet lost{};  // its drive has lost its position, before a zero was found or after: no earlier zero of it means anything
};

struct TakenOver {
  std::vector<std::string> left_out;  // a sentence for each joint that takes no power
  // By how much each zero has moved, as the angle at its place: against the file's earlier one, or as the commissioning compared it, whichever is more. 0 where
  // there was none, or it moved by less than what is told.
  PerJoint<double> moved_rad{};
};
// Takes it over into `offsets`. A joint whose friction cannot be is no longer known there, and stays out until a friction was measured that can be: a zero
// alone does not show that what rubbed is gone.
TakenOver take_over(const arm::Arm& arm, const Commissioned& commissioned, const PerJoint<Motor>& motors, config::HomingOffsets& offsets);

// Of a commissioning that failed: a zero was found elsewhere, or something rubs.
bool leaves_doubt(const Commissioning& ended, const PerJoint<Motor>& motors, const JointNames& names);
// The file was changed while the joint moved, so that the commissioning could not compare with it. Empty: it was not.
std::string found_elsewhere(const TakenOver& taken, const JointNames& names);
// Adds a sentence for each zero that has moved and was not written.
void tell_moved(TakenOver& taken, const JointNames& names);
// Found elsewhere than its earlier zero, or with a friction that cannot be. `offsets` is what was taken over.
JointSet doubted_joints(const Commissioned& commissioned, const TakenOver& taken, const config::HomingOffsets& offsets);
// The joints of `lost` that have a zero in the file, doubtful or not.
JointSet with_a_zero(const JointSet& lost, const config::HomingOffsets& offsets);
// How it has ended, in words; empty: well. `unwritten_for`: why the file could not be written; `gone`: the joints whose zeros were taken out of it.
std::string ending(const std::string& failed, const std::string& unwritten_for, const JointSet& doubted, const JointSet& gone,
                   const Marks& marks);
// A sentence for each joint that was not commissioned and loses its power all the same, by what the file says of its friction.
std::vector<std::string> cut_off(const config::HomingOffsets& offsets, const JointSet& found, const ControllerConfig& core);
// What was found is not used. That a joint must not have power holds all the same.
void deny_power(const JointSet& denied, ControllerConfig& core, config::HomingOffsets& offsets);
// The other joints keep what the core has: the file may have been changed since the daemon read it. One whose friction there cannot be takes no power all the
// same.
void use_zeros(const config::HomingOffsets& offsets, const JointSet& found, const JointSet& still_lost, ControllerConfig& core);

}  // namespace lf::hal
