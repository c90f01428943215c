// What an operator may order, and when: a table of orders against where the mission stands. What the table refuses changes nothing and is counted.
//
// docs/mission.md holds the drawing; a test draws it again from this table and compares.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/mission/mission_config.hpp"
#include "firmware/mission/steps.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf {

// An operator's order.
enum class Command : std::uint8_t {
  start,           // the job: from power-on if need be
  home,            // power up, boot, home, and wait
  hold,            // stop on the way, laser off, under power; the jaw stops, too
  resume,          // go on where it was held
  jog,             // one joint by a small angle
  set_tasks,       // another job
  abort,           // let go, go back, stow; before it is powered: power off
  reset,           // forget how the last mission ended; without power
  shut_down,       // stop, power off, stop every node: the program ends
  emergency_stop,  // the drives' quick stop
  count
};
inline constexpr std::size_t command_count = static_cast<std::size_t>(Command::count);
const char* name(Command command);

}  // namespace lf

namespace lf::mission {

using Tasks = StaticVector<Task, MissionConfig::max_tasks>;

struct Order {
  Command command = Command::start;
  std::size_t joint = 0;  // jog
  double by_rad =
      0;        // jog: at most `largest_jog_rad`, and not out of the joint's limits; where it stands outside of them, only toward them
  Tasks tasks;  // set_tasks
  // An order that is not taken by then is refused, and never executed later; an emergency stop and a shut-down never expire.
  static constexpr Time never = Time::from_ns(9223372036854775807);
  Time expires = never;
};

// A jog is for looking and for getting free, not for working: a move of which an operator sees the end.
inline constexpr double largest_jog_rad = 0.35;
inline constexpr double jog_speed_fraction = 0.25;

// Where a mission stands, as an operator sees it.
enum class Standing : std::uint8_t {
  idle,      // nothing is powered
  starting,  // boot, power-up, homing
  ready,     // powered and homed, waiting for orders
  jogging,   // a joint is being moved by hand
  working,   // at the job
  leaving,   // on the way to the park position
  on_hold,   // held by the operator somewhere in the last three
  held,      // held by a fault, under power; the mission has ended
  ended,     // parked, stopped or off
  count
};
inline constexpr std::size_t standing_count = static_cast<std::size_t>(Standing::count);
const char* name(Standing standing);

Standing standing(Step step, bool on_hold);
bool may(Command command, Standing standing);

}  // namespace lf::mission
