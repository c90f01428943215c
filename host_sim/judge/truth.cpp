#include "host_sim/judge/truth.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace lf::judge {

namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

const TaskTruth& truth_of(std::size_t task, const std::vector<TaskTruth>& tasks) {
  static const TaskTruth nothing;
  return task < tasks.size() ? tasks[task] : nothing;
}

double angle_of(const TaskTruth& truth, std::size_t valve) { return valve < truth.valves_rad.size() ? truth.valves_rad[valve] : 0; }
std::uint32_t presses_of(const TaskTruth& truth, std::size_t button) { return button < truth.presses.size() ? truth.presses[button] : 0; }

std::optional<Contradiction> undone_task(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& tasks,
                                         const PanelNames& names) {
  const std::vector<bool> done = truly_done(results, tasks);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (done[i]) continue;
    const mission::Task& task = results[i].task;
    if (task.kind == mission::Task::Kind::turn_valve) {
      return Contradiction{"turn_valve", formatted("%s stands at %.1f deg instead of %.1f, against the core's account",
                                                   valve_text(names, task.valve).c_str(),
                                                   deg_from_rad(angle_of(truth_of(i, tasks), task.valve)), deg_from_rad(task.to_rad))};
    }
    return Contradiction{"press_buttons",
                         formatted("%s did not click, against the core's account", button_text(names, task.button).c_str())};
  }
  return std::nullopt;
}

std::optional<Contradiction> moved_valve(std::span<const mission::TaskResult> results, const Watched& watched,
                                         const std::vector<TaskTruth>& tasks, const PanelNames& names) {
  for (std::size_t valve = 0; valve < watched.at_end.valves_rad.size(); ++valve) {
    // From the start to its first task's beginning, and from its last task's end to the mission's.
    const TaskTruth *since = &watched.at_start, *before = &watched.at_end;
    for (std::size_t i = 0; i < results.size(); ++i) {
      if (results[i].task.kind != mission::Task::Kind::turn_valve || results[i].task.valve != valve) continue;
      if (since == &watched.at_start) before = i > 0 ? &truth_of(i - 1, tasks) : &watched.at_start;
      since = &truth_of(i, tasks);
    }
    const bool turned = since != &watched.at_start, start_seen = valve < watched.at_start.valves_rad.size();
    if (!turned && !start_seen) continue;
    const double early_deg = start_seen ? deg_from_rad(angle_of(*before, valve) - angle_of(watched.at_start, valve)) : 0;
    if (turned && std::abs(early_deg) > valve_drift_deg)
      return Contradiction{"turn_valve",
                           formatted("%s had turned by %.1f deg before its task", valve_text(names, valve).c_str(), early_deg)};
    const double drift_deg = deg_from_rad(angle_of(watched.at_end, valve) - angle_of(*since, valve));
    if (std::abs(drift_deg) > valve_drift_deg)
      return Contradiction{"turn_valve",
                           formatted(turned ? "%s has turned by %.1f deg after its task" : "%s has turned by %.1f deg without a task",
                                     valve_text(names, valve).c_str(), drift_deg)};
  }
  return std::nullopt;
}

std::optional<Contradiction> extra_click(std::span<const mission::TaskResult> results, const TaskTruth& at_end, const PanelNames& names) {
  std::vector<std::uint32_t> wanted(at_end.presses.size());
  for (const mission::TaskResult& result : results) {
    if (result.task.kind == mission::Task::Kind::press_button && result.task.button < wanted.size()) ++wanted[result.task.button];
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (at_end.presses[i] <= wanted[i]) continue;
    return Contradiction{"press_buttons", formatted("%s has clicked %u times, %u were asked for", button_text(names, i).c_str(),
                                                    at_end.presses[i], wanted[i])};
  }
  return std::nullopt;
}

}  // namespace

TaskTruth task_truth(const world::World& world) {
  TaskTruth truth;
  for (std::size_t i = 0; i < world.valve_count(); ++i) truth.valves_rad.push_back(world.valve_angle_rad(i));
  for (std::size_t i = 0; i < world.button_count(); ++i) truth.presses.push_back(world.button(i).presses);
  return truth;
}

// A handle that starts beside a detent is pulled into it. By then it stands, and the arm has not left its parking pose.
constexpr double settled_s = 1.5;

void TruthObserver::on_step(Time t, const world::World& world) {
  if (t.s() <= settled_s) at_start_ = task_truth(world);
  world_ = &world;
}

void TruthObserver::on_telemetry(const Telemetry& telemetry) {
  if (world_ == nullptr) return;
  for (const Event& event : telemetry.events) {
    if (event.kind != Event::Kind::task_done && event.kind != Event::Kind::task_failed) continue;
    const TaskTruth truth = task_truth(*world_);
    if (tasks_.size() <= event.task) tasks_.resize(event.task + 1u, truth);
    tasks_[event.task] = truth;
  }
}

std::vector<TaskTruth> completed(std::vector<TaskTruth> tasks, std::size_t count, const TaskTruth& at_end) {
  if (tasks.size() < count) tasks.resize(count, at_end);
  return tasks;
}

std::vector<bool> truly_done(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& tasks) {
  std::vector<bool> done;
  std::array<std::uint32_t, PanelLayout::max_buttons> wanted{};
  for (std::size_t i = 0; i < results.size(); ++i) {
    const mission::TaskResult& result = results[i];
    const TaskTruth& truth = truth_of(i, tasks);
    if (result.task.kind == mission::Task::Kind::turn_valve) {
      done.push_back(result.done && std::abs(deg_from_rad(angle_of(truth, result.task.valve) - result.task.to_rad)) <= valve_accuracy_deg);
    } else {
      done.push_back(result.done && presses_of(truth, result.task.button) >= ++wanted[result.task.button]);
    }
  }
  return done;
}

std::optional<Contradiction> contradiction(std::span<const mission::TaskResult> results, const Watched& watched,
                                           const world::ContactReport& contacts, const PanelNames& names) {
  const std::vector<TaskTruth> tasks = completed(watched.tasks, results.size(), watched.at_end);
  if (auto undone = undone_task(results, tasks, names)) return undone;
  if (auto moved = moved_valve(results, watched, tasks, names)) return moved;
  if (auto extra = extra_click(results, watched.at_end, names)) return extra;
  for (const world::UnintendedContact& contact : contacts.unintended) {
    if (contact.peak_force_n > touch_n) return Contradiction{"contact", "unintended contact of " + contact_text(contact)};
  }
  if (contacts.peak_force_n > contact_limit_n)
    return Contradiction{"contact", formatted("%.0f N of contact, %.0f are allowed", contacts.peak_force_n, contact_limit_n)};
  return std::nullopt;
}

std::string contact_text(const world::UnintendedContact& contact) {
  return formatted("%s and %s at %.2f s, up to %.0f N", contact.name_a.c_str(), contact.name_b.c_str(), contact.first_s,
                   contact.peak_force_n);
}

}  // namespace lf::judge
