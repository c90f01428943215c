#include "host_sim/scenario/duration.hpp"

#include <algorithm>

namespace lf::scenario {

namespace {

constexpr double longest_s = 7200;  // of the key time_limit_s
constexpr double start_up_s = 60;   // boot, homing, planning, panel vision: 30 s were seen
constexpr double tried_twice = 2;
constexpr double sweep_rad = 0.8;  // of the slowest joint over the panel: 0.5 was seen
constexpr double free_way_s = 6;   // at the joints' full speed: 4 s were seen
constexpr double jaw_s = 16;       // closing and opening, each with a time-out of 8 s

}  // namespace

double longest_mission_s(const Scenario& scenario) {
  const mission::MissionConfig& m = scenario.mission;
  const double straight_s = 2 * m.approach_distance_m / m.approach_speed_m_s;  // there and back
  const double free_s = 2 * free_way_s / m.move_speed_fraction;
  const double sweep_s = sweep_rad / m.sweep_speed_rad_s;
  double needed_s = start_up_s + free_s + sweep_s;
  for (const Task& task : scenario.tasks) {
    if (task.kind == Task::Kind::turn_valve) {
      const PanelLayout::Valve& valve = scenario.panel.valves[config::find_valve(scenario.survey.names, task.valve).value_or(0)];
      const double turn_s = (valve.handle_max_rad - valve.handle_min_rad) / m.turn_speed_rad_s;
      needed_s += tried_twice * (free_s + straight_s + turn_s + jaw_s + sweep_s);
    } else {
      double longest_m = 0;
      for (const PanelLayout::Button& button : scenario.panel.buttons) longest_m = std::max(longest_m, button.stroke_m);
      const double press_s = 2 * (longest_m + m.press_overtravel_m) / m.press_speed_m_s;
      needed_s += tried_twice * static_cast<double>(task.order.size()) * (free_s + straight_s + press_s);
    }
  }
  return std::min(needed_s, longest_s);
}

}  // namespace lf::scenario
