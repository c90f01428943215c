#include "host_sim/judge/truth.hpp"

#include <cmath>
#include <cstdio>

namespace lf::judge {

namespace {

constexpr std::array<const char*, PanelLayout::button_count> button_names{"left", "centre", "right"};

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

std::optional<Contradiction> undone_task(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& tasks) {
  const std::vector<bool> done = truly_done(results, tasks);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (done[i]) continue;
    const mission::Task& task = results[i].task;
    if (task.kind == mission::Task::Kind::turn_valve) {
      return Contradiction{"turn_valve", formatted("the valve stands at %.1f deg instead of %.1f, against the core's account",
                                                   deg_from_rad(truth_of(i, tasks).valve_rad), deg_from_rad(task.to_rad))};
    }
    return Contradiction{"press_buttons", formatted("the %s button did not click, against the core's account", button_names[task.button])};
  }
  return std::nullopt;
}

std::optional<Contradiction> moved_valve(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& tasks,
                                         const TaskTruth& at_end) {
  for (std::size_t i = results.size(); i > 0; --i) {
    if (results[i - 1].task.kind != mission::Task::Kind::turn_valve) continue;
    const double drift_deg = deg_from_rad(at_end.valve_rad - truth_of(i - 1, tasks).valve_rad);
    if (std::abs(drift_deg) <= valve_drift_deg) return std::nullopt;
    return Contradiction{"turn_valve", formatted("the valve has turned by %.1f deg after its task", drift_deg)};
  }
  return std::nullopt;
}

std::optional<Contradiction> extra_click(std::span<const mission::TaskResult> results, const TaskTruth& at_end) {
  std::array<std::uint32_t, PanelLayout::button_count> wanted{};
  for (const mission::TaskResult& result : results) {
    if (result.task.kind == mission::Task::Kind::press_button) ++wanted[result.task.button];
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (at_end.presses[i] <= wanted[i]) continue;
    return Contradiction{"press_buttons",
                         formatted("the %s button has clicked %u times, %u were asked for", button_names[i], at_end.presses[i], wanted[i])};
  }
  return std::nullopt;
}

}  // namespace

TaskTruth task_truth(const world::World& world) {
  TaskTruth truth;
  truth.valve_rad = world.valve_angle_rad();
  for (std::size_t i = 0; i < truth.presses.size(); ++i) truth.presses[i] = world.button(i).presses;
  return truth;
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
  std::array<std::uint32_t, PanelLayout::button_count> wanted{};
  for (std::size_t i = 0; i < results.size(); ++i) {
    const mission::TaskResult& result = results[i];
    const TaskTruth& truth = truth_of(i, tasks);
    if (result.task.kind == mission::Task::Kind::turn_valve) {
      done.push_back(result.done && std::abs(deg_from_rad(truth.valve_rad - result.task.to_rad)) <= valve_accuracy_deg);
    } else {
      done.push_back(result.done && truth.presses[result.task.button] >= ++wanted[result.task.button]);
    }
  }
  return done;
}

std::optional<Contradiction> contradiction(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& seen,
                                           const TaskTruth& at_end, const world::ContactReport& contacts) {
  const std::vector<TaskTruth> tasks = completed(seen, results.size(), at_end);
  if (auto undone = undone_task(results, tasks)) return undone;
  if (auto moved = moved_valve(results, tasks, at_end)) return moved;
  if (auto extra = extra_click(results, at_end)) return extra;
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
