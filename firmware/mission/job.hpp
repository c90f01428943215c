// The job: its tasks one after the other, what became of each, and how often each step of the task under way was tried.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/mission/mission_config.hpp"
#include "firmware/mission/orders.hpp"
#include "firmware/mission/panel_map.hpp"
#include "firmware/mission/progress.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/mission/steps.hpp"
#include "shared/messages/static_vector.hpp"

namespace lf::mission {

struct TaskResult {
  Task task;
  bool attempted = false;
  bool done = false;
  double reached_rad = 0;     // turn_valve: as the second look saw it
  std::uint32_t presses = 0;  // press_button: went in and bottomed
  double travel_m = 0;        // of the last press: how far the button went in
  bool click_felt = false;    // in the last press
  bool face_felt = false;     // by the last press, near where the face was seen
  double face_off_m = 0;      // then: how far behind the place where it was seen, by the middle of what aslant fingers leave open
  StepFailure failure = StepFailure::none;  // of the last press: stuck, missing, yielding, or touched too early; none where it was pressed
};
using TaskResults = StaticVector<TaskResult, MissionConfig::max_tasks>;

class Job {
 public:
  Job(const Tasks& tasks, std::uint32_t tries) : tries_allowed_(tries) { set(tasks); }

  // False, and nothing changes, when there is none, or one that this panel does not have: no such button or valve, an angle beyond
  // the handle's stops.
  static bool makes_sense(const Tasks& tasks, const PanelLayout& panel);
  void set(const Tasks& tasks);
  void begin_anew();  // nothing is attempted yet

  // Chooses the first task that is not done: done() leads to a valve, other_way() to a button, nothing_left() when all are done.
  Progress choose_next();

  const TaskResults& results() const { return results_; }
  std::size_t index() const { return index_; }
  PanelMap::Valves valves() const;                            // that its tasks turn
  const Task& task() const { return results_[index_].task; }  // of a job that has one
  bool turns() const { return !results_.empty() && task().kind == Task::Kind::turn_valve; }
  TaskResult& result() { return results_[index_]; }

  bool may_try_again(Step step) const { return tries(step) + 1u < tries_allowed_; }
  std::uint32_t tries(Step step) const { return tries_[static_cast<std::size_t>(step)]; }
  void count_try(Step step) { ++tries_[static_cast<std::size_t>(step)]; }
  void forget_tries(Step step) { tries_[static_cast<std::size_t>(step)] = 0; }

 private:
  std::uint32_t tries_allowed_;
  TaskResults results_;
  std::size_t index_ = 0;
  std::array<std::uint32_t, step_count> tries_{};  // of the task under way
};

}  // namespace lf::mission
