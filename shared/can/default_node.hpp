// The node number of a joint's drive where nobody states one: the CAN map's, and for the joints of longer arms those after the output node's.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/can/can_map.hpp"

namespace lf::can_map {

inline std::uint8_t default_node(std::size_t joint) {
  return joint < drive_nodes.size() ? drive_nodes[joint] : static_cast<std::uint8_t>(io_node + 1 + joint - drive_nodes.size());
}

}  // namespace lf::can_map
