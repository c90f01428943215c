// What joints and nodes are called in files, messages and reports.
#pragma once

#include <array>

#include "shared/messages/joint_io.hpp"

namespace lf {

// In the order of `Joint`.
inline constexpr std::array<const char*, joint_count> joint_names{"slew", "shoulder", "elbow", "roll", "jaw"};
// The drives in the same order, then the output node.
inline constexpr std::array<const char*, joint_count + 1> node_names{"slew", "shoulder", "elbow", "roll", "jaw", "io"};

}  // namespace lf
