#include "hal/vehicle/order_desk.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "hal/vehicle/tick_clock.hpp"

namespace lf::hal {

namespace {

// A control period is 4 ms; a machine that is busy takes some more.
constexpr Duration take_within = Duration::from_ms(500);
// Of a user's name and groups, from whatever directory this machine asks.
constexpr Duration look_up_within = Duration::from_s(3);
// The kernel's answer comes within a second, and a restart may wait behind another.
constexpr Duration restart_within = Duration::from_s(3);
// Of a line that is no request, in the log.
constexpr std::size_t longest_logged = 200;
constexpr std::size_t most_waiting = 48;

Json refused(const std::string& why) { return {{"ok", false}, {"why", why}}; }

// Of an order that the mission's standing allows, and that was refused all the same.
std::string why_not(Command command) {
  switch (command) {
    case Command::start: return "a joint stands outside its limits: jog it back first";
    case Command::jog:
      return "it leads out of the joint's limits or the tool out of its workspace, the jaw may hold something (open it, or close it to its "
             "stop, first), or another order is being taken";
    default: return "it came too late, or another order is being taken";
  }
}

// What brings the mission to where it takes the order; empty where nothing has to, or where another order is meant.
const char* remedy(Command command, mission::Standing standing) {
  using enum mission::Standing;
  const bool for_idle = command == Command::start || command == Command::home || command == Command::set_tasks;
  switch (standing) {
    case idle: return command == Command::jog ? "`home` first" : "";
    case starting: return for_idle || command == Command::jog ? "wait until it is ready" : "";
    case ready: return command == Command::home ? "the arm is homed" : "";
    case jogging: return for_idle || command == Command::jog ? "wait until the jog is done" : "";
    case working:
    case leaving: return for_idle || command == Command::jog ? "wait until it has ended, or `abort` first" : "";
    case on_hold: return for_idle || command == Command::jog || command == Command::hold ? "`resume` or `abort` first" : "";
    case held:
    case ended:
      if (command == Command::jog) return "`reset` first, then `home`";
      return for_idle ? "`reset` first" : "";
    default: return "";
  }
}

Json answer_of(const OrderAnswer& answer, Command command) {
  Json reply{{"ok", answer.taken}, {"standing", mission::name(answer.standing)}};
  if (answer.taken) return reply;
  if (answer.commissioning) {
    reply["standing"] = "commissioning";
    reply["why"] = "not while the arm is being commissioned: `abort` calls it off";
    return reply;
  }
  const bool possible = mission::may(command, answer.standing);
  if (possible) {
    reply["why"] = why_not(command);
    return reply;
  }
  const std::string first = remedy(command, answer.standing);
  reply["why"] = std::string("not while the mission is ") + mission::name(answer.standing) + (first.empty() ? "" : ": " + first);
  return reply;
}

bool asks_for_power(Command command) { return command == Command::start || command == Command::home || command == Command::jog; }

bool is(const OperatorRequest& request, std::string_view name) { return name == request.right->request; }

}  // namespace

OrderDesk::OrderDesk(LoopRings& rings, Ways ways) : rings_(rings), ways_(std::move(ways)), users_(ways_.look_up) {}

bool OrderDesk::is_stop(std::string_view line) {
  if (line.find("estop") == std::string_view::npos) return false;
  const ParsedOrder parsed = parse_order(line);
  const auto* request = std::get_if<OperatorRequest>(&parsed);
  return request != nullptr && is(*request, "estop");
}

std::optional<std::string> OrderDesk::take(const std::string& line, unsigned user, Ticket ticket) {
  Waiting one;
  one.ticket = ticket;
  one.line = line;
  one.user = user;
  one.since = monotonic_now();
  one.stops_before = stops_given_;
  ParsedOrder parsed = parse_order(line, ways_.names, ways_.joints);
  if (const auto* why = std::get_if<std::string>(&parsed)) return finish(one, refused(*why));
  one.request = std::get<OperatorRequest>(parsed);
  if (const std::optional<Json> answer = judge(one)) return finish(one, *answer);
  waiting_.push_back(std::move(one));
  return std::nullopt;
}

// What everybody may do waits for nobody's name.
std::optional<Json> OrderDesk::judge(Waiting& one) {
  const std::optional<User> user = users_.find(one.user, monotonic_now());
  if (user || one.request.right->least == Role::watcher) return begin(one, user.value_or(User{}));
  if (waiting_.size() >= most_waiting) return refused("too many orders at once");
  one.waits = Waits::for_user;
  return std::nullopt;
}

std::optional<Json> OrderDesk::begin(Waiting& one, const User& user) {
  const Right& right = *one.request.right;
  if (user.role < right.least)
    return refused(std::string(name(user.role)) + " may not '" + right.request + "': it takes " + name(right.least));
  if (one.request.for_the_core) return give(one);
  if (is(one.request, "restart-bus")) {
    one.bus = std::make_shared<std::optional<int>>();
    const bool posted = worker_.post([mutex = bus_mutex_, result = one.bus, restart = ways_.restart_bus] {
      const int error = restart();
      const std::lock_guard lock(*mutex);
      *result = error;
    });
    if (!posted) return refused("too many restarts at once");
    one.waits = Waits::for_bus;
    one.since = monotonic_now();
    return std::nullopt;
  }
  if (is(one.request, "commission")) return begin_commissioning(one);
  Json reply = ways_.status();
  reply["ok"] = true;
  return reply;
}

std::optional<Json> OrderDesk::begin_commissioning(Waiting& one) {
  if (ways_.commissioner == nullptr) return refused("there is nothing to commission here");
  if (const std::optional<std::string> why = ways_.commissioner->begin(one.request.commission, one.since)) return refused(*why);
  one.waits = Waits::for_commissioner;
  return std::nullopt;
}

// Stops have a ring of their own: no order keeps one out.
std::optional<Json> OrderDesk::give(Waiting& one) {
  const Command command = one.request.order.command;
  const std::string unknown = ways_.commissioner != nullptr ? ways_.commissioner->unknown_joints() : "";
  if (asks_for_power(command) && !unknown.empty()) return refused("no power without a known zero: commission " + unknown + " first");
  if (asks_for_power(command) && ways_.commissioner != nullptr) {
    if (const std::optional<std::string> why = ways_.commissioner->why_no_power()) return refused(*why);
  }
  if (const std::string blind = command == Command::start && ways_.no_sight ? ways_.no_sight() : ""; !blind.empty())
    return refused("a job needs the camera: " + blind);
  const std::string beyond = command == Command::set_tasks && ways_.why_not ? ways_.why_not(one.request.order.tasks) : "";
  if (!beyond.empty()) return refused(beyond);
  const bool stop = command == Command::emergency_stop;
  one.called_off = ways_.commissioner != nullptr && ways_.commissioner->call_off_before_it_moves("another order came before it began");
  if (!stop && waiting_.size() >= most_waiting) return refused("too many orders at once");
  if (!stop) one.request.order.expires = monotonic_now() + take_within;  // the core refuses what it meets later
  one.number = ++orders_given_;
  if (!stop) rings_.gate.offer(one.number);
  if (stop) ++stops_given_;
  const bool handed = (stop ? rings_.stops : rings_.orders).push({one.number, one.request.order});
  if (!handed && !stop) return refused("too many orders at once");
  if (!handed) return Json{{"ok", true}, {"standing", "stops before this one are still to be taken"}};
  one.waits = Waits::for_control;
  one.since = monotonic_now();
  return std::nullopt;
}

void OrderDesk::settle(const Reply& reply) {
  for (OrderAnswer answer; rings_.answers.pop(answer);) answers_.push_back(answer);
  drop_those_of_clients_gone();
  // An answer may lead to another line being taken, and that to another entry: the list is taken out meanwhile.
  std::vector<Waiting> before;
  before.swap(waiting_);
  for (Waiting& one : before) {
    if (const std::optional<Json> answer = look_again(one)) {
      reply(one.ticket, finish(one, *answer));
    } else {
      waiting_.push_back(std::move(one));
    }
  }
  answers_.clear();
}

// Whoever ordered a motion of the arm and left may be on the way to it. Other orders act within half a second, or not at all.
void OrderDesk::drop_those_of_clients_gone() {
  for (const Ticket ticket : std::exchange(gone_, {})) {
    for (Waiting& one : waiting_) {
      if (one.ticket != ticket || !is(one.request, "commission")) continue;
      one.gone = true;
      if (one.waits == Waits::for_commissioner) (void)ways_.commissioner->call_off_before_it_moves("who ordered it has gone");
    }
  }
}

std::optional<Json> OrderDesk::look_again(Waiting& one) {
  if (one.waits == Waits::for_control) return await_control(one);
  if (one.waits == Waits::for_bus) return await_bus(one);
  if (one.waits == Waits::for_commissioner) return ways_.commissioner->answer();
  if (one.gone) return refused("who ordered it has gone: nothing moves");
  // A reset that was given before a stop would take it back, and power could follow.
  if (stops_given_ != one.stops_before) return refused("an emergency stop came behind it: it was not carried out");
  if (const std::optional<User> user = users_.find(one.user, monotonic_now())) return begin(one, *user);
  if (monotonic_now() - one.since < look_up_within) return std::nullopt;
  return refused("this machine does not say in time who user " + std::to_string(one.user) + " is: ask again");
}

std::optional<Json> OrderDesk::await_control(Waiting& one) {
  for (const OrderAnswer& answer : answers_) {
    if (answer.number != one.number) continue;
    const bool nothing_else = !answer.taken && !answer.commissioning &&
                              (answer.standing == mission::Standing::idle || answer.standing == mission::Standing::ended);
    if (one.called_off && one.request.order.command == Command::abort && nothing_else)
      return Json{{"ok", true}, {"standing", mission::name(answer.standing)}, {"note", "the commissioning is called off before it began"}};
    return answer_of(answer, one.request.order.command);
  }
  if (monotonic_now() - one.since < take_within) return std::nullopt;
  if (one.request.order.command == Command::emergency_stop) return refused("the control thread does not answer; the stop remains ordered");
  if (!one.taken && rings_.gate.withdraw(one.number))
    return refused("the control thread does not answer: the order was withdrawn, it will not run");
  // It was taken at the last moment: its answer is on the way.
  if (!std::exchange(one.taken, true)) {
    one.since = monotonic_now();
    return std::nullopt;
  }
  return refused("the control thread took the order and does not answer: look at its status");
}

std::optional<Json> OrderDesk::await_bus(Waiting& one) {
  std::optional<int> error;
  {
    const std::lock_guard lock(*bus_mutex_);
    error = *one.bus;
  }
  if (!error && monotonic_now() - one.since < restart_within) return std::nullopt;
  if (!error) return refused("the kernel does not answer");
  return *error == 0 ? Json{{"ok", true}} : refused(ways_.interface + " was not restarted: " + std::strerror(*error));
}

std::string OrderDesk::finish(const Waiting& one, const Json& answer) {
  const bool request = one.request.right != nullptr;
  if (!request || !is(one.request, "status")) {
    const User user = users_.find(one.user, monotonic_now()).value_or(User{"user " + std::to_string(one.user), Role::watcher});
    ways_.log({{"t_s", monotonic_now().s()},
               {"kind", "order"},
               {"order", request ? Json::parse(one.line) : Json(one.line.substr(0, longest_logged))},
               {"by", user.name},
               {"role", name(user.role)},
               {"answer", answer}});
  }
  return answer.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lf::hal
