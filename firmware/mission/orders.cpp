#include "firmware/mission/orders.hpp"

#include <array>

namespace lf {

const char* name(Command command) {
  constexpr std::array<const char*, command_count> names{"start",     "home",  "hold",  "resume",    "jog",
                                                         "set tasks", "abort", "reset", "shut down", "emergency stop"};
  const auto i = static_cast<std::size_t>(command);
  return i < names.size() ? names[i] : "unknown";
}

}  // namespace lf

namespace lf::mission {

namespace {

struct Row {
  Command command;
  std::array<bool, standing_count> allowed;
};

constexpr std::array<Row, command_count> table{{
    //                        idle starting ready jogging working leaving on_hold held ended
    {Command::start, {true, false, true, false, false, false, false, false, false}},
    {Command::home, {true, false, false, false, false, false, false, false, false}},
    {Command::hold, {false, false, false, true, true, true, false, false, false}},
    {Command::resume, {false, false, false, false, false, false, true, false, false}},
    {Command::jog, {false, false, true, false, false, false, false, false, false}},
    {Command::set_tasks, {true, false, true, false, false, false, false, false, false}},
    {Command::abort, {false, true, true, true, true, false, true, false, false}},
    {Command::reset, {false, false, false, false, false, false, false, true, true}},
    {Command::shut_down, {true, true, true, true, true, true, true, true, true}},
    {Command::emergency_stop, {true, true, true, true, true, true, true, true, true}},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < command_count; ++i) {
    if (table[i].command != static_cast<Command>(i)) return false;
  }
  return true;
}
static_assert(in_order(), "one row an order, in the order of the enumeration");

}  // namespace

const char* name(Standing standing) {
  constexpr std::array<const char*, standing_count> names{"idle",    "starting", "ready", "jogging", "working",
                                                          "leaving", "on hold",  "held",  "ended"};
  const auto i = static_cast<std::size_t>(standing);
  return i < names.size() ? names[i] : "unknown";
}

Standing standing(Step step, bool on_hold) {
  if (on_hold) return Standing::on_hold;
  switch (step) {
    case Step::idle: return Standing::idle;
    case Step::boot:
    case Step::enable:
    case Step::home: return Standing::starting;
    case Step::ready: return Standing::ready;
    case Step::jog: return Standing::jogging;
    case Step::held: return Standing::held;
    default: break;
  }
  if (is_end(step)) return Standing::ended;
  return row(step).phase == safety::Phase::stow ? Standing::leaving : Standing::working;
}

bool may(Command command, Standing standing) {
  const auto i = static_cast<std::size_t>(command);
  const auto column = static_cast<std::size_t>(standing);
  return i < command_count && column < standing_count && table[i].allowed[column];
}

}  // namespace lf::mission
