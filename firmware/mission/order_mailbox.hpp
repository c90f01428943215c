// Orders that wait for the tick that takes them: one of each kind, with its time of arrival and its expiry.
//
// An order that is not taken before it expires is dropped and counted; it is never executed later.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/mission/orders.hpp"
#include "shared/messages/time.hpp"

namespace lf::mission {

// What waits of an order. `set_tasks`, `hold` and `resume` take effect on arrival and never wait.
struct WaitingOrder {
  Command command = Command::start;
  std::size_t joint = 0;  // jog
  double goal_rad = 0;    // jog: where the joint is to end
  Time arrived;
  Time expires;
};

class OrderMailbox {
 public:
  // Replaces an order of the same kind that still waits.
  void put(const WaitingOrder& order);
  bool waiting(Command command) const { return slots_[static_cast<std::size_t>(command)].has_value(); }
  // Removes the order and returns it; nothing when none of this kind waits.
  std::optional<WaitingOrder> take(Command command);
  // Drops what expired before `now`.
  void drop_expired(Time now);
  void clear() { slots_ = {}; }

  // After a shut-down was ordered only an emergency stop is accepted.
  void close() { closed_ = true; }
  bool closed() const { return closed_; }
  std::uint32_t expired() const { return expired_; }

 private:
  std::array<std::optional<WaitingOrder>, command_count> slots_{};
  bool closed_ = false;
  std::uint32_t expired_ = 0;
};

}  // namespace lf::mission
