// The core's drives, from the arm's joints, their limits, and the drives that the machine has at them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/transmission.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/limits.hpp"
#include "hal/config/drive_kind.hpp"
#include "hal/config/machine.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::config {

// Strokes, speeds and ramps of the arm's joints; profiles and nodes come with set_drive().
canopen::NetworkConfig network_config(const arm::Arm& arm, const safety::Limits& limits);

// The profile's units, objects and option codes, and the machine's node numbers.
// Throws InputError where they do not fit the joint or each other.
void set_drive(const Machine& machine, std::size_t joint, const DriveKind& kind, const ArmJoint& description, canopen::DriveSetup& setup);

// What only the whole bus can tell: a node number twice, numbers that do not fit a drive.
// Throws InputError with the key at fault.
void check_network(const Machine& machine, const canopen::NetworkConfig& network);

// Friction as the arm's description has it, with the doubts of figures that nobody has measured on this machine.
arm::TransmissionSetup transmission_of(const ArmJoint& joint, double counts_per_rev);

// In thousandths of the description's rating. A motor's torque is capped a little above what an overload of the joint takes where the gear has the most lever:
// the overload can then be seen. It is never above the rating, which can be held for ever, and which drives without a reserve take. With the peak torque a
// grip off the bar's middle pushes three times as hard, and trips the drives' over-current guard.
std::uint16_t torque_cap_permille(const ArmJoint& joint, const safety::JointLimit& limit, const arm::TransmissionSetup& transmission);

}  // namespace lf::config
