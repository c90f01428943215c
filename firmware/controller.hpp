// The front door of the control thread: CAN frames, panel-vision answers and the time go in; CAN frames and orders to the vision thread come out.
//
// A plain object: it never sleeps, reads a clock, opens a file, allocates, throws or blocks. Not thread-safe: one thread owns it.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/network.hpp"
#include "firmware/config.hpp"
#include "firmware/mission/mission.hpp"
#include "firmware/telemetry.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf {

inline constexpr std::uint8_t bus_count = 1;
inline constexpr std::uint8_t camera_count = 1;

// What one tick asks of the platform.
struct TickOutput {
  std::array<canopen::Outbox, bus_count> can;
  StaticVector<ScanCommand, 16> scan;  // a joint sample, an exposure, and what the mission orders of a sweep
  Telemetry telemetry;

  void clear() {
    for (canopen::Outbox& outbox : can) outbox.clear();
    scan.clear();
    telemetry.events.clear();
  }
};

class Controller {
 public:
  explicit Controller(const ControllerConfig& config);

  void on_can(std::uint8_t bus, const CanFrame& frame, Time t);
  void on_panel(const PanelResult& result, Time t);
  void on_scan(const ScanStats& stats, Time t);
  void on_port_error(Port port, std::int32_t code, Time t);
  // False, and counted, when the mission's table of orders (mission/orders.hpp) or the order's own numbers do not allow it, or when it asks for power and a
  // joint's zero is not known.
  bool on_order(const mission::Order& order, Time t);
  bool on_command(Command command, Time t);  // an order without arguments

  // Its drive was heard to lose its position while another program had the bus: no power before it has a zero again.
  void lose_zero(std::size_t joint) { network_.axis(joint).lose_zero(); }
  // What the core before this one did not know of its jaw, this one does not know.
  void doubt_jaw() { mission_.doubt_jaw(); }

  // One control period. `out` is cleared by the caller; what does not fit into it is counted, never lost silently.
  void tick(Time t, TickOutput& out);

  const mission::Mission& mission() const { return mission_; }
  const canopen::Network& network() const { return network_; }
  const std::array<std::uint32_t, port_count>& port_errors() const { return port_errors_; }
  const ScanStats& scan_stats() const { return mission_.scan_stats(); }
  std::uint32_t orders_refused() const { return orders_refused_; }
  std::uint32_t rejected_inputs() const { return rejected_inputs_; }

 private:
  canopen::Network network_;
  mission::Mission mission_;
  std::array<std::uint32_t, port_count> port_errors_{};
  std::uint32_t orders_refused_ = 0;
  std::uint32_t rejected_inputs_ = 0;
};

}  // namespace lf
