#include "hal/config/panel_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/mission/press_button.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

constexpr std::array<const char*, PanelLayout::button_count> button_names{"left", "centre", "right"};

// From a point to a square about the origin, 0 inside of it.
double distance_to_square(const Vec2& point, double side) {
  const Vec2 outside = (point.cwiseAbs() - Vec2::Constant(side / 2)).cwiseMax(0.0);
  return outside.norm();
}

std::string millimetres(double m) {
  std::array<char, 32> text;
  (void)std::snprintf(text.data(), text.size(), "%.1f mm", 1e3 * m);
  return text.data();
}

bool inside_plate(const PanelLayout& panel, const Vec2& centre, double half) {
  const Vec2 low = centre - Vec2::Constant(half), high = centre + Vec2::Constant(half);
  return (low.array() >= panel.plate_min_m.array()).all() && (high.array() <= panel.plate_max_m.array()).all();
}

// From the valve's axis to the farthest corner of its bar.
double turning_bar_m(const PanelLayout& panel) { return std::hypot(panel.handle_length_m, panel.handle_thickness_m) / 2; }

bool plate_fits(const PanelLayout& panel, double side) {
  const bool free = std::all_of(panel.buttons_m.begin(), panel.buttons_m.end(), [&](const Vec2& button) {
    return distance_to_square(button - panel.marker_centre_m, side) >= panel.button_width_m / 2;
  });
  return free && distance_to_square(-panel.marker_centre_m, side) >= turning_bar_m(panel) &&
         inside_plate(panel, panel.marker_centre_m, side / 2);
}

// How aslant the tool comes to the buttons: to that one to which it does most.
double steepest_button_rad(const PanelLayout& panel, const mission::MissionConfig& mission) {
  double tilt_rad = 0;
  for (std::uint8_t button = 0; button < PanelLayout::button_count; ++button)
    tilt_rad = std::max(tilt_rad, steepest_rad(panel, place_of_button(panel, button), mission.docking));
  return tilt_rad;
}

}  // namespace

double largest_marker_plate_m(const PanelLayout& panel) {
  double fits = 0, does_not = 10;
  for (int i = 0; i < 50; ++i) {
    const double side = (fits + does_not) / 2;
    (plate_fits(panel, side) ? fits : does_not) = side;
  }
  return fits;
}

// In simulation caps of 5 to 6 mm with a stroke of 5 mm let the fingers meet the panel beside them, and of 12 mm a broken-off one was told as pressed.
double lowest_button_m(const PanelLayout& panel, const mission::MissionConfig& mission) {
  constexpr double corner_m = 0.028;  // from the middle of the closed fingers' tips to a corner: pads of 40 mm, 40 mm thick together
  constexpr double doubt_m = 0.0036;  // of the face by the look, 3 mm, and of the tip by the joints, 2 mm, added in squares
  const double tilt_rad = steepest_button_rad(panel, mission);
  return panel.button_stroke_m + std::min(mission.press_overtravel_m, mission::press_face_m) + corner_m * std::sin(tilt_rad) + doubt_m;
}

bool presses(const std::vector<Task>& tasks) {
  return std::any_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.kind == Task::Kind::press_buttons; });
}

std::vector<std::string> low_button_problems(const Machine& machine) {
  const PanelLayout& panel = machine.panel;
  const double overtravel_m = machine.mission.press_overtravel_m, lowest_m = lowest_button_m(panel, machine.mission);
  if (!presses(machine.tasks) || panel.button_height_m >= lowest_m) return {};
  std::array<char, 400> text;
  (void)std::snprintf(
      text.data(), text.size(),
      "'panel.button_height_m' is %.4g: with 'panel.button_stroke_m' at %.4g and 'mission.press_overtravel_m' at %.4g the "
      "fingers could press the panel instead of the button, and take it for the button. Caps at these 'panel.buttons_m' need %.4f m",
      panel.button_height_m, panel.button_stroke_m, overtravel_m, lowest_m);
  return {text.data() + aslant_text(panel, machine.mission.docking, steepest_button_rad(panel, machine.mission))};
}

std::vector<std::string> panel_problems(const PanelLayout& panel) {
  std::vector<std::string> problems;
  const std::string plate = ": see 'panel.plate_min_m', 'panel.plate_max_m'";
  const double radius = panel.button_width_m / 2, bar_m = turning_bar_m(panel);
  const double under_m = bar_m - distance_to_square(-panel.marker_centre_m, panel.marker_plate_m);
  if (under_m > 0)
    problems.push_back("'panel.marker_centre_m': the turning bar covers the marker's plate by " + millimetres(under_m) +
                       ": no look would find the marker. See 'panel.handle_length_m', 'panel.handle_thickness_m' and "
                       "'panel.marker_plate_m'");
  for (std::size_t i = 0; i < PanelLayout::button_count; ++i) {
    const std::string name = std::string("'panel.buttons_m': the ") + button_names[i] + " button";
    const double gap = distance_to_square(panel.buttons_m[i] - panel.marker_centre_m, panel.marker_plate_m) - radius;
    if (gap < 0) {
      problems.push_back(name + " covers the marker's plate by " + millimetres(-gap) +
                         ": no look would find the marker. See 'panel.button_width_m', 'panel.marker_centre_m' and 'panel.marker_plate_m'");
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double between = (panel.buttons_m[i] - panel.buttons_m[j]).norm() - 2 * radius;
      if (between < 0)
        problems.push_back(name + " and the " + button_names[j] + " one overlap by " + millimetres(-between) +
                           ": see 'panel.button_width_m'");
    }
    const double turned_over_m = bar_m + radius - panel.buttons_m[i].norm();
    if (turned_over_m > 0)
      problems.push_back(name + " lies " + millimetres(turned_over_m) +
                         " under the turning bar: see 'panel.button_width_m', 'panel.handle_length_m' and 'panel.handle_thickness_m'");
    if (!inside_plate(panel, panel.buttons_m[i], radius))
      problems.push_back(name + " hangs beyond the plate" + plate + " and 'panel.button_width_m'");
  }
  if (!inside_plate(panel, panel.marker_centre_m, panel.marker_plate_m / 2))
    problems.push_back("'panel.marker_centre_m': the marker's plate hangs beyond the panel's" + plate + " and 'panel.marker_plate_m'");
  return problems;
}

}  // namespace lf::config
