#include "firmware/mission/order_mailbox.hpp"

#include <utility>

namespace lf::mission {

void OrderMailbox::put(const WaitingOrder& order) { slots_[static_cast<std::size_t>(order.command)] = order; }

std::optional<WaitingOrder> OrderMailbox::take(Command command) {
  return std::exchange(slots_[static_cast<std::size_t>(command)], std::nullopt);
}

void OrderMailbox::drop_expired(Time now) {
  for (std::optional<WaitingOrder>& slot : slots_) {
    if (!slot || now <= slot->expires) continue;
    slot.reset();
    ++expired_;
  }
}

}  // namespace lf::mission
