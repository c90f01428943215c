// What joins served nodes to a bus and tells the time: SocketCAN on CLOCK_MONOTONIC, or a test's own wires and clock.
#pragma once

#include <span>

#include "hal/ports.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::serve {

class CanLink {
 public:
  virtual ~CanLink() = default;
  virtual Time now() = 0;
  // Waits until there is something to receive or `until` has come; true when there is.
  virtual bool wait(Time until) = 0;
  virtual void sleep(Time until) = 0;
  // One frame, oldest first, with the instant of its reception; hal::port_empty when there is none, else errno.
  virtual hal::PortStatus receive(hal::ReceivedFrame& received) = 0;
  // In order. 0 or errno; what could not be sent is counted by the link.
  virtual hal::PortStatus send(std::span<const CanFrame> frames) = 0;
};

}  // namespace lf::serve
