// The ports: all that the control core needs of a platform, as a C++20 concept. A platform moves bytes and knows the time; it decides nothing.
//
// Every call answers with a PortStatus: 0 is success, a positive number is the platform's own error (errno on the vehicle). No call throws;
// none but `wait_for_tick` and `wait_for_image` blocks. Buses and cameras are counted from 0.
//
// The control thread calls wait_for_tick, receive_order, answer_order, read_estop, receive_can, send_can, receive_panel and publish; the vision thread
// calls wait_for_image, receive_image and submit_panel.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "firmware/controller.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

using PortStatus = int;  // 0 success
inline constexpr PortStatus port_ok = 0;
inline constexpr PortStatus port_empty = -1;  // nothing to take now; not an error

struct ReceivedFrame {
  CanFrame frame;
  Time t;  // when it was received, on the platform's clock
};

// An operator's order with the number that its answer bears.
struct NumberedOrder {
  std::uint64_t number = 0;
  mission::Order order;
};

struct OrderAnswer {
  std::uint64_t number = 0;
  bool taken = false;
  bool commissioning = false;                            // it came while the arm was being commissioned
  mission::Standing standing = mission::Standing::idle;  // when it was judged
};

template <class P>
concept Platform = requires(P platform, Time& tick, NumberedOrder& order, const OrderAnswer& answer, bool& estop_closed, std::uint8_t index,
                            ReceivedFrame& received, std::span<const CanFrame> frames, Image& image, const PanelRequest& request,
                            ImageView still, std::span<const CloudPoint> cloud, PanelResult& result, const Telemetry& telemetry) {
  // Blocks until the next control tick and tells its time. The first call starts the clock's beat.
  { platform.wait_for_tick(tick) } -> std::same_as<PortStatus>;
  // Takes one order, oldest first but stops before all others; port_empty when there is none. An order that comes out was not withdrawn, and will not be.
  { platform.receive_order(order) } -> std::same_as<PortStatus>;
  // Tells the operator's side what became of an order.
  { platform.answer_order(answer) } -> std::same_as<PortStatus>;
  // The platform's own emergency-stop input, beside the chain on the bus. One that cannot be read is open; a platform that has none says closed.
  { platform.read_estop(estop_closed) } -> std::same_as<PortStatus>;
  // Takes one received frame, oldest first; port_empty when there is none.
  { platform.receive_can(index, received) } -> std::same_as<PortStatus>;
  // Sends frames in order.
  { platform.send_can(index, frames) } -> std::same_as<PortStatus>;
  // Waits until there may be an image, a few milliseconds at most. Returns at once where images come with the tick.
  { platform.wait_for_image() } -> std::same_as<PortStatus>;
  // Takes one image, oldest first; its pixels stay valid until the next call for the same camera.
  { platform.receive_image(index, image) } -> std::same_as<PortStatus>;
  // Hands a question to the panel-vision worker, which copies image and cloud.
  { platform.submit_panel(request, still, cloud) } -> std::same_as<PortStatus>;
  // Takes the worker's answer when there is one.
  { platform.receive_panel(result) } -> std::same_as<PortStatus>;
  // Leaves a tick's record with the writer.
  { platform.publish(telemetry) } -> std::same_as<PortStatus>;
};

// For platforms that nobody operates while they run: no orders, no emergency-stop input, images with the tick.
struct Unattended {
  static PortStatus receive_order(NumberedOrder&) { return port_empty; }
  static PortStatus answer_order(const OrderAnswer&) { return port_ok; }
  static PortStatus read_estop(bool& closed) {
    closed = true;
    return port_ok;
  }
  static PortStatus wait_for_image() { return port_ok; }
};

}  // namespace lf::hal
