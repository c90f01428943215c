#include "firmware/mission/steps.hpp"

namespace lf::mission {

namespace {

using safety::Phase;
constexpr Step never = Step::count;

// Time-outs are about three times what the step takes in the default scenario.
constexpr std::array<StepRow, step_count> table{{
    {Step::idle, "idle", "boot", Phase::boot, 0, Step::boot, Step::boot, never},
    {Step::boot, "boot", "boot", Phase::boot, 15, Step::enable, Step::enable, Step::boot},
    {Step::enable, "enable", "boot", Phase::boot, 5, Step::home, Step::home, Step::enable},
    {Step::home, "home", "boot", Phase::free, 30, Step::deploy, Step::ready, Step::enable},
    {Step::ready, "ready", "ready", Phase::free, 0, Step::deploy, Step::jog, never},
    {Step::jog, "jog", "ready", Phase::free, 60, Step::ready, Step::ready, Step::ready},
    {Step::deploy, "deploy", "deploy", Phase::free, 40, Step::scan, Step::scan, Step::deploy},
    {Step::scan, "scan", "scan", Phase::scan, 60, Step::look, Step::look, Step::deploy},
    {Step::look, "look", "scan", Phase::scan, 5, Step::perceive, Step::perceive, Step::look},
    {Step::perceive, "perceive", "perceive", Phase::free, 10, Step::next_task, Step::next_task, Step::look},
    {Step::next_task, "next task", "perceive", Phase::free, 1, Step::reach_valve, Step::reach_button, never, Step::stow},
    {Step::reach_valve, "reach valve", "turn_valve", Phase::free, 60, Step::advance, Step::advance, Step::reach_valve},
    {Step::advance, "advance", "turn_valve", Phase::contact, 20, Step::grip, Step::grip, Step::abandon},
    {Step::grip, "grip", "turn_valve", Phase::contact, 20, Step::turn, Step::turn, Step::abandon},
    {Step::turn, "turn", "turn_valve", Phase::gripping, 40, Step::let_go, Step::let_go, Step::let_go},
    {Step::let_go, "let go", "turn_valve", Phase::gripping, 20, Step::back_off, Step::back_off, Step::let_go},
    {Step::back_off, "back off", "turn_valve", Phase::contact, 20, Step::verify_reach, Step::verify_reach, Step::back_off},
    {Step::verify_reach, "reach second look", "turn_valve", Phase::free, 40, Step::verify_scan, Step::verify_scan, Step::verify_reach},
    {Step::verify_scan, "second scan", "turn_valve", Phase::scan, 40, Step::verify_look, Step::verify_look, Step::verify_reach},
    {Step::verify_look, "second look", "turn_valve", Phase::scan, 5, Step::verify, Step::verify, Step::verify_look},
    {Step::verify, "verify", "turn_valve", Phase::free, 10, Step::next_task, Step::reach_valve, Step::verify_look},
    {Step::reach_button, "reach button", "press_buttons", Phase::free, 60, Step::press, Step::press, Step::reach_button},
    {Step::press, "press", "press_buttons", Phase::contact, 30, Step::button_back, Step::button_back, Step::button_back},
    {Step::button_back, "leave button", "press_buttons", Phase::contact, 20, Step::next_task, Step::reach_button, Step::button_back},
    {Step::abandon, "abandon", "stow", Phase::stow, 20, Step::abandon_back, Step::abandon_back, never},
    {Step::abandon_back, "abandon, back", "stow", Phase::stow, 20, Step::stow, Step::reach_valve, never},
    {Step::stow, "stow", "stow", Phase::stow, 60, Step::done, Step::failed, never},
    {Step::shut_down, "shut down", "stow", Phase::stow, 5, Step::off, Step::off, never},
    {Step::done, "done", "end", Phase::ended, 0, Step::done, Step::done, never},
    {Step::failed, "failed, stowed", "end", Phase::ended, 0, Step::failed, Step::failed, never},
    // Still under power: what stops the arm on its way to the park stops it here.
    {Step::held, "held", "end", Phase::stow, 0, Step::held, Step::held, never},
    {Step::stopped, "stopped", "end", Phase::ended, 0, Step::stopped, Step::stopped, never},
    {Step::off, "off", "end", Phase::ended, 0, Step::off, Step::off, never},
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
