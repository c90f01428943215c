// Which of the bus's nodes are served: numbers of the CAN map.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "host_sim/devices/canopen/node_rack.hpp"

namespace lf::serve {

class NodeSet {
 public:
  static NodeSet all();
  // "1-5", "1,3,6", "all", "none". Throws InputError for what is no list, or a number that no node of the map has.
  static NodeSet parse(const std::string& text);

  bool has(std::size_t slot) const { return served_[slot]; }
  bool empty() const;
  bool is_all() const;
  std::string text() const;  // "1, 2, 6", "none"

 private:
  std::array<bool, capacity::nodes> served_{};
};

// The node in a slot of the rack.
std::uint8_t node_in(std::size_t slot);

}  // namespace lf::serve
