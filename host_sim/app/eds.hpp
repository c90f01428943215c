// An electronic data sheet (CiA 306) of a node with the objects of the CAN map, for tools that set up or check a CANopen node.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "shared/can/object_tables.hpp"

namespace lf::app {

struct EdsNode {
  std::uint8_t number = 0;
  std::string file, title;
  std::span<const can_map::ObjectRow> rows;  // by index and sub-index
  std::span<const can_map::ObjectHead> heads;
  std::function<std::int64_t(can_map::Figure)> figure;  // of this node; not asked for its number
};

// Lines end in CR LF, as the standard has them.
std::string eds(const EdsNode& node);

}  // namespace lf::app
