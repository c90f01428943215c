// What was true of a mission's tasks, and where it contradicts a mission that believes it succeeded.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/mission/mission.hpp"
#include "hal/sim/sim_platform.hpp"
#include "shared/panel/panel_names.hpp"

namespace lf::judge {

struct TaskTruth {
  std::vector<double> valves_rad;      // when the task ended
  std::vector<std::uint32_t> presses;  // by then, counted by the buttons themselves
};

TaskTruth task_truth(const world::World& world);

// What was true of a mission, by its start, its tasks' ends as far as they were seen, and its own end.
struct Watched {
  TaskTruth at_start;
  std::vector<TaskTruth> tasks;
  TaskTruth at_end;
};

// Keeps the truth at each task's end.
class TruthObserver : public hal::SimObserver {
 public:
  void on_step(Time, const world::World& world) override;
  void on_telemetry(const Telemetry& telemetry) override;

  const std::vector<TaskTruth>& tasks() const { return tasks_; }  // by the task's index, as far as they have ended
  // With the truth as it is now for the end.
  Watched watched(const world::World& world) const { return {at_start_, tasks_, task_truth(world)}; }

 private:
  const world::World* world_ = nullptr;
  std::vector<TaskTruth> tasks_;
  TaskTruth at_start_;
};

// The figures of a success.
inline constexpr double valve_accuracy_deg = 3.0;  // of the valve at its task's end
// A detent's pull and the shaft's play move a valve that was let go by less than a degree; what turns it by more has touched it.
inline constexpr double valve_drift_deg = 2.0;
// Less than the weight of half a kilogram leaves no mark on paint; the physics' own noise at a touch is below 1 N.
inline constexpr double touch_n = 5.0;
inline constexpr double contact_limit_n = 150.0;  // what panel and arm are built to bear

struct Contradiction {
  std::string phase;
  std::string reason;
};

// `tasks` with what was true at the end in place of tasks whose own end was not seen, as when telemetry was lost.
std::vector<TaskTruth> completed(std::vector<TaskTruth> tasks, std::size_t count, const TaskTruth& at_end);

// Whether the truth at each task's end (`tasks`) is what its result says. Turns: the true angle within `valve_accuracy_deg`; presses: the button counted it.
std::vector<bool> truly_done(std::span<const mission::TaskResult> results, const std::vector<TaskTruth>& tasks);

// The first way in which the truth is not that of a success: a task that was not done, a valve that has moved after its task or without one, clicks that nobody asked
// for, parts that touched which should not have met, and too much force. Nothing when the mission may call itself a success. `names`: of the panel's features.
std::optional<Contradiction> contradiction(std::span<const mission::TaskResult> results, const Watched& watched,
                                           const world::ContactReport& contacts, const PanelNames& names);

// "wrist and panel at 12.30 s, up to 40 N".
std::string contact_text(const world::UnintendedContact& contact);

}  // namespace lf::judge
