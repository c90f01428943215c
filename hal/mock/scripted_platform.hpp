// A platform that plays a script: frames, images and answers at their times, and a record of all that the core sent. For unit tests.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "hal/ports.hpp"
#include "shared/can/can_map.hpp"

namespace lf::hal {

class ScriptedPlatform {
 public:
  // The script: what can be received once its time has come.
  void script_frame(const CanFrame& frame, Time t) { frames_.push_back({frame, t}); }
  void script_image(std::vector<std::uint8_t> pixels, std::int32_t width, std::int32_t height, Time exposure_start, Time ready) {
    images_.push_back({std::move(pixels), width, height, exposure_start, ready});
  }
  void script_panel(const PanelResult& result, Time ready) { answers_.push_back({result, ready}); }
  void script_order(const NumberedOrder& order) { orders_.push_back(order); }
  void script_estop(bool closed) { estop_closed_ = closed; }  // from now on

  // Room for a record of so many frames, so that a test of the loop's heap calls counts none of this platform's own.
  void reserve_record(std::size_t frames) {
    sent_.reserve(frames);
    order_answers_.reserve(16);
  }

  // The record.
  const std::vector<ReceivedFrame>& sent() const { return sent_; }
  const std::vector<PanelRequest>& requests() const { return requests_; }
  const Telemetry& telemetry() const { return telemetry_; }
  std::vector<OrderAnswer>& order_answers() { return order_answers_; }

  PortStatus wait_for_tick(Time& tick) {
    now_ = now_ + can_map::sync_period;
    tick = now_;
    return port_ok;
  }
  PortStatus receive_order(NumberedOrder& order) {
    if (orders_.empty()) return port_empty;
    order = orders_.front();
    orders_.erase(orders_.begin());
    return port_ok;
  }
  PortStatus answer_order(const OrderAnswer& answer) {
    order_answers_.push_back(answer);
    return port_ok;
  }
  PortStatus read_estop(bool& closed) const {
    closed = estop_closed_;
    return port_ok;
  }
  PortStatus wait_for_image() const { return port_ok; }
  PortStatus receive_can(std::uint8_t, ReceivedFrame& received) {
    if (frames_.empty() || frames_.front().t > now_) return port_empty;
    received = frames_.front();
    frames_.pop_front();
    return port_ok;
  }
  PortStatus send_can(std::uint8_t, std::span<const CanFrame> frames) {
    for (const CanFrame& frame : frames) sent_.push_back({frame, now_});
    return port_ok;
  }
  PortStatus receive_image(std::uint8_t, Image& image) {
    if (images_.empty() || images_.front().ready > now_) return port_empty;
    lent_ = std::move(images_.front());
    images_.pop_front();
    image.view = {lent_.pixels.data(), lent_.width, lent_.height, lent_.width};
    image.exposure_start = lent_.exposure_start;
    image.exposure = Duration::from_ms(2);
    image.sequence = sequence_++;
    return port_ok;
  }
  PortStatus submit_panel(const PanelRequest& request, ImageView, std::span<const CloudPoint>) {
    requests_.push_back(request);
    return port_ok;
  }
  PortStatus receive_panel(PanelResult& result) {
    if (answers_.empty() || answers_.front().ready > now_) return port_empty;
    result = answers_.front().result;
    answers_.pop_front();
    return port_ok;
  }
  PortStatus publish(const Telemetry& telemetry) {
    telemetry_ = telemetry;
    return port_ok;
  }

 private:
  struct ScriptedImage {
    std::vector<std::uint8_t> pixels;
    std::int32_t width = 0, height = 0;
    Time exposure_start, ready;
  };
  struct ScriptedAnswer {
    PanelResult result;
    Time ready;
  };

  Time now_;
  std::uint32_t sequence_ = 0;
  std::deque<ReceivedFrame> frames_;
  std::vector<NumberedOrder> orders_;
  std::vector<OrderAnswer> order_answers_;
  bool estop_closed_ = true;
  std::deque<ScriptedImage> images_;
  std::deque<ScriptedAnswer> answers_;
  ScriptedImage lent_;
  std::vector<ReceivedFrame> sent_;
  std::vector<PanelRequest> requests_;
  Telemetry telemetry_;
};

static_assert(Platform<ScriptedPlatform>);

}  // namespace lf::hal
