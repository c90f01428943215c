// The mission: one step of the table at a time, each a few lines that begin it and a few that watch it.
//
// Owns what is known of the panel, what moves, and what went wrong. What a fault does is read from the table of faults (safety/faults.hpp), where a
// step leads from the table of steps (steps.hpp); neither is decided here.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/compliance.hpp"
#include "firmware/arm/gripper.hpp"
#include "firmware/arm/guarded_motion.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/config.hpp"
#include "firmware/mission/camera_work.hpp"
#include "firmware/mission/motion.hpp"
#include "firmware/mission/orders.hpp"
#include "firmware/mission/panel_map.hpp"
#include "firmware/mission/steps.hpp"
#include "firmware/safety/watch.hpp"
#include "firmware/telemetry.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf::mission {

struct TaskResult {
  Task task;
  bool attempted = false;
  bool done = false;
  double reached_rad = 0;     // turn_valve: as the second look saw it
  std::uint32_t presses = 0;  // press_button: bottomed and felt
};

struct Outcome {
  bool ended = false;
  bool success = false;
  // Of the first fault that ended the mission.
  const char* stage = "";
  Step step = Step::idle;
  safety::Fault fault = safety::Fault::count;
  std::int32_t code = 0;
};

using FaultCounts = std::array<std::uint32_t, safety::fault_count>;

class Mission {
 public:
  explicit Mission(const ControllerConfig& config);

  // False, and nothing changes, when the table of orders or the order's own numbers do not allow it. Takes effect with the next tick.
  bool order(const Order& order, Time now);
  void on_panel(const PanelResult& result);
  void on_scan(const ScanStats& stats) {
    scan_stats_ = stats;
    camera_.on_image(stats.newest_exposure);
  }
  void on_port_error(std::int32_t port);

  // One control period: reads the network's answers, sets its targets and outputs, and adds orders and events.
  void tick(Time now, canopen::Network& network, ScanOrders& orders, Telemetry& telemetry);

  Step step() const { return step_; }
  Standing standing() const { return mission::standing(step_, on_hold_); }
  const ScanStats& scan_stats() const { return scan_stats_; }
  // Nothing is under power any more. A held arm is, and is watched on.
  bool over() const { return is_end(step_) && step_ != Step::held; }
  const Outcome& outcome() const { return outcome_; }
  // What came up when nothing was under power any more; the outcome does not know of it.
  const FaultCounts& faults_after_end() const { return faults_after_end_; }
  const StaticVector<TaskResult, MissionConfig::max_tasks>& tasks() const { return tasks_; }
  const PanelMap& map() const { return map_; }
  const safety::JointStates& joints() const { return watch_.joints(); }

 private:
  enum class Status : std::uint8_t { running, done, branch, end, failed };

  // One tick's surroundings, so that steps need no long argument lists.
  struct Tick {
    Time now;
    canopen::Network& network;
    ScanOrders& orders;
    Telemetry& telemetry;
  };

  // mission.cpp: the machine
  void observe(const Tick& tick);
  void watch_faults(const Tick& tick);
  void take_orders(const Tick& tick);
  void watch_ports(const Tick& tick);
  void watch_images(const Tick& tick);
  void watch_contact(const Tick& tick);
  void raise(const Tick& tick, safety::Fault fault, std::int32_t code);
  void record_fault(const Tick& tick, safety::Fault fault, std::int32_t code, safety::Reaction reaction);
  void react(const Tick& tick, safety::Reaction reaction);
  void enter(const Tick& tick, Step next);
  void begin(const Tick& tick);
  Status run(const Tick& tick);
  void finish_step(const Tick& tick, Status status);
  void give_up(safety::Fault fault, std::int32_t code);
  bool may_retry();
  void drive(const Tick& tick);
  void report(const Tick& tick);
  void event(const Tick& tick, Event::Kind kind, double value = 0);
  Status fail(StepFailure failure);
  // The jaw has closed on something, or is about to: the arm gives way to it.
  bool yielding() const { return step_ == Step::grip || step_ == Step::turn || step_ == Step::let_go; }
  arm::JointVector pushed_target() const;
  void stay_where_pushed();
  void let_off_roll();
  bool in_contact_phase() const { return row(step_).phase == safety::Phase::contact || row(step_).phase == safety::Phase::gripping; }

  // mission_orders.cpp: what an operator wants
  void hold(Time now);
  void resume(Time now);
  void wait_on_hold(Duration period);
  bool order_start();
  bool order_jog(const Order& order);
  void begin_jog();
  Status run_jog();
  Status run_ready();
  bool set_tasks(const Tasks& tasks);
  void list_tasks();
  void forget(const Tick& tick);
  void take_shut_down(const Tick& tick);
  void begin_shut_down(const Tick& tick);
  Status run_shut_down(const Tick& tick);

  // mission_start.cpp: power up and the way home
  void begin_boot(const Tick& tick);
  Status run_boot(const Tick& tick);
  Status run_enable(const Tick& tick);
  Status run_home(const Tick& tick);
  void bear_outside(const Tick& tick);
  void begin_stow();
  Status run_stow();
  void begin_abandon();
  Status run_abandon();

  // mission_look.cpp: sweeps, stills and what is made of them
  void begin_deploy();
  void begin_verify_reach();
  void go_to_sweep(scan::SweepRequest request);
  void begin_scan(const Tick& tick);
  Status run_scan(const Tick& tick);
  Status run_look();
  Status run_perceive(const Tick& tick);
  Status run_verify(const Tick& tick);
  void order(const Tick& tick, ScanCommand::Kind kind);

  // mission_valve.cpp
  Status run_next_task(const Tick& tick);
  void begin_reach_valve();
  Status run_reach_valve();
  void begin_advance();
  Status run_advance(const Tick& tick);
  Status run_grip();
  void begin_let_go();
  Status run_let_go();
  void begin_turn();
  Status run_turn(const Tick& tick);
  bool turn_stalled(Time now);
  void begin_back_off();

  // mission_buttons.cpp
  void begin_reach_button();
  Status run_reach_button();
  void begin_press();
  Status run_press(const Tick& tick);
  void begin_button_back();
  Status run_button_back(const Tick& tick);

  // True once the condition has held for `for_how_long`.
  bool settled(bool condition, Duration for_how_long, Time now);
  Status run_motion();  // done when the motion is
  void go_clear(const arm::JointVector& goal_rad);
  Room room() const;  // around the arm, as far as it is known
  void guard_with(const arm::GuardConfig& config) { guard_ = arm::GuardedMotion(config); }
  arm::JointVector measured_rad() const;
  arm::JointVector measured_nm() const;
  const Task& task() const { return config_.mission.tasks[task_index_]; }

  ControllerConfig config_;
  safety::Watch watch_;
  CameraWork camera_;
  Motion motion_;
  arm::Gripper gripper_;
  arm::Compliance compliance_;     // of the arm while it grips
  arm::GuardedMotion guard_;       // of approaches and presses, where touching is meant to happen
  arm::GuardedMotion free_guard_;  // of everything else
  PanelMap map_;
  safety::FaultReports faults_now_;
  FaultCounts fault_counts_{};
  FaultCounts faults_after_end_{};

  Step step_ = Step::idle;
  Time last_tick_;
  Time step_since_;
  bool entered_ = false;                           // begin() has run
  std::array<std::uint32_t, step_count> tries_{};  // of the task under way
  StepFailure failure_ = StepFailure::none;
  bool failing_ = false;   // the mission failed and is on its way to a safe end
  bool retrying_ = false;  // the task under way is taken again after the way back
  bool powered_ = false;

  std::size_t task_index_ = 0;
  StaticVector<TaskResult, MissionConfig::max_tasks> tasks_;
  Outcome outcome_;

  // Orders and answers from outside, taken at the next tick.
  bool start_ordered_ = false, home_ordered_ = false, jog_ordered_ = false, abort_ordered_ = false, stop_ordered_ = false;
  bool reset_ordered_ = false, shut_down_ordered_ = false;
  bool closing_ = false;  // shut down is under way, or over: no other order is taken
  Joint jog_joint_ = Joint::slew;
  double jog_goal_rad_ = 0;
  bool on_hold_ = false;
  CameraWork::Mode held_camera_ = CameraWork::Mode::idle;  // what it did when it was held
  std::int32_t port_error_ = 0;                            // 1 + the port that failed since the last tick
  bool clock_failed_ = false;                              // since the last tick
  std::uint32_t clockless_ticks_ = 0;                      // in a row
  std::uint32_t images_lost_ = 0;                          // known of
  ScanStats scan_stats_;
  PanelResult panel_;
  bool panel_arrived_ = false;

  std::uint32_t sweep_ = 0;
  Time settled_since_;  // of waits within a step
  bool settling_ = false;
  Time following_since_;            // the roll was last seen to follow the turn
  Vec3 standoff_m_ = Vec3::Zero();  // where straight motions start and return to
  double tool_roll_rad_ = 0;
  bool pressed_ = false;
};

}  // namespace lf::mission
