#include "hal/config/task_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/reach.hpp"

namespace lf::config {

std::uint8_t button_index(const std::string& name) { return name == "left" ? 0 : name == "centre" ? 1 : 2; }

Place place_of_button(const PanelLayout& panel, std::uint8_t button) {
  constexpr std::array<const char*, PanelLayout::button_count> names{"the left button", "the centre button", "the right button"};
  const Vec2& centre = panel.buttons_m[button];
  return {names[button], Vec3(centre.x(), centre.y(), panel.button_height_m), arm::tip_beyond_tool_m(arm::jaw_from_gap(0))};
}

std::vector<Place> places_of_tasks(const Machine& machine) {
  const PanelLayout& panel = machine.panel;
  std::vector<Place> places;
  const auto add = [&](const Place& place) {
    if (std::none_of(places.begin(), places.end(), [&](const Place& other) { return other.what == place.what; })) places.push_back(place);
  };
  for (const Task& task : machine.tasks) {
    if (task.kind == Task::Kind::turn_valve) {
      add({"the valve", Vec3(0, 0, panel.handle_height_m), 0});
      continue;
    }
    for (const std::string& name : task.order) {
      add(place_of_button(panel, button_index(name)));
    }
  }
  return places;
}

arm::IkResult pose_at(const PanelLayout& panel, const Place& place) {
  const Vec3 tip_m = panel.nominal_base_from_panel() * place.in_panel_m;
  arm::IkResult ik = arm::inverse_kinematics(tip_m, 0);
  for (int round = 0; round < 3 && place.tip_m > 0; ++round) {
    if (ik.outcome == arm::IkOutcome::not_a_number || ik.outcome == arm::IkOutcome::too_far) break;
    ik = arm::inverse_kinematics(tip_m - place.tip_m * arm::approach_axis(ik.q_rad), 0);
  }
  return ik;
}

double steepest_rad(const PanelLayout& panel, const Place& place, const arm::PanelDoubt& docking) {
  // A place beside its own turns the arm the more the nearer it is.
  constexpr double farthest_m = 0.5, nearest_m = 0.1;
  const arm::IkResult ik = pose_at(panel, place);
  if (!ik.ok()) return 0;
  const double away_m = std::clamp(arm::base_from_tool(ik.q_rad).translation().head<2>().norm(), nearest_m, farthest_m);
  const Vec3 inward = -panel.nominal_base_from_panel().linear().col(2);
  const Vec3 axis = arm::approach_axis(ik.q_rad);
  const double doubt_rad = std::numbers::sqrt3 * docking.turn_rad + std::numbers::sqrt2 * docking.shift_m / away_m;
  return std::atan2(axis.cross(inward).norm(), axis.dot(inward)) + doubt_rad;
}

std::string place_text(const PanelLayout& panel) {
  char text[128];
  std::snprintf(text, sizeof text, ". 'panel.ahead_m' is %.3g, 'panel.right_m' %.3g, 'panel.down_m' %.3g", panel.nominal_x_m,
                panel.nominal_y_m, panel.nominal_z_m);
  return text;
}

std::string aslant_text(const PanelLayout& panel, const arm::PanelDoubt& docking, double tilt_rad) {
  if (tilt_rad <= 0) return place_text(panel);  // the arm does not come there
  char text[160];
  std::snprintf(text, sizeof text,
                ": the tool comes to it up to %.1f degrees aslant, with 'mission.docking_m' at %.3g and 'mission.docking_rad' at %.3g",
                deg_from_rad(tilt_rad), docking.shift_m, docking.turn_rad);
  return text + place_text(panel);
}

std::string excess_text(const arm::IkResult& ik) {
  char text[48];
  const bool length = ik.outcome == arm::IkOutcome::too_far || ik.outcome == arm::IkOutcome::too_near;
  std::snprintf(text, sizeof text, length ? "%s by %.0f mm" : "%s by %.1f deg", arm::name(ik.outcome),
                length ? 1e3 * ik.excess : deg_from_rad(ik.excess));
  return text;
}

}  // namespace lf::config
