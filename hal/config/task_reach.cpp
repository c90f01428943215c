#include "hal/config/task_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/pointing.hpp"
#include "hal/config/park_pose.hpp"

namespace lf::config {

bool names_known(const std::vector<Task>& tasks, const PanelNames& names) {
  return std::all_of(tasks.begin(), tasks.end(), [&](const Task& task) {
    if (task.kind == Task::Kind::turn_valve) return find_valve(names, task.valve).has_value();
    return std::all_of(task.order.begin(), task.order.end(), [&](const std::string& name) { return find_button(names, name).has_value(); });
  });
}

bool turns(const Machine& machine, std::size_t valve) {
  return std::any_of(machine.tasks.begin(), machine.tasks.end(), [&](const Task& task) {
    return task.kind == Task::Kind::turn_valve && find_valve(machine.survey.names, task.valve) == valve;
  });
}

Place place_of_valve(const Machine& machine, std::size_t valve) {
  return {valve_text(machine.survey.names, valve), machine.panel.valves[valve].handle_centre_m(), 0,
          valve_key(machine.survey, valve, "height_m")};
}

Place place_of_button(const Machine& machine, std::size_t button) {
  return {button_text(machine.survey.names, button), machine.panel.buttons[button].face_m(),
          arm::tip_beyond_tool_m(machine.arm.jaw(), arm::jaw_from_gap(machine.arm.jaw(), 0)), button_key(machine.survey, button, "at_m")};
}

std::vector<Place> places_of_tasks(const Machine& machine) {
  std::vector<Place> places;
  const auto add = [&](const Place& place) {
    if (std::none_of(places.begin(), places.end(), [&](const Place& other) { return other.what == place.what; })) places.push_back(place);
  };
  const PanelNames& names = machine.survey.names;
  for (const Task& task : machine.tasks) {
    if (task.kind == Task::Kind::turn_valve) {
      if (const std::optional<std::size_t> valve = find_valve(names, task.valve)) add(place_of_valve(machine, *valve));
      continue;
    }
    for (const std::string& name : task.order) {
      if (const std::optional<std::size_t> button = find_button(names, name)) add(place_of_button(machine, *button));
    }
  }
  return places;
}

arm::IkResult pose_at(const Machine& machine, const Place& place) {
  const arm::Arm& arm = machine.arm;
  const Pose base_from_panel = machine.panel.nominal_base_from_panel();
  const Vec3 tip_m = base_from_panel * place.in_panel_m, inward = -base_from_panel.linear().col(2);
  if (!arm.is_planar())
    return arm::point_tool_or_why(arm, tip_m - place.tip_m * inward, inward, 0, arm::default_limit_margin_rad,
                                  as_folded(arm, machine.park_rad));
  // The approach axis depends on the place itself.
  arm::IkResult ik = arm::inverse_kinematics(arm, tip_m, 0);
  for (int round = 0; round < 3 && place.tip_m > 0; ++round) {
    if (ik.outcome == arm::IkOutcome::not_a_number || ik.outcome == arm::IkOutcome::too_far) break;
    ik = arm::inverse_kinematics(arm, ik.posture, tip_m - place.tip_m * arm.approach_axis(ik.q_rad), 0);
  }
  return ik;
}

double steepest_rad(const Machine& machine, const Place& place) {
  // A place beside its own turns the arm the more the nearer it is.
  constexpr double farthest_m = 0.5, nearest_m = 0.1;
  // The worst of 30 looks by the shipped arms was 6 mrad off the panel's normal; thrice that.
  constexpr double of_pointing_rad = 0.02;
  const arm::IkResult ik = pose_at(machine, place);
  if (!ik.ok()) return 0;
  if (!machine.arm.is_planar()) return of_pointing_rad;
  const arm::PanelDoubt& docking = machine.mission.docking;
  const double away_m = std::clamp(machine.arm.base_from_tool(ik.q_rad).translation().head<2>().norm(), nearest_m, farthest_m);
  const Vec3 inward = -machine.panel.nominal_base_from_panel().linear().col(2);
  const Vec3 axis = machine.arm.approach_axis(ik.q_rad);
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
