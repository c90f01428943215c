#include "firmware/mission/job.hpp"

#include <cmath>

namespace lf::mission {

bool Job::makes_sense(const Tasks& tasks, const PanelLayout& panel) {
  if (tasks.empty()) return false;
  for (const Task& task : tasks) {
    const bool turns = task.kind == Task::Kind::turn_valve && task.valve < panel.valves.size() &&
                       task.to_rad >= panel.valves[task.valve].handle_min_rad && task.to_rad <= panel.valves[task.valve].handle_max_rad;
    const bool presses = task.kind == Task::Kind::press_button && task.button < panel.buttons.size();
    if (!turns && !presses) return false;
  }
  return true;
}

void Job::set(const Tasks& tasks) {
  results_.clear();
  for (const Task& task : tasks) {
    TaskResult result;
    result.task = task;
    if (!results_.push_back(result)) return;  // cannot be: the same capacity on both sides
  }
}

PanelMap::Valves Job::valves() const {
  PanelMap::Valves valves = 0;
  for (const TaskResult& result : results_) {
    if (result.task.kind == Task::Kind::turn_valve) valves |= PanelMap::bit(result.task.valve);
  }
  return valves;
}

void Job::begin_anew() {
  for (TaskResult& result : results_) {
    const Task task = result.task;
    result = TaskResult{};
    result.task = task;
  }
  tries_.fill(0);
  index_ = 0;
}

Progress Job::choose_next() {
  tries_.fill(0);
  for (index_ = 0; index_ < results_.size() && results_[index_].done;) ++index_;
  if (index_ == results_.size()) {
    index_ = results_.empty() ? 0 : results_.size() - 1;
    return Progress::nothing_left();
  }
  result().attempted = true;
  return task().kind == Task::Kind::turn_valve ? Progress::done() : Progress::other_way();
}

}  // namespace lf::mission
