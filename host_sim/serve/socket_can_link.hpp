// The served nodes' way onto a SocketCAN interface.
#pragma once

#include <string>

#include "hal/vehicle/socket_can.hpp"
#include "host_sim/serve/can_link.hpp"

namespace lf::serve {

class SocketCanLink : public CanLink {
 public:
  // Throws std::runtime_error, in words and with what to do, when the interface cannot be used. One that is merely down is waited for.
  explicit SocketCanLink(const std::string& interface);

  Time now() override;
  bool wait(Time until) override { return can_.wait_readable(until); }
  void sleep(Time until) override;
  hal::PortStatus receive(hal::ReceivedFrame& received) override { return can_.receive(received); }
  hal::PortStatus send(std::span<const CanFrame> frames) override { return can_.send(frames); }
  const hal::SocketCan::Stats& stats() const { return can_.stats(); }

 private:
  hal::SocketCan can_;
};

}  // namespace lf::serve
