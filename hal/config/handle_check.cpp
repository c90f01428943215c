#include "hal/config/handle_check.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/tool_place.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/nearest.hpp"
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

void check_stops(const PanelSurvey& survey, std::size_t valve, const PanelLayout::Valve& layout, std::vector<std::string>& problems) {
  const std::string low = valve_key(survey, valve, "stop_min_deg"), high = valve_key(survey, valve, "stop_max_deg");
  if (layout.handle_min_rad >= layout.handle_max_rad) {
    problems.push_back(low + " is not below " + high);
    return;
  }
  if (deg_from_rad(layout.handle_max_rad - layout.handle_min_rad) > widest_range_deg + 1e-9)
    problems.push_back(low + " and " + high + " are more than " + number(widest_range_deg) +
                       " degrees apart: no look tells an angle from the one a turn on");
}

std::string missing(const char* what, const std::string& name, const std::vector<std::string>& names) {
  const std::string near = suggestion(name, names);
  return std::string("the panel has no ") + what + " '" + name + "'" +
         (near.empty() ? "; it has " + (names.empty() ? "none" : joined(names, ", ")) : near);
}

void check_tasks(const Machine& machine, std::vector<std::string>& problems) {
  const PanelNames& names = machine.survey.names;
  for (const Task& task : machine.tasks) {
    if (task.kind == Task::Kind::press_buttons) {
      for (const std::string& name : task.order) {
        if (!find_button(names, name)) problems.push_back("'press_buttons.order': " + missing("button", name, names.buttons));
      }
      continue;
    }
    const std::optional<std::size_t> valve = find_valve(names, task.valve);
    if (!valve && task.valve.empty()) {
      problems.push_back(names.valves.empty() ? "'turn_valve': the panel has no valve"
                                              : "'turn_valve.valve' is missing: the panel has " + joined(names.valves, ", "));
      continue;
    }
    if (!valve) {
      problems.push_back("'turn_valve.valve': " + missing("valve", task.valve, names.valves));
      continue;
    }
    const PanelLayout::Valve& layout = machine.panel.valves[*valve];
    const double low_deg = deg_from_rad(layout.handle_min_rad), high_deg = deg_from_rad(layout.handle_max_rad),
                 to_rad = rad_from_deg(task.to_deg);
    if (low_deg >= high_deg || (to_rad >= layout.handle_min_rad && to_rad <= layout.handle_max_rad)) continue;
    problems.push_back("'turn_valve.to_deg' is " + number(task.to_deg) + ", beyond " + valve_text(names, *valve) + "'s stops at " +
                       number(low_deg) + " and " + number(high_deg));
  }
}

double tilt_at_bar_rad(const Machine& machine, std::size_t valve) { return steepest_rad(machine, place_of_valve(machine, valve)); }

// The tips of an open jaw reach beyond the bar, and more so on the side to which the tool is tilted. Below them the panel keeps a centimetre.
double lowest_bar_m(const ArmModel::Jaw& jaw, const PanelLayout::Valve& valve, double tilt_rad) {
  constexpr double finger_m = 0.020;
  constexpr double clear_m = 0.010;
  const double opening_m = arm::jaw_opening_m(jaw, valve.handle_thickness_m);
  return arm::tip_beyond_tool_m(jaw, arm::jaw_from_gap(jaw, opening_m)) + (opening_m / 2 + finger_m) * std::sin(tilt_rad) + clear_m;
}

void check_bar(const Machine& machine, std::size_t i, std::vector<std::string>& problems) {
  const PanelLayout::Valve& valve = machine.panel.valves[i];
  const auto key = [&](const char* field) { return valve_key(machine.survey, i, field); };
  const double tilt_rad = tilt_at_bar_rad(machine, i), lowest_m = lowest_bar_m(machine.arm.jaw(), valve, tilt_rad);
  if (valve.handle_height_m < lowest_m)
    problems.push_back(key("height_m") + " is " + number(valve.handle_height_m) + ": the open jaw would touch the panel below " +
                       number(lowest_m) + " m with a bar of this " + key("thickness_m") +
                       aslant_text(machine.panel, machine.mission.docking, tilt_rad));
  const double thickest_m = thickest_bar_m(machine.arm.jaw(), valve);
  const double thinnest_m = arm::thinnest_bar_m(machine.arm.jaw());
  if (valve.handle_thickness_m < thinnest_m)
    problems.push_back(key("thickness_m") + " is " + number(valve.handle_thickness_m) + ": the jaw does not tell a bar thinner than " +
                       number(thinnest_m) + " m from nothing");
  if (thickest_m <= 0)
    problems.push_back(key("thickness_m") + ": this jaw takes no bar at all, it opens to " +
                       number(arm::gap_from_jaw(machine.arm.jaw(), machine.arm.jaw().upper_rad)) + " m");
  else if (valve.handle_thickness_m > thickest_m)
    problems.push_back(key("thickness_m") + " is " + number(valve.handle_thickness_m) + ": a bar of this " + key("length_m") + " can be " +
                       number(thickest_m) + " m thick, else its angle cannot be seen or the jaw does not open for it");
  constexpr double beside_pads_m = 0.006;
  const double between_m = valve.handle_length_m - 2 * valve.handle_thickness_m, wide_m = machine.arm.jaw().pad_width_m + 2 * beside_pads_m;
  if (valve.carried == PanelLayout::Carried::by_posts && between_m < wide_m)
    problems.push_back(key("length_m") + " is " + number(valve.handle_length_m) + ": between its posts there are " + number(between_m) +
                       " m, and the jaw's pads need " + number(wide_m));
  if (valve.has_pointer() && valve.pointer_length_m > longest_mark_m(valve))
    problems.push_back(key("pointer_length_m") + " is " + number(valve.pointer_length_m) + ": more than " + number(longest_mark_m(valve)) +
                       " m of a bar of this " + key("length_m") + " would not tell its ends apart");
}

// The hand that turns a bar stands about its axis with the jaw open, and keeps clear of the circle in which a bar beside it turns. Bars nearer than 12 mm to each other are
// one to the scan.
void check_neighbours(const Machine& machine, std::size_t i, std::vector<std::string>& problems) {
  constexpr double fingers_m = 0.032;     // from an open pad's face to the outer side of its finger's capsule
  constexpr double clear_m = 0.016;       // what a motion keeps off, 10 mm, and what the look leaves in doubt
  constexpr double told_apart_m = 0.020;  // the 12 mm, and the scan's noise
  const PanelLayout::Valve& valve = machine.panel.valves[i];
  const double hand_m = arm::jaw_opening_m(machine.arm.jaw(), valve.handle_thickness_m) / 2 + fingers_m + clear_m;
  for (std::size_t j = 0; j < machine.panel.valves.size(); ++j) {
    if (j == i) continue;
    const PanelLayout::Valve& other = machine.panel.valves[j];
    const double apart_m = (valve.at_m - other.at_m).norm();
    const double least_m = other.swept_radius_m() + std::max(hand_m, valve.swept_radius_m() + told_apart_m);
    if (apart_m < least_m)
      problems.push_back(valve_key(machine.survey, i, "at_m") + ": " + valve_text(machine.survey.names, i) + " stands " + number(apart_m) +
                         " m from " + valve_text(machine.survey.names, j) + ": the hand that turns it needs " + number(least_m));
  }
}

}  // namespace

double thickest_bar_m(const ArmModel::Jaw& jaw, const PanelLayout::Valve& valve) {
  return std::min(arm::thickest_bar_m(jaw), valve.handle_length_m / shortest_over_thickness);
}

double longest_mark_m(const PanelLayout::Valve& valve) { return valve.handle_length_m / 2 - bare_beyond_middle_m; }

std::vector<std::string> handle_problems(const Machine& machine) {
  std::vector<std::string> problems;
  if (!arm::can_work(machine.arm)) return problems;  // nothing is turned or pressed
  for (std::size_t i = 0; i < machine.panel.valves.size(); ++i) check_stops(machine.survey, i, machine.panel.valves[i], problems);
  check_tasks(machine, problems);
  // What nobody turns may be what it is, but for the docked mission's: its keys say what a hand can work.
  for (std::size_t i = 0; i < machine.panel.valves.size(); ++i) {
    if (!machine.survey.file.empty() && !turns(machine, i)) continue;
    check_bar(machine, i, problems);
    check_neighbours(machine, i, problems);
  }
  return problems;
}

}  // namespace lf::config
