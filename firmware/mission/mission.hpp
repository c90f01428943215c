// The mission: one step of the table at a time, each begun and run by the object in charge of it.
//
// What a fault does is read from the table of faults (safety/faults.hpp), where a step leads from the table of steps (steps.hpp); neither is decided
// here. A tick collects the faults first; when one of them calls for a reaction, it is taken, and the step is not run.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/network.hpp"
#include "firmware/config.hpp"
#include "firmware/mission/empty_jaw.hpp"
#include "firmware/mission/fault_sources.hpp"
#include "firmware/mission/job.hpp"
#include "firmware/mission/look.hpp"
#include "firmware/mission/manual.hpp"
#include "firmware/mission/orders.hpp"
#include "firmware/mission/press_button.hpp"
#include "firmware/mission/start_up.hpp"
#include "firmware/mission/steps.hpp"
#include "firmware/mission/turn_valve.hpp"
#include "firmware/mission/way_home.hpp"
#include "firmware/mission/workbench.hpp"
#include "firmware/telemetry.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf::mission {

struct Outcome {
  bool ended = false;
  bool success = false;
  // Of the first fault that ended the mission.
  const char* stage = "";
  Step step = Step::idle;
  safety::Fault fault = safety::Fault::count;
  std::int32_t code = 0;
  std::uint16_t emcy = 0;  // with which the node at fault reported it, if it did; it may follow the fault
};

using FaultCounts = std::array<std::uint32_t, safety::fault_count>;

class Mission {
 public:
  explicit Mission(const ControllerConfig& config);

  // False, and nothing changes, when the table of orders or the order's own numbers do not allow it, or it has expired. Takes effect with the next tick.
  bool order(const Order& order, Time now);
  void on_panel(const PanelResult& result) { look_.on_panel(result); }
  void on_scan(const ScanStats& stats) {
    look_.on_scan(stats);
    bench_.camera.on_image(stats.newest_exposure);
  }
  void on_port_error(Port port) { sources_.on_port_error(port); }

  // One control period: reads the network's answers, sets its targets and outputs, and adds orders and events.
  void tick(Time now, canopen::Network& network, ScanOrders& orders, Telemetry& telemetry);

  Step step() const { return step_; }
  Standing standing() const { return mission::standing(step_, on_hold()); }
  const ScanStats& scan_stats() const { return look_.scan_stats(); }
  // What the newest look saw, by which a failed one is explained.
  const Sight& sight() const { return look_.sight(); }
  // The mission has ended and nothing is under power any more: the loop may end. A held arm is powered, and is watched on.
  bool over() const { return ended() && bench_.power.off(); }
  const safety::Power& power() const { return bench_.power; }
  const Outcome& outcome() const { return outcome_; }
  // What came up after the end, when nothing follows the mission any more; the outcome does not know of it.
  const FaultCounts& faults_after_end() const { return faults_after_end_; }
  const TaskResults& tasks() const { return bench_.job.results(); }
  const PanelMap& map() const { return bench_.map; }
  const safety::JointStates& joints() const { return bench_.watch.joints(); }
  // Nobody knows what the jaw holds; an arm must not be moved with it.
  bool jaw_doubted() const { return bench_.gripper.doubted(); }
  void doubt_jaw() { bench_.gripper.doubt(); }

 private:
  bool on_hold() const { return hold_.has_value(); }
  bool ended() const { return is_end(step_) && step_ != Step::held; }
  safety::Vigilance vigilance(const canopen::Network& network) const;
  void hold(Time now);
  void resume(Time now);
  void take_reset(const StepTick& tick);
  void take_shut_down(const StepTick& tick);
  void forget(const StepTick& tick);

  void observe(const StepTick& tick);
  // Takes the most severe reaction that the tick's reports call for. False when none is called for.
  bool settle_faults(const StepTick& tick);
  void record(const StepTick& tick, const safety::FaultReport& report, safety::Reaction reaction);
  void give_up(const safety::FaultReport& cause);
  void complete_outcome(const StepTick& tick);
  void react(const StepTick& tick, const safety::FaultArbiter::Verdict& verdict);
  void retreat(const StepTick& tick);
  void end_without_power(const StepTick& tick, Step end);
  void enter(const StepTick& tick, Step next);

  Progress work(const StepTick& tick);
  void watch_contact_on_hold(const StepTick& tick);
  Progress begin(const StepTick& tick);
  Progress run(const StepTick& tick);
  void report_failure(const StepTick& tick, const Progress& progress);
  // The jaw holds something, or may: the arm gives way to it.
  bool yielding() const;
  void expect_duration();
  void drive(const StepTick& tick);
  void watch_grip(const StepTick& tick);
  void report(const StepTick& tick);

  Workbench bench_;
  FaultSources sources_;
  safety::FaultArbiter arbiter_;
  std::size_t faults_recorded_ = 0;  // of the tick's reports
  FaultCounts fault_counts_{};
  FaultCounts faults_after_end_{};

  // In charge of the steps, by Activity.
  StartUp start_up_;
  Manual manual_;
  EmptyJaw empty_jaw_;
  Look look_;
  TurnValve turn_valve_;
  PressButton press_button_;
  WayHome way_home_;

  enum class Stage : std::uint8_t {
    coming_to_rest,  // a motion is planned from rest: the step begins when the arm stands
    under_way,       // begin() has run
  };
  Step step_ = Step::idle;
  Stage stage_ = Stage::coming_to_rest;
  StepClock clock_;
  std::uint32_t motions_before_ = 0;  // begun before this step
  Time last_tick_;
  std::optional<arm::JointVector> grip_lag_rad_;  // of the step under way, as it began
  std::optional<CameraWork::Mode> hold_;          // the operator holds the arm: what the camera did when it was held
  Outcome outcome_;
  bool nodes_stopped_ = false;  // for good, after a shut-down
};

}  // namespace lf::mission
