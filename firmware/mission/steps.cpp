#include "firmware/mission/steps.hpp"

namespace lf::mission {

namespace {

using safety::Phase;
constexpr Step never = Step::count;

// A step times out this margin after its planned duration: that of its motion, which depends on the ordered speed and the way, or of its wait. The margins
// cover planning (a sweep takes 2 s of shares) and settling; the jaw has its own time-out of 8 s, and a drive's state machine one of 2 s.
constexpr std::array<StepRow, step_count> table{{
    {Step::idle, "idle", "boot", Activity::start_up, Phase::boot, 0, Step::boot, Step::boot, never},
    {Step::boot, "boot", "boot", Activity::start_up, Phase::boot, 15, Step::enable, Step::enable, Step::boot},
    {Step::enable, "enable", "boot", Activity::start_up, Phase::free, 5, Step::home, Step::home, Step::enable},
    {Step::home, "home", "boot", Activity::start_up, Phase::free, 10, Step::check_jaw, Step::ready, Step::enable},
    {Step::ready, "ready", "ready", Activity::manual, Phase::free, 0, Step::check_jaw, Step::jog, never},
    {Step::jog, "jog", "ready", Activity::manual, Phase::free, 10, Step::ready, Step::ready, Step::ready},
    {Step::check_jaw, "check jaw", "ready", Activity::empty_jaw, Phase::contact, 20, Step::deploy, Step::free_jaw, never, Step::stow},
    {Step::free_jaw, "free jaw", "ready", Activity::empty_jaw, Phase::contact, 20, Step::back_out, Step::back_out, never},
    {Step::back_out, "back out", "ready", Activity::empty_jaw, Phase::contact, 10, Step::check_jaw, Step::check_jaw, never},
    {Step::deploy, "deploy", "deploy", Activity::look, Phase::free, 20, Step::scan, Step::scan, Step::deploy},
    {Step::scan, "scan", "scan", Activity::look, Phase::scan, 10, Step::look, Step::look, Step::deploy},
    {Step::look, "look", "scan", Activity::look, Phase::scan, 5, Step::perceive, Step::perceive, Step::look},
    {Step::perceive, "perceive", "perceive", Activity::look, Phase::free, 5, Step::next_task, Step::next_task, Step::look},
    {Step::next_task, "next task", "perceive", Activity::choose_task, Phase::free, 1, Step::reach_valve, Step::reach_button, never,
     Step::stow},
    {Step::reach_valve, "reach valve", "turn_valve", Activity::turn_valve, Phase::free, 20, Step::advance, Step::advance,
     Step::reach_valve},
    {Step::advance, "advance", "turn_valve", Activity::turn_valve, Phase::contact, 10, Step::grip, Step::grip, Step::abandon},
    {Step::grip, "grip", "turn_valve", Activity::turn_valve, Phase::contact, 20, Step::turn, Step::turn, Step::abandon},
    {Step::turn, "turn", "turn_valve", Activity::turn_valve, Phase::gripping, 10, Step::let_go, Step::let_go, Step::let_go},
    {Step::let_go, "let go", "turn_valve", Activity::turn_valve, Phase::gripping, 20, Step::back_off, Step::back_off, Step::let_go},
    {Step::back_off, "back off", "turn_valve", Activity::turn_valve, Phase::contact, 10, Step::verify_reach, Step::verify_reach,
     Step::back_off},
    {Step::verify_reach, "reach second look", "turn_valve", Activity::look, Phase::free, 20, Step::verify_scan, Step::verify_scan,
     Step::verify_reach},
    {Step::verify_scan, "second scan", "turn_valve", Activity::look, Phase::scan, 10, Step::verify_look, Step::verify_look,
     Step::verify_reach},
    {Step::verify_look, "second look", "turn_valve", Activity::look, Phase::scan, 5, Step::verify, Step::verify, Step::verify_look},
    {Step::verify, "verify", "turn_valve", Activity::look, Phase::free, 5, Step::next_task, Step::reach_valve, Step::verify_look},
    {Step::reach_button, "reach button", "press_buttons", Activity::press_button, Phase::free, 20, Step::press, Step::press,
     Step::reach_button},
    {Step::press, "press", "press_buttons", Activity::press_button, Phase::contact, 10, Step::button_back, Step::button_back,
     Step::button_back},
    {Step::button_back, "leave button", "press_buttons", Activity::press_button, Phase::contact, 10, Step::next_task, Step::reach_button,
     Step::button_back},
    {Step::abandon, "abandon", "stow", Activity::way_home, Phase::stow, 20, Step::abandon_back, Step::abandon_back, never},
    {Step::abandon_back, "abandon, back", "stow", Activity::way_home, Phase::stow, 10, Step::stow, Step::reach_valve, never},
    {Step::stow, "stow", "stow", Activity::way_home, Phase::stow, 20, Step::done, Step::failed, never},
    {Step::shut_down, "shut down", "stow", Activity::way_home, Phase::stow, 5, Step::off, Step::off, never},
    {Step::done, "done", "end", Activity::none, Phase::ended, 0, Step::done, Step::done, never},
    {Step::failed, "failed, stowed", "end", Activity::none, Phase::ended, 0, Step::failed, Step::failed, never},
    // Still under power: what stops the arm on its way to the park stops it here.
    {Step::held, "held", "end", Activity::none, Phase::stow, 0, Step::held, Step::held, never},
    {Step::stopped, "stopped", "end", Activity::none, Phase::ended, 0, Step::stopped, Step::stopped, never},
    {Step::off, "off", "end", Activity::none, Phase::ended, 0, Step::off, Step::off, never},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < step_count; ++i) {
    if (table[i].step != static_cast<Step>(i)) return false;
  }
  return true;
}
static_assert(in_order(), "one row a step, in the order of the enumeration");

}  // namespace

const StepRow& row(Step step) {
  const auto i = static_cast<std::size_t>(step);
  return table[i < step_count ? i : static_cast<std::size_t>(Step::off)];
}

}  // namespace lf::mission
