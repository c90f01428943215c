// What a commissioning changes in the homing file.
#pragma once

#include <array>
#include <string>

#include "firmware/config.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/vehicle/joint_set.hpp"

namespace lf::hal {

JointSet either(JointSet one, const JointSet& other);
bool any(const JointSet& joints);
std::string names_of(const JointSet& joints, const JointNames& names);  // "slew, elbow"

// The cause when it cannot be written; empty: it was.
std::string write_offsets(const std::string& file, const config::HomingOffsets& offsets);

// Whatever the file or the core still has of these joints' zeros.
void forget_lost(const JointSet& lost, config::HomingOffsets& offsets, ControllerConfig& core);

// `before` with the zeros of `doubted` joints as doubtful ones, and the friction of those that rub in `taken_over`. An earlier zero of a joint that the file
// does not know is the core's.
config::HomingOffsets with_doubts(config::HomingOffsets before, const JointSet& doubted, const config::HomingOffsets& taken_over,
                                  const ControllerConfig& core);

// While joints are commissioned their zeros stand in the file as doubtful ones: a commissioning that does not come to its end, or whose findings cannot be
// written, leaves no zero that a daemon started anew would trust.
struct Marks {
  JointSet joints{};
  config::HomingOffsets before, marked;

  // `lost`: joints whose zero in the file means nothing any more.
  static Marks of(const JointSet& joints, const JointSet& lost, config::HomingOffsets file, const ControllerConfig& core);
  // The file as it would be without them. A line that somebody has changed since is left.
  config::HomingOffsets lifted_from(config::HomingOffsets file) const;
};

}  // namespace lf::hal
