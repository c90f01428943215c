// What a commissioning changes in the homing file, and what of it the file could not be told yet.
#pragma once

#include <array>
#include <string>

#include "firmware/config.hpp"
#include "hal/config/homing_file.hpp"

namespace lf::hal {

using JointSet = std::array<bool, joint_count>;

JointSet either(JointSet one, const JointSet& other);
bool any(const JointSet& joints);
std::string names_of(const JointSet& joints);  // "slew, elbow"

// Throws InputError: what cannot be read or written is told before anything moves.
config::HomingOffsets read_and_check(const std::string& file);
// The cause when it cannot be written; empty: it was.
std::string write_offsets(const std::string& file, const config::HomingOffsets& offsets);

// Whatever the file or the core still has of these joints' zeros.
void forget_lost(const JointSet& lost, config::HomingOffsets& offsets, ControllerConfig& core);

// `before` with the zeros of `doubted` joints as doubtful ones, and the friction of those that rub in `taken_over`. An earlier zero of a joint that the file
// does not know is the core's.
config::HomingOffsets with_doubts(config::HomingOffsets before, const JointSet& doubted, const config::HomingOffsets& taken_over,
                                  const ControllerConfig& core);

// Doubts that could not be written, for a full disk, say: the lines of these joints. The file still trusts them.
struct UnwrittenDoubts {
  JointSet joints{};
  config::HomingOffsets lines;

  void enter(config::HomingOffsets& offsets) const;
};

}  // namespace lf::hal
