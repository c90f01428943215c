// What an operator's line comes to, without a socket and without a control thread: the test plays both.
#include "hal/vehicle/order_desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <map>
#include <memory>

#include "hal/config/task_check.hpp"
#include "hal/vehicle/tick_clock.hpp"

namespace lf::hal {
namespace {

using testing::HasSubstr;

constexpr unsigned alice = 4001, bob = 4002, slow = 4003;

class Desk : public testing::Test {
 protected:
  Desk() {
    ways.status = [] { return Json{{"step", "idle"}}; };
    // On threads that may outlive the test by a moment: they share what they look at.
    ways.restart_bus = [blocked = bus_blocked, error = bus_error] {
      while (*blocked) sleep_until(monotonic_now() + Duration::from_ms(1));
      return error->load();
    };
    ways.log = [this](const Json& line) { log.push_back(line); };
    ways.look_up = [blocked = directory_blocked](unsigned user) -> User {
      while (user == slow && *blocked) sleep_until(monotonic_now() + Duration::from_ms(1));
      if (user == alice) return {"alice", Role::engineer};
      return {user == bob ? "bob" : "carol", Role::watcher};
    };
    ways.interface = "can7";
    desk = std::make_unique<OrderDesk>(*rings, ways);
  }
  ~Desk() override { *bus_blocked = *directory_blocked = false; }

  // The answer, at once or within `limit`.
  Json ask(const std::string& line, unsigned user, bool control = true, Duration limit = Duration::from_s(20)) {
    const OrderDesk::Ticket ticket = ++tickets;
    std::optional<std::string> answer = desk->take(line, user, ticket);
    for (const Time end = monotonic_now() + limit; !answer && monotonic_now() < end;) {
      if (control) run_control();
      desk->settle([&](OrderDesk::Ticket of, const std::string& text) {
        if (of == ticket) answer = text;
      });
      sleep_until(monotonic_now() + Duration::from_ms(1));
    }
    return answer ? Json::parse(*answer) : Json("no answer");
  }

  // As VehiclePlatform takes orders; everything is carried out.
  void run_control() {
    for (NumberedOrder order;;) {
      if (!rings->stops.pop(order)) {
        if (!rings->orders.pop(order)) return;
        if (!rings->gate.take(order.number)) continue;
      }
      done.push_back(order.order.command);
      OrderAnswer answer;
      answer.number = order.number;
      answer.taken = mission::may(order.order.command, standing);
      answer.standing = standing;
      (void)rings->answers.push(answer);
    }
  }

  std::unique_ptr<LoopRings> rings = std::make_unique<LoopRings>();
  OrderDesk::Ways ways;
  std::vector<Json> log;
  std::vector<Command> done;
  mission::Standing standing = mission::Standing::idle;
  std::shared_ptr<std::atomic<bool>> bus_blocked = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<std::atomic<bool>> directory_blocked = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<std::atomic<int>> bus_error = std::make_shared<std::atomic<int>>(0);
  OrderDesk::Ticket tickets = 0;
  std::unique_ptr<OrderDesk> desk;
};

TEST_F(Desk, GivesAnOrderToTheControlThreadAndLogsItsGiverByName) {
  EXPECT_EQ(ask(R"({"do":"start"})", alice)["ok"], true);
  EXPECT_THAT(done, testing::ElementsAre(Command::start));
  ASSERT_EQ(log.size(), 1u);
  EXPECT_EQ(log[0]["by"], "alice");
  EXPECT_EQ(log[0]["role"], "engineer");
  EXPECT_EQ(log[0]["order"]["do"], "start");
}

TEST_F(Desk, RefusesWhatAUserMayNot) {
  const Json answer = ask(R"({"do":"start"})", bob);
  EXPECT_EQ(answer["ok"], false);
  EXPECT_THAT(answer["why"].get<std::string>(), HasSubstr("watcher may not 'start': it takes operator"));
  EXPECT_TRUE(done.empty());
  EXPECT_EQ(ask(R"({"do":"estop"})", bob)["ok"], true);
}

TEST_F(Desk, SaysWhatToDoBeforeAnOrderThatIsNotAllowedNow) {
  const auto why = [&](const char* line, mission::Standing now) {
    standing = now;
    return ask(line, alice)["why"].get<std::string>();
  };
  constexpr const char *jog = R"({"do":"jog","joint":"elbow","by_deg":-5})", *start = R"({"do":"start"})", *hold = R"({"do":"hold"})";
  using enum mission::Standing;
  EXPECT_EQ(why(jog, idle), "not while the mission is idle: `home` first");
  EXPECT_EQ(why(jog, ended), "not while the mission is ended: `reset` first, then `home`");
  EXPECT_EQ(why(start, ended), "not while the mission is ended: `reset` first");
  EXPECT_EQ(why(start, held), "not while the mission is held: `reset` first");
  EXPECT_EQ(why(start, on_hold), "not while the mission is on hold: `resume` or `abort` first");
  EXPECT_EQ(why(hold, idle), "not while the mission is idle");
}

// It was "its numbers are out of bounds".
TEST_F(Desk, NamesTheAngleThatTheHandleCannotHaveAndItsBounds) {
  ways.why_not = [](const mission::Tasks& tasks) {
    PanelLayout panel;
    panel.valves[0].handle_min_rad = rad_from_deg(-10);
    panel.valves[0].handle_max_rad = rad_from_deg(105);
    return config::turn_problem(tasks, panel, {});
  };
  desk = std::make_unique<OrderDesk>(*rings, ways);
  const auto turn = [&](const char* to) {
    return ask(std::string(R"({"do":"task","tasks":[{"turn_valve":{"to_deg":)") + to + "}}]}", alice);
  };
  EXPECT_EQ(turn("106")["why"], "the valve cannot be turned to 106 deg: its handle goes from -10 to 105 deg");
  EXPECT_EQ(turn("-11")["ok"], false);
  EXPECT_EQ(turn("104.9")["ok"], true);
  EXPECT_EQ(ask(R"({"do":"task","tasks":[{"press_buttons":{"order":["left"]}}]})", alice)["ok"], true);
}

TEST_F(Desk, NamesTheValveOfAFilesPanel) {
  ways.names = {{"V1", "V2"}, {"B1", "B2", "B3"}, {"7"}};
  ways.why_not = [names = ways.names](const mission::Tasks& tasks) {
    PanelLayout panel;
    (void)panel.valves.push_back({.at_m{0.25, 0}, .handle_min_rad = rad_from_deg(-10)});
    return config::turn_problem(tasks, panel, names);
  };
  desk = std::make_unique<OrderDesk>(*rings, ways);
  const auto turn = [&](const std::string& valve, const char* to) {
    return ask(R"({"do":"task","tasks":[{"turn_valve":{"valve":")" + valve + R"(","to_deg":)" + to + "}}]}", alice);
  };
  EXPECT_EQ(turn("V2", "-11")["why"], "valve V2 cannot be turned to -11 deg: its handle goes from -10 to 105 deg");
  EXPECT_EQ(turn("V1", "-11")["ok"], true);
  EXPECT_EQ(turn("V3", "-11")["why"], "no valve 'V3': V1 or V2");
}

TEST_F(Desk, AnswersALineThatIsNoRequestAndLogsIt) {
  EXPECT_EQ(ask(R"({"do":"task","tasks":[{"turn_valve":90}]})", alice)["ok"], false);
  EXPECT_EQ(ask("\xff\xfe", alice)["ok"], false);
  EXPECT_EQ(log.size(), 2u);
}

// It was answered "refused" after half a second, and ran when the control thread came back.
TEST_F(Desk, WithdrawsAnOrderThatIsNotTakenInTime) {
  const Json answer = ask(R"({"do":"start"})", alice, false);
  EXPECT_EQ(answer["ok"], false);
  EXPECT_THAT(answer["why"].get<std::string>(), HasSubstr("it will not run"));
  run_control();
  EXPECT_TRUE(done.empty());
}

TEST_F(Desk, NeverWithdrawsAStop) {
  EXPECT_THAT(ask(R"({"do":"estop"})", alice, false)["why"].get<std::string>(), HasSubstr("remains ordered"));
  run_control();
  EXPECT_THAT(done, testing::ElementsAre(Command::emergency_stop));
}

TEST_F(Desk, TakesAStopWhateverWaits) {
  for (int i = 0; i < 100; ++i) (void)desk->take(R"({"do":"home"})", alice, 1000 + static_cast<unsigned>(i));
  sleep_until(monotonic_now() + Duration::from_ms(20));
  desk->settle([](OrderDesk::Ticket, const std::string&) {});
  EXPECT_EQ(ask(R"({"do":"estop"})", bob)["ok"], true);
  ASSERT_FALSE(done.empty());
  EXPECT_EQ(done.front(), Command::emergency_stop);
}

TEST_F(Desk, AStopDoesNotWaitForTheUsersName) {
  *directory_blocked = true;
  EXPECT_EQ(ask(R"({"do":"estop"})", slow, true, Duration::from_ms(200))["ok"], true);
  EXPECT_EQ(ask(R"({"do":"status"})", slow, true, Duration::from_ms(200))["ok"], true);
  EXPECT_EQ(log.at(0)["by"], "user 4003");
}

TEST_F(Desk, AnOrderWaitsForTheUsersNameAndNoOneElse) {
  *directory_blocked = true;
  EXPECT_EQ(ask(R"({"do":"home"})", slow, true, Duration::from_ms(50)), Json("no answer"));
  EXPECT_EQ(ask(R"({"do":"status"})", bob, true, Duration::from_ms(200))["ok"], true);
  EXPECT_TRUE(done.empty());
}

// Else a reset would take back the stop that was given after it.
TEST_F(Desk, AnOrderThatAStopHasOvertakenIsNotCarriedOut) {
  *directory_blocked = true;
  constexpr OrderDesk::Ticket reset = 1000, stop = 1001;
  (void)desk->take(R"({"do":"reset"})", slow, reset);
  (void)desk->take(R"({"do":"estop"})", bob, stop);
  *directory_blocked = false;
  std::map<OrderDesk::Ticket, std::string> answers;
  for (int i = 0; i < 2000 && answers.size() < 2; ++i) {
    run_control();
    desk->settle([&](OrderDesk::Ticket of, const std::string& text) { answers[of] = text; });
    sleep_until(monotonic_now() + Duration::from_ms(1));
  }
  EXPECT_THAT(answers[reset], HasSubstr("emergency stop came behind it"));
  EXPECT_THAT(done, testing::ElementsAre(Command::emergency_stop));
}

TEST_F(Desk, RestartsTheBusBesideItsOtherWork) {
  *bus_blocked = true;
  EXPECT_EQ(ask(R"({"do":"restart-bus"})", alice, true, Duration::from_ms(50)), Json("no answer"));
  EXPECT_EQ(ask(R"({"do":"estop"})", bob)["ok"], true);
  *bus_blocked = false;
  EXPECT_EQ(ask(R"({"do":"restart-bus"})", alice)["ok"], true);
  *bus_error = EBUSY;
  EXPECT_THAT(ask(R"({"do":"restart-bus"})", alice)["why"].get<std::string>(), HasSubstr("can7 was not restarted"));
}

TEST_F(Desk, RefusesAJobWithoutACameraAndNothingElse) {
  ways.no_sight = [] { return std::string("/dev/video0: there is no camera"); };
  desk = std::make_unique<OrderDesk>(*rings, ways);
  EXPECT_THAT(ask(R"({"do":"start"})", alice)["why"].get<std::string>(), HasSubstr("needs the camera"));
  EXPECT_EQ(ask(R"({"do":"home"})", alice)["ok"], true);
}

TEST(OrderGate, AnOrderIsTakenOrWithdrawnAndNeverBoth) {
  OrderGate gate;
  for (std::uint64_t n = 1; n < 200; ++n) {
    gate.offer(n);
    const bool first = n % 2 == 0 ? gate.take(n) : gate.withdraw(n);
    EXPECT_TRUE(first);
    EXPECT_FALSE(gate.take(n));
    EXPECT_FALSE(gate.withdraw(n));
  }
}

}  // namespace
}  // namespace lf::hal
