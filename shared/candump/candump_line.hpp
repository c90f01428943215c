// A CAN frame as can-utils' `candump -l` writes it: canplayer, python-can, SavvyCAN and Wireshark open it.
//
//   (0000000012.004000) can0 181#37064F0B00001200
//
// Standard identifiers have 3 hex digits, extended and error frames 8; a remote frame is #R and its length.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf {

// "(sec.usec) " and " can0 " and the frame: at most 12 + 8 + 3 + 16 characters beside the interface's name.
struct CandumpLine {
  std::array<char, 96> text;
  std::size_t size = 0;

  std::string_view view() const { return {text.data(), size}; }
};

// With its newline. Times before zero are written as zero; of an interface's name at most 15 characters, as they have.
CandumpLine candump_line(Time t, const char* interface, const CanFrame& frame) noexcept;

}  // namespace lf
