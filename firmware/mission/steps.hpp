// The mission's state machine as a table: every step, the phase it is safe or unsafe in, how much longer than planned it may take, and where it leads.
//
// docs/mission.md holds the drawing; a test draws it again from this table and compares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/safety/faults.hpp"

namespace lf::mission {

enum class Step : std::uint8_t {
  idle,
  boot,
  enable,
  home,
  ready,
  jog,
  check_jaw,
  free_jaw,
  back_out,
  deploy,
  scan,
  look,
  perceive,
  next_task,
  reach_valve,
  advance,
  grip,
  turn,
  let_go,
  back_off,
  verify_reach,
  verify_scan,
  verify_look,
  verify,
  reach_button,
  press,
  button_back,
  abandon,
  abandon_back,
  stow,
  shut_down,
  done,
  failed,
  held,
  stopped,
  off,
  count
};
inline constexpr std::size_t step_count = static_cast<std::size_t>(Step::count);

// The object in charge of a step.
enum class Activity : std::uint8_t { none, start_up, manual, empty_jaw, look, choose_task, turn_valve, press_button, way_home };

struct StepRow {
  Step step;
  const char* name;
  const char* stage;  // the part of the mission a user follows: boot, ready, deploy, scan, perceive, turn_valve, press_buttons, stow, end
  Activity activity;
  safety::Phase phase;  // column of the table of faults
  double margin_s;      // the step times out so long after its planned duration; 0: never
  Step on_done;
  Step on_branch;             // the step's other way out; the same as on_done where it has none
  Step on_retry;              // where it is taken again from; `count` where it is not
  Step on_end = Step::count;  // where it leads when nothing is left to do; `count` where there is always something
};

const StepRow& row(Step step);
inline bool is_end(Step step) { return step >= Step::done; }

}  // namespace lf::mission
