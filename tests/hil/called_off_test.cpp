// A commissioning that is called off before it begins, by way of the operator's desk. The test plays the control thread.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "hal/vehicle/order_desk.hpp"
#include "tests/hil/commissioner_at_work.hpp"

namespace lf::test {
namespace {

using hal::Json;
using hal::OrderDesk;

constexpr const char *commission = R"({"do":"commission","clear":true,"joints":["jaw"]})", *abort_it = R"({"do":"abort"})";

class CalledOff : public testing::Test {
 protected:
  CalledOff() {
    OrderDesk::Ways ways;
    ways.status = [] { return Json::object(); };
    ways.log = [](const Json&) {};
    ways.look_up = [](unsigned) -> hal::User { return {"alice", hal::Role::engineer}; };
    ways.commissioner = work.commissioner.get();
    desk = std::make_unique<OrderDesk>(*work.rings, ways);
    (void)answer_of(abort_it);  // from now on the desk knows who she is
  }

  OrderDesk::Ticket take(const std::string& line) {
    const OrderDesk::Ticket ticket = ++tickets;
    if (const std::optional<std::string> answer = desk->take(line, 1000, ticket)) answers[ticket] = Json::parse(*answer);
    return ticket;
  }
  // As the control thread takes orders when the mission stands so.
  void turn() {
    for (hal::NumberedOrder order; work.rings->orders.pop(order);) {
      if (!work.rings->gate.take(order.number)) continue;
      done.push_back(order.order.command);
      hal::OrderAnswer answer;
      answer.number = order.number;
      answer.standing = standing;
      answer.taken = mission::may(order.order.command, standing);
      (void)work.rings->answers.push(answer);
    }
    desk->settle([&](OrderDesk::Ticket of, const std::string& text) { answers[of] = Json::parse(text); });
    work.commissioner->step();
  }
  Json answer(OrderDesk::Ticket ticket) {
    for (int i = 0; i < 5000 && answers.count(ticket) == 0; ++i) {
      turn();
      usleep(1000);
    }
    return answers.count(ticket) > 0 ? answers[ticket] : Json("no answer");
  }
  Json answer_of(const std::string& line) { return answer(take(line)); }
  // Not what step() has lent meanwhile.
  bool lent() {
    hal::CommissioningLoan loan;
    return work.rings->commissionings.pop(loan);
  }

  AtWork work{somewhere[4]};
  mission::Standing standing = mission::Standing::idle;
  std::vector<Command> done;
  std::map<OrderDesk::Ticket, Json> answers;
  OrderDesk::Ticket tickets = 0;
  std::unique_ptr<OrderDesk> desk;
};

// It was swallowed: the arm went on with its job, and the answer said that nothing had moved.
TEST_F(CalledOff, AnAbortGoesOnToTheCoreWhichMayBeAtWork) {
  standing = mission::Standing::working;
  done.clear();
  const OrderDesk::Ticket ordered = take(commission), aborted = take(abort_it);
  const Json answered = answer(aborted);
  EXPECT_EQ(answered["ok"], true) << answered;
  EXPECT_EQ(answered["standing"], "working");
  EXPECT_EQ(done, std::vector<Command>{Command::abort});
  EXPECT_NE(answer(ordered)["why"].get<std::string>().find("another order came before it began: nothing moves"), std::string::npos);
  EXPECT_FALSE(lent());
}

TEST_F(CalledOff, AnAbortIsAnsweredWellWhereThereWasNothingElseToAbort) {
  const OrderDesk::Ticket ordered = take(commission), aborted = take(abort_it);
  const Json answered = answer(aborted);
  EXPECT_EQ(answered["ok"], true) << answered;
  EXPECT_EQ(answered["note"], "the commissioning is called off before it began");
  EXPECT_EQ(answer(ordered)["ok"], false);
  EXPECT_FALSE(lent());
  EXPECT_EQ(answer_of(abort_it)["ok"], false) << "now there is nothing";
}

// Ctrl-C, or a line that was cut: who ordered it may be on the way to the arm.
TEST_F(CalledOff, ByAClientThatHasGone) {
  const OrderDesk::Ticket ordered = take(commission);
  desk->gone(ordered);
  EXPECT_NE(answer(ordered)["why"].get<std::string>().find("who ordered it has gone: nothing moves"), std::string::npos);
  EXPECT_TRUE(work.wait_for([&] { return !work.commissioner->busy(); }));
  EXPECT_FALSE(lent());
  const OrderDesk::Ticket other = take(abort_it);
  desk->gone(other);
  EXPECT_EQ(answer(other)["why"].get<std::string>().find("gone"), std::string::npos) << "an order to stop goes on";
}

}  // namespace
}  // namespace lf::test
