#include "firmware/mission/order_mailbox.hpp"

#include <gtest/gtest.h>

namespace lf::mission {
namespace {

WaitingOrder order(Command command, double expires_s) {
  WaitingOrder order;
  order.command = command;
  order.arrived = Time::from_s(1);
  order.expires = Time::from_s(expires_s);
  return order;
}

TEST(OrderMailbox, GivesEachOrderOnce) {
  OrderMailbox mailbox;
  mailbox.put(order(Command::start, 9));
  EXPECT_TRUE(mailbox.waiting(Command::start));
  EXPECT_FALSE(mailbox.take(Command::home).has_value());
  EXPECT_TRUE(mailbox.take(Command::start).has_value());
  EXPECT_FALSE(mailbox.take(Command::start).has_value());
}

TEST(OrderMailbox, DropsAndCountsWhatExpired) {
  OrderMailbox mailbox;
  mailbox.put(order(Command::start, 2));
  mailbox.put(order(Command::abort, 3));
  mailbox.drop_expired(Time::from_s(2));
  EXPECT_TRUE(mailbox.waiting(Command::start)) << "in time to the last instant";
  mailbox.drop_expired(Time::from_s(2) + Duration::from_ns(1));
  EXPECT_FALSE(mailbox.waiting(Command::start));
  EXPECT_TRUE(mailbox.waiting(Command::abort));
  EXPECT_EQ(mailbox.expired(), 1u);
}

TEST(OrderMailbox, ANewerOrderReplacesTheOneThatWaits) {
  OrderMailbox mailbox;
  mailbox.put(order(Command::jog, 2));
  WaitingOrder newer = order(Command::jog, 4);
  newer.goal_rad = 0.5;
  mailbox.put(newer);
  const auto taken = mailbox.take(Command::jog);
  ASSERT_TRUE(taken.has_value());
  EXPECT_EQ(taken->goal_rad, 0.5);
}

}  // namespace
}  // namespace lf::mission
