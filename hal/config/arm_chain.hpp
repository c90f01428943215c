// The core's chain of the joints between two links of a URDF file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/arm/chain/chain.hpp"
#include "shared/urdf/mechanism.hpp"

namespace lf::config {

// Which part of a mechanism is the arm, and how its tool lies in the tool link. Axes are the tool link's own: "x", "-z" ...
struct ArmEnds {
  std::string base_link;       // empty: the root
  std::string tool_link;       // empty: the only link that no joint goes on from
  std::string approach = "z";  // the tool's z
  std::string opening = "x";   // the tool's x, along which fingers move
};

struct ArmChain {
  chain::Chain chain;
  std::string base_link, tool_link;
  std::vector<std::size_t> joints;  // the chain's in the mechanism, base to tip
};

// Joints that do not move are folded into the poses between the others. Throws InputError, with file and line where there is one: for a link or an axis that
// there is not, a tool link that is not carried by the base link, a joint on the way that mimics another, no joint that moves, or more than chain::max_joints,
// and for a tool that none of them moves.
ArmChain arm_chain(const urdf::Mechanism& mechanism, const ArmEnds& ends);

// A posture drawn evenly from the joints' ranges, -pi to pi where a joint has none. The same for the same `state`, which it advances.
chain::JointValues random_posture(const chain::Chain& arm, std::uint64_t& state);

}  // namespace lf::config
