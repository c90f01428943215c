// What commissioning found: for each joint, what its drive's absolute encoder counts where the arm's own count is 0, and how its motor and gear rub. YAML,
// written and read here.
// The daemon writes and reads it; the simulator reads it. A joint that it does not have was never commissioned, and takes no power.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/arm/transmission.hpp"
#include "shared/arm/joint_names.hpp"
#include "shared/arm/motor.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::config {

// At the motor's shaft.
struct JointFriction {
  double coulomb_mnm = 0;
  double viscous_mnm_s = 0;  // per rad/s of the motor
  double rms_mnm = 0;        // what the fit left
};

struct HomingOffsets {
  JointNames names;  // whose they are
  PerJoint<std::int32_t> zero_counts{};
  PerJoint<bool> known{};
  // The joint was found elsewhere than `zero_counts` has it, something rubs in it, or its commissioning did not come to its end. It is not known, and a later commissioning compares with these counts.
  PerJoint<bool> zero_doubtful{};
  PerJoint<bool> friction_known{};
  // A friction that cannot be was found, and none since: the joint is not known, whatever zero was found.
  PerJoint<bool> friction_doubtful{};
  PerJoint<JointFriction> friction{};
  PerJoint<std::string> found;  // how and when, a line for people

  bool has_earlier_zero(std::size_t joint) const;  // known, or doubtful: one to compare with
  void doubt_zero(std::size_t joint);              // keeps its counts, if it has any
  void doubt_friction(std::size_t joint);          // and its zero with it
  void forget_zero(std::size_t joint);             // its counts mean nothing any more
  void take_joint(const HomingOffsets& from, std::size_t joint);
};

// The friction as the core takes it: its doubt is what the fit left, and a twentieth for the temperature of another day. Nothing is changed for a joint whose
// friction is not known.
void set_friction(const HomingOffsets& offsets, std::size_t joint, arm::Friction& friction);

// Friction that this motor cannot have, in words with the key that says so, or nothing: a typing error, another machine's file, or a joint that something rubs
// against. The bounds are those of a scenario's friction.*, over what the arm's description has.
std::optional<std::string> friction_problem(const std::string& joint, const JointFriction& found, const Motor& motor);

// Joints with such a friction are no longer known and count as doubtful, so that they take no power until they are commissioned again. A sentence for each.
std::vector<std::string> leave_out_doubtful(HomingOffsets& offsets, const PerJoint<Motor>& motors);

// Throws InputError with file and line: unreadable or malformed, an unknown joint, one without its number, a doubtful zero without its counts, a number out of range. An empty file knows no
// joint.
HomingOffsets read_homing_file(const std::string& path, const JointNames& names);
// Writes the joints that are known, and those whose zero or friction is doubtful. Replaces the file as a whole or not at all, a loss of power included. Throws
// InputError with the cause.
void write_homing_file(const std::string& path, const HomingOffsets& offsets);

}  // namespace lf::config
