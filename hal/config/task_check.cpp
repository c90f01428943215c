#include "hal/config/task_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/arm/tool_place.hpp"
#include "hal/config/handle_check.hpp"
#include "hal/config/limits_check.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/roll_check.hpp"
#include "hal/config/sweep_check.hpp"
#include "hal/config/task_reach.hpp"
#include "hal/config/view_check.hpp"

namespace lf::config {

namespace {

std::vector<Task> as_in_a_file(const mission::Tasks& tasks, const PanelNames& names) {
  std::vector<Task> all;
  for (const mission::Task& one : tasks) {
    Task task;
    task.to_deg = deg_from_rad(one.to_rad);
    if (one.kind == mission::Task::Kind::press_button) {
      task.kind = Task::Kind::press_buttons;
      task.order = {names.buttons.at(one.button)};
    } else {
      task.valve = names.valves.at(one.valve);
    }
    all.push_back(task);
  }
  return all;
}

}  // namespace

std::string turn_problem(const mission::Tasks& tasks, const PanelLayout& panel, const PanelNames& names) {
  for (const mission::Task& task : tasks) {
    if (task.kind != mission::Task::Kind::turn_valve) continue;
    const PanelLayout::Valve& valve = panel.valves[task.valve];
    if (task.to_rad >= valve.handle_min_rad && task.to_rad <= valve.handle_max_rad) continue;
    std::array<char, 160> text;
    (void)std::snprintf(text.data(), text.size(), "%s cannot be turned to %.4g deg: its handle goes from %.4g to %.4g deg",
                        valve_text(names, task.valve).c_str(), deg_from_rad(task.to_rad), deg_from_rad(valve.handle_min_rad),
                        deg_from_rad(valve.handle_max_rad));
    return text.data();
  }
  return "";
}

std::vector<std::string> torque_problems(const Machine& machine, double hand_torque_nm) {
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < machine.survey.valves.size(); ++i) {
    const double needs_nm = machine.survey.valves[i].torque_nm;
    if (!turns(machine, i) || needs_nm <= hand_torque_nm || !machine.arm.rolls()) continue;
    std::array<char, 200> text;
    (void)std::snprintf(text.data(), text.size(), "%s needs %.3g N m, the arm gives %.3g. See %s",
                        valve_text(machine.survey.names, i).c_str(), needs_nm, hand_torque_nm,
                        valve_key(machine.survey, i, "torque_nm").c_str());
    problems.emplace_back(text.data());
  }
  return problems;
}

std::string tasks_problem(const Machine& machine, const Core& core, const mission::Tasks& tasks) {
  const safety::Limits& limits = core.controller.mission_limits;
  Machine with_tasks = machine;
  with_tasks.tasks = as_in_a_file(tasks, machine.survey.names);
  if (!arm::can_work(machine.arm)) return no_jobs;
  for (const std::string& problem : handle_problems(with_tasks)) return problem;
  for (const std::string& problem : low_button_problems(with_tasks)) return problem;
  for (const std::string& problem : torque_problems(with_tasks, core.hand_torque_nm)) return problem;
  for (const std::string& problem : roll_problems(with_tasks, limits)) return problem;
  for (const std::string& problem : view_problems(with_tasks, core.controller.camera)) return problem;
  for (const Place& place : places_of_tasks(with_tasks)) {
    const arm::IkResult ik = pose_at(machine, place);
    if (!ik.ok()) return place.what + " is out of the arm's reach at its nominal place: " + excess_text(ik);
    for (const std::string& problem : pose_problems(machine.arm, machine.joints, limits, ik.q_rad, place.what)) return problem;
  }
  for (const std::string& problem : turn_speed_problems(with_tasks, limits)) return problem;
  // Where the file has no task, nobody has asked for it yet.
  if (!machine.tasks.empty() || machine.arm.is_planar()) return "";
  ControllerConfig with = core.controller;
  with.mission.tasks = tasks;
  return sweep_problem(with, machine.joints, machine.survey).value_or("");
}

std::vector<std::string> turn_speed_problems(const Machine& machine, const safety::Limits& limits) {
  std::vector<std::string> problems;
  if (!machine.arm.rolls()) return problems;  // turns nothing
  const std::size_t roll = machine.arm.roll_joint();
  for (std::size_t i = 0; i < machine.panel.valves.size(); ++i) {
    if (!machine.survey.file.empty() && !turns(machine, i)) continue;
    const double tilt_rad = steepest_rad(machine, place_of_valve(machine, i));
    const double fastest = std::cos(tilt_rad) * std::min(machine.arm.joint(roll).velocity_rad_s, limits.joints[roll].max_speed_rad_s);
    if (machine.mission.turn_speed_rad_s <= fastest) continue;
    std::array<char, 128> text;
    (void)std::snprintf(text.data(), text.size(),
                        "'mission.turn_speed_rad_s' is %.3g: with this wrist a handle turns at most at %.3g rad/s",
                        machine.mission.turn_speed_rad_s, fastest);
    problems.push_back(text.data() + aslant_text(machine.panel, machine.mission.docking, tilt_rad));
  }
  return problems;
}

}  // namespace lf::config
