#include "hal/config/handle_check.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "firmware/arm/gripper.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

// The mark's edge is looked for 3 mm to either side of its place, and has to stay on its own half of the bar.
constexpr double bare_beyond_middle_m = 0.005;
// The pads are 40 mm wide, and the scan tells a bar's angle from its length over its thickness: at half this ratio its points are a blot.
constexpr double shortest_over_thickness = 2;

std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 4);
  return std::string(text, end.ptr);
}

void check_stops(const ValveStops& stops, const std::vector<Task>& tasks, std::vector<std::string>& problems) {
  if (stops.stop_min_deg >= stops.stop_max_deg) {
    problems.emplace_back("'valve.stop_min_deg' is not below 'valve.stop_max_deg'");
    return;
  }
  if (stops.stop_max_deg - stops.stop_min_deg > widest_range_deg)
    problems.push_back("'valve.stop_min_deg' and 'valve.stop_max_deg' are more than " + number(widest_range_deg) +
                       " degrees apart: no look tells an angle from the one a turn on");
  for (const Task& task : tasks) {
    if (task.kind != Task::Kind::turn_valve || (task.to_deg >= stops.stop_min_deg && task.to_deg <= stops.stop_max_deg)) continue;
    problems.push_back("'turn_valve.to_deg' is " + number(task.to_deg) + ", beyond the valve's stops at " + number(stops.stop_min_deg) +
                       " and " + number(stops.stop_max_deg));
  }
}

double tilt_at_bar_rad(const PanelLayout& panel, const arm::PanelDoubt& docking) {
  return steepest_rad(panel, {"the valve", Vec3(0, 0, panel.handle_height_m), 0}, docking);
}

// The tips of an open jaw reach beyond the bar, and more so on the side to which the tool is tilted. Below them the panel keeps a centimetre.
double lowest_bar_m(const PanelLayout& panel, const arm::PanelDoubt& docking) {
  constexpr double finger_m = 0.020;
  constexpr double clear_m = 0.010;
  const double opening_m = arm::jaw_opening_m(panel.handle_thickness_m);
  const double tilt_rad = tilt_at_bar_rad(panel, docking);
  return arm::tip_beyond_tool_m(arm::jaw_from_gap(opening_m)) + (opening_m / 2 + finger_m) * std::sin(tilt_rad) + clear_m;
}

void check_bar(const PanelLayout& panel, const arm::PanelDoubt& docking, std::vector<std::string>& problems) {
  const double lowest_m = lowest_bar_m(panel, docking);
  if (panel.handle_height_m < lowest_m)
    problems.push_back("'panel.handle_height_m' is " + number(panel.handle_height_m) + ": the open jaw would touch the panel below " +
                       number(lowest_m) + " m with a bar of this 'panel.handle_thickness_m'" +
                       aslant_text(panel, docking, tilt_at_bar_rad(panel, docking)));
  const double thickest_m = thickest_bar_m(panel);
  if (panel.handle_thickness_m < arm::thinnest_bar_m)
    problems.push_back("'panel.handle_thickness_m' is " + number(panel.handle_thickness_m) + ": the jaw does not tell a bar thinner than " +
                       number(arm::thinnest_bar_m) + " m from nothing");
  if (panel.handle_thickness_m > thickest_m)
    problems.push_back("'panel.handle_thickness_m' is " + number(panel.handle_thickness_m) +
                       ": a bar of this 'panel.handle_length_m' can be " + number(thickest_m) +
                       " m thick, else its angle cannot be seen or the jaw does not open for it");
  if (panel.pointer != PanelLayout::Pointer::none && panel.pointer_length_m > longest_mark_m(panel))
    problems.push_back("'panel.pointer_length_m' is " + number(panel.pointer_length_m) + ": more than " + number(longest_mark_m(panel)) +
                       " m of a bar of this 'panel.handle_length_m' would not tell its ends apart");
}

}  // namespace

double thickest_bar_m(const PanelLayout& panel) { return std::min(arm::thickest_bar_m(), panel.handle_length_m / shortest_over_thickness); }

double longest_mark_m(const PanelLayout& panel) { return panel.handle_length_m / 2 - bare_beyond_middle_m; }

std::vector<std::string> handle_problems(const Machine& machine) {
  std::vector<std::string> problems;
  check_stops(machine.valve, machine.tasks, problems);
  check_bar(machine.panel, machine.mission.docking, problems);
  return problems;
}

}  // namespace lf::config
