// Any platform with one call that fails: the n-th of a chosen port, or every one from the n-th on.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "hal/ports.hpp"

namespace lf::hal {

enum class Call : std::uint8_t {
  wait_for_tick,
  receive_can,
  send_can,
  receive_image,
  submit_panel,
  receive_panel,
  publish,
  receive_order,
  answer_order,
  read_estop,
  wait_for_image,
  count
};
inline constexpr std::size_t call_count = static_cast<std::size_t>(Call::count);

template <class Inner>
class FailingPlatform {
 public:
  explicit FailingPlatform(Inner& inner) : inner_(inner) {}

  // Call number `n` (from 0) of `call`, and the `times - 1` after it, answer `code` and do nothing.
  void fail(Call call, std::uint64_t n, PortStatus code, std::uint64_t times = 1) {
    failing_ = call;
    first_ = n;
    last_ = times > std::numeric_limits<std::uint64_t>::max() - n ? std::numeric_limits<std::uint64_t>::max() : n + times - 1;
    code_ = code;
  }
  std::uint64_t calls(Call call) const { return calls_[static_cast<std::size_t>(call)]; }
  std::uint64_t failed() const { return failed_; }

  PortStatus wait_for_tick(Time& tick) {
    // A clock that fails still lets the world go on: only its answer is withheld.
    const PortStatus status = inner_.wait_for_tick(tick);
    return fails(Call::wait_for_tick) ? code_ : status;
  }
  PortStatus receive_order(NumberedOrder& order) { return fails(Call::receive_order) ? code_ : inner_.receive_order(order); }
  PortStatus answer_order(const OrderAnswer& answer) { return fails(Call::answer_order) ? code_ : inner_.answer_order(answer); }
  PortStatus read_estop(bool& closed) { return fails(Call::read_estop) ? code_ : inner_.read_estop(closed); }
  PortStatus wait_for_image() { return fails(Call::wait_for_image) ? code_ : inner_.wait_for_image(); }
  PortStatus receive_can(std::uint8_t bus, ReceivedFrame& received) {
    return fails(Call::receive_can) ? code_ : inner_.receive_can(bus, received);
  }
  PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames) {
    return fails(Call::send_can) ? code_ : inner_.send_can(bus, frames);
  }
  PortStatus receive_image(std::uint8_t camera, Image& image) {
    return fails(Call::receive_image) ? code_ : inner_.receive_image(camera, image);
  }
  PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
    return fails(Call::submit_panel) ? code_ : inner_.submit_panel(request, still, cloud);
  }
  PortStatus receive_panel(PanelResult& result) { return fails(Call::receive_panel) ? code_ : inner_.receive_panel(result); }
  PortStatus publish(const Telemetry& telemetry) { return fails(Call::publish) ? code_ : inner_.publish(telemetry); }

 private:
  bool fails(Call call) {
    const std::uint64_t n = calls_[static_cast<std::size_t>(call)]++;
    const bool fails = call == failing_ && n >= first_ && n <= last_;
    if (fails) ++failed_;
    return fails;
  }

  Inner& inner_;
  Call failing_ = Call::count;
  std::uint64_t first_ = 0, last_ = 0;
  PortStatus code_ = 5;  // EIO
  std::array<std::uint64_t, call_count> calls_{};
  std::uint64_t failed_ = 0;
};

}  // namespace lf::hal
