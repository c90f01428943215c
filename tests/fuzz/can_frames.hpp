// CAN frames out of a fuzz input: mostly of the predefined connection set and of the right length, sometimes anything.
#pragma once

#include "shared/messages/can_frame.hpp"
#include "tests/fuzz/input.hpp"

namespace lf::fuzz {

// `function`: bits 7 to 10 of the identifier; `node`: 0..127.
inline CanFrame frame_of(Input& in, std::uint32_t function, std::uint32_t node, std::uint8_t length) {
  CanFrame frame;
  frame.id = (function & 15U) << 7U | (node & 127U);
  frame.length = length;
  for (std::size_t i = 0; i < frame.data.size() && i < length; ++i) frame.data[i] = in.byte();
  return frame;
}

inline CanFrame any_frame(Input& in) {
  CanFrame frame;
  frame.id = in.take<std::uint32_t>();
  frame.length = in.byte();
  for (std::uint8_t& byte : frame.data) byte = in.byte();
  return frame;
}

}  // namespace lf::fuzz
