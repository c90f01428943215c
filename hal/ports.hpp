// The ports: all that the control core needs of a platform, as a C++20 concept. A platform moves bytes and knows the time; it decides nothing.
//
// Every call answers with a PortStatus: 0 is success, a positive number is the platform's own error (errno on the vehicle). No call throws;
// none but `wait_for_tick` blocks. Buses and cameras are counted from 0.
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

template <class P>
concept Platform = requires(P platform, Time& tick, std::uint8_t index, ReceivedFrame& received, std::span<const CanFrame> frames,
                            Image& image, const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud,
                            PanelResult& result, const Telemetry& telemetry) {
  // Blocks until the next control tick and tells its time.
  { platform.wait_for_tick(tick) } -> std::same_as<PortStatus>;
  // Takes one received frame, oldest first; port_empty when there is none.
  { platform.receive_can(index, received) } -> std::same_as<PortStatus>;
  // Sends frames in order.
  { platform.send_can(index, frames) } -> std::same_as<PortStatus>;
  // Takes one image, oldest first; its pixels stay valid until the next call for the same camera.
  { platform.receive_image(index, image) } -> std::same_as<PortStatus>;
  // Hands a question to the panel-vision worker, which copies image and cloud.
  { platform.submit_panel(request, still, cloud) } -> std::same_as<PortStatus>;
  // Takes the worker's answer when there is one.
  { platform.receive_panel(result) } -> std::same_as<PortStatus>;
  // Leaves a tick's record with the writer.
  { platform.publish(telemetry) } -> std::same_as<PortStatus>;
};

}  // namespace lf::hal
