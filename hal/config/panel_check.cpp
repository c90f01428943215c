#include "hal/config/panel_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/arm/tool_place.hpp"
#include "firmware/mission/press_button.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

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

bool plate_fits(const PanelLayout& panel, const PanelLayout::Marker& marker, double side) {
  const bool free = std::all_of(panel.buttons.begin(), panel.buttons.end(), [&](const PanelLayout::Button& button) {
    return distance_to_square(button.at_m - marker.centre_m, side) >= button.width_m / 2;
  });
  const bool not_under_a_bar = std::all_of(panel.valves.begin(), panel.valves.end(), [&](const PanelLayout::Valve& valve) {
    return distance_to_square(valve.at_m - marker.centre_m, side) >= valve.swept_radius_m();
  });
  return free && not_under_a_bar && inside_plate(panel, marker.centre_m, side / 2);
}

// How aslant the tool comes to a button like this one: of all such, to the one to which it does most.
double steepest_button_rad(const Machine& machine, const PanelLayout::Button& like) {
  double tilt_rad = 0;
  for (std::size_t i = 0; i < machine.panel.buttons.size(); ++i) {
    const PanelLayout::Button& button = machine.panel.buttons[i];
    const bool alike = button.width_m == like.width_m && button.height_m == like.height_m && button.stroke_m == like.stroke_m;
    if (alike) tilt_rad = std::max(tilt_rad, steepest_rad(machine, place_of_button(machine, i)));
  }
  return tilt_rad;
}

}  // namespace

double largest_marker_plate_m(const PanelLayout& panel, const PanelLayout::Marker& marker) {
  double fits = 0, does_not = 10;
  for (int i = 0; i < 50; ++i) {
    const double side = (fits + does_not) / 2;
    (plate_fits(panel, marker, side) ? fits : does_not) = side;
  }
  return fits;
}

// In simulation caps of 5 to 6 mm with a stroke of 5 mm let the fingers meet the panel beside them, and of 12 mm a broken-off one was told as pressed.
double lowest_button_m(const Machine& machine, const PanelLayout::Button& button) {
  constexpr double corner_m = 0.028;  // from the middle of the closed fingers' tips to a corner: pads of 40 mm, 40 mm thick together
  constexpr double doubt_m = 0.0036;  // of the face by the look, 3 mm, and of the tip by the joints, 2 mm, added in squares
  const double tilt_rad = steepest_button_rad(machine, button);
  return button.stroke_m + std::min(machine.mission.press_overtravel_m, mission::press_face_m) + corner_m * std::sin(tilt_rad) + doubt_m;
}

bool presses(const std::vector<Task>& tasks) {
  return std::any_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.kind == Task::Kind::press_buttons; });
}

namespace {

bool presses(const std::vector<Task>& tasks, const std::string& button) {
  return std::any_of(tasks.begin(), tasks.end(), [&](const Task& task) {
    return task.kind == Task::Kind::press_buttons && std::find(task.order.begin(), task.order.end(), button) != task.order.end();
  });
}

}  // namespace

// Of buttons that are alike one problem is told: on the docked mission's panel all are.
std::vector<std::string> low_button_problems(const Machine& machine) {
  std::vector<std::string> problems;
  if (!presses(machine.tasks) || !arm::can_work(machine.arm)) return problems;
  const PanelSurvey& survey = machine.survey;
  for (std::size_t i = 0; i < machine.panel.buttons.size(); ++i) {
    const PanelLayout::Button& button = machine.panel.buttons[i];
    const double lowest_m = lowest_button_m(machine, button);
    if (button.height_m >= lowest_m || (!survey.file.empty() && !presses(machine.tasks, survey.names.buttons[i]))) continue;
    const auto key = [&](const char* field) { return button_key(survey, i, field); };
    std::array<char, 480> text;
    (void)std::snprintf(text.data(), text.size(),
                        "%s is %.4g: with %s at %.4g and 'mission.press_overtravel_m' at %.4g the "
                        "fingers could press the panel instead of the button, and take it for the button. Caps at these %s need %.4f m",
                        key("height_m").c_str(), button.height_m, key("stroke_m").c_str(), button.stroke_m,
                        machine.mission.press_overtravel_m, key("at_m").c_str(), lowest_m);
    problems.push_back(text.data() + aslant_text(machine.panel, machine.mission.docking, steepest_button_rad(machine, button)));
    if (survey.file.empty()) break;
  }
  return problems;
}

namespace {

class PanelCheck {
 public:
  PanelCheck(const PanelLayout& panel, const PanelSurvey& survey) : panel_(panel), survey_(survey) {}

  std::vector<std::string> problems() {
    for (std::size_t i = 0; i < panel_.markers.size(); ++i) check_under_bars(i);
    for (std::size_t i = 0; i < panel_.buttons.size(); ++i) check_button(i);
    for (std::size_t i = 0; i < panel_.valves.size(); ++i) check_valve(i);
    for (std::size_t i = 0; i < panel_.markers.size(); ++i) check_marker(i);
    return problems_;
  }

 private:
  std::string plate() const { return ": see " + plate_key(survey_, "min_m") + ", " + plate_key(survey_, "max_m"); }
  std::string button_at(std::size_t i) const { return button_key(survey_, i, "at_m") + ": " + button_text(survey_.names, i); }

  void check_under_bars(std::size_t i) {
    const PanelLayout::Marker& marker = panel_.markers[i];
    for (std::size_t v = 0; v < panel_.valves.size(); ++v) {
      const PanelLayout::Valve& valve = panel_.valves[v];
      const double under_m = valve.swept_radius_m() - distance_to_square(valve.at_m - marker.centre_m, marker.plate_m);
      if (under_m > 0)
        problems_.push_back(marker_key(survey_, i, "at_m") + ": the turning bar covers " + marker_text(survey_.names, i) + "'s plate by " +
                            millimetres(under_m) + ": no look would find the marker. See " + valve_key(survey_, v, "length_m") + ", " +
                            valve_key(survey_, v, "thickness_m") + " and " + marker_key(survey_, i, "plate_m"));
    }
  }

  void check_button(std::size_t i) {
    const PanelLayout::Button& button = panel_.buttons[i];
    const double radius = button.width_m / 2;
    for (std::size_t m = 0; m < panel_.markers.size(); ++m) {
      const PanelLayout::Marker& marker = panel_.markers[m];
      const double gap = distance_to_square(button.at_m - marker.centre_m, marker.plate_m) - radius;
      if (gap >= 0) continue;
      problems_.push_back(button_at(i) + " covers " + marker_text(survey_.names, m) + "'s plate by " + millimetres(-gap) +
                          ": no look would find the marker. See " + button_key(survey_, i, "width_m") + ", " +
                          marker_key(survey_, m, "at_m") + " and " + marker_key(survey_, m, "plate_m"));
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double between = (button.at_m - panel_.buttons[j].at_m).norm() - radius - panel_.buttons[j].width_m / 2;
      if (between < 0)
        problems_.push_back(button_at(i) + " and the " + survey_.names.buttons[j] + " one overlap by " + millimetres(-between) + ": see " +
                            button_key(survey_, i, "width_m"));
    }
    for (std::size_t v = 0; v < panel_.valves.size(); ++v) {
      const PanelLayout::Valve& valve = panel_.valves[v];
      const double turned_over_m = valve.swept_radius_m() + radius - (button.at_m - valve.at_m).norm();
      if (turned_over_m > 0)
        problems_.push_back(button_at(i) + " lies " + millimetres(turned_over_m) + " under the turning bar: see " +
                            button_key(survey_, i, "width_m") + ", " + valve_key(survey_, v, "length_m") + " and " +
                            valve_key(survey_, v, "thickness_m"));
    }
    if (!inside_plate(panel_, button.at_m, radius))
      problems_.push_back(button_at(i) + " hangs beyond the plate" + plate() + " and " + button_key(survey_, i, "width_m"));
  }

  // Only a file's valves stand anywhere. What room the hand needs between them is asked of those that are turned (handle_check.hpp).
  void check_valve(std::size_t i) {
    const PanelLayout::Valve& valve = panel_.valves[i];
    if (survey_.file.empty()) return;
    if ((valve.at_m.array() < panel_.plate_min_m.array()).any() || (valve.at_m.array() > panel_.plate_max_m.array()).any())
      problems_.push_back(valve_key(survey_, i, "at_m") + ": the valve stands beyond the plate" + plate());
    for (std::size_t j = 0; j < i; ++j) {
      const PanelLayout::Valve& other = panel_.valves[j];
      const double between_m = (valve.at_m - other.at_m).norm() - valve.swept_radius_m() - other.swept_radius_m();
      if (between_m < 0)
        problems_.push_back(valve_key(survey_, i, "at_m") + ": its turning bar and that of " + survey_.names.valves[j] + " overlap by " +
                            millimetres(-between_m) + ": see " + valve_key(survey_, i, "length_m"));
    }
  }

  void check_marker(std::size_t i) {
    const PanelLayout::Marker& marker = panel_.markers[i];
    if (!inside_plate(panel_, marker.centre_m, marker.plate_m / 2))
      problems_.push_back(marker_key(survey_, i, "at_m") + ": " + marker_text(survey_.names, i) + "'s plate hangs beyond the panel's" +
                          plate() + " and " + marker_key(survey_, i, "plate_m"));
    for (std::size_t j = 0; j < i; ++j) {
      const PanelLayout::Marker& other = panel_.markers[j];
      if (marker.id == other.id)
        problems_.push_back(marker_key(survey_, i, "id") + ": " + std::to_string(marker.id) + " is " + marker_text(survey_.names, j) +
                            "'s too: a look would not tell them apart");
      const double apart_m = (marker.centre_m - other.centre_m).cwiseAbs().maxCoeff() - (marker.plate_m + other.plate_m) / 2;
      if (apart_m < 0)
        problems_.push_back(marker_key(survey_, i, "at_m") + ": its plate and that of " + marker_text(survey_.names, j) + " overlap by " +
                            millimetres(-apart_m));
    }
  }

  const PanelLayout& panel_;
  const PanelSurvey& survey_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> panel_problems(const PanelLayout& panel, const PanelSurvey& survey) {
  return PanelCheck(panel, survey).problems();
}

}  // namespace lf::config
