// What a SocketCAN error frame says (linux/can/error.h), counted and in words.
#pragma once

#include <cstdint>
#include <string>

#include "shared/messages/can_frame.hpp"

namespace lf::hal {

// Error frames by their class; one frame may carry several. Counted from construction on.
struct CanErrorCounts {
  std::uint32_t frames = 0;
  std::uint32_t bus_off = 0;
  std::uint32_t restarted = 0;
  std::uint32_t passive = 0;           // error counter over 127
  std::uint32_t warning = 0;           // over 96
  std::uint32_t overrun = 0;           // the controller's own buffers overflowed
  std::uint32_t protocol = 0;          // bit, form, stuff and CRC violations on the bus
  std::uint32_t no_acknowledge = 0;    // nobody else on the bus
  std::uint32_t lost_arbitration = 0;  // one-shot mode only
  std::uint32_t transmit_timeout = 0;
  std::uint32_t transceiver = 0;
  std::uint32_t other = 0;

  void add(const CanFrame& error_frame);
};

// "bus off", "error passive (receive)" ...; several are joined by commas.
std::string describe_can_error(const CanFrame& error_frame);

}  // namespace lf::hal
