#include "hal/config/task_check.hpp"

#include <array>
#include <cstdio>

#include "hal/config/limits_check.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

constexpr std::array<const char*, 3> button_names{"left", "centre", "right"};

std::vector<Task> as_in_a_file(const mission::Tasks& tasks) {
  std::vector<Task> all;
  for (const mission::Task& one : tasks) {
    Task task;
    task.to_deg = deg_from_rad(one.to_rad);
    if (one.kind == mission::Task::Kind::press_button) {
      task.kind = Task::Kind::press_buttons;
      task.order = {button_names[one.button % button_names.size()]};
    }
    all.push_back(task);
  }
  return all;
}

}  // namespace

std::string turn_problem(const mission::Tasks& tasks, const PanelLayout& panel) {
  for (const mission::Task& task : tasks) {
    if (task.kind != mission::Task::Kind::turn_valve) continue;
    if (task.to_rad >= panel.handle_min_rad && task.to_rad <= panel.handle_max_rad) continue;
    std::array<char, 128> text;
    (void)std::snprintf(text.data(), text.size(), "the valve cannot be turned to %.4g deg: its handle goes from %.4g to %.4g deg",
                        deg_from_rad(task.to_rad), deg_from_rad(panel.handle_min_rad), deg_from_rad(panel.handle_max_rad));
    return text.data();
  }
  return "";
}

std::string tasks_problem(const Machine& machine, const safety::Limits& limits, const mission::Tasks& tasks) {
  Machine with_tasks = machine;
  with_tasks.tasks = as_in_a_file(tasks);
  for (const std::string& problem : low_button_problems(with_tasks)) return problem;
  for (const Place& place : places_of_tasks(with_tasks)) {
    const arm::IkResult ik = pose_at(machine.panel, place);
    if (!ik.ok()) return place.what + " is out of the arm's reach at its nominal place: " + excess_text(ik);
    for (const std::string& problem : pose_problems(limits, ik.q_rad, place.what)) return problem;
  }
  return "";
}

}  // namespace lf::config
