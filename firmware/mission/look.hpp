// Looks: goes where the sweep begins, sweeps the laser, takes a still, asks panel vision, and takes its answer. The second look, after a turn, sees only
// the handle's surroundings and judges the angle.
#pragma once

#include "firmware/mission/sight.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::mission {

// The first sweep: over the panel wherever the docked vehicle may have brought it.
scan::SweepRequest sweep_over_panel(const MissionConfig& mission);

class Look {
 public:
  void begin(const StepTick& tick);
  Progress run(const StepTick& tick);
  // An answer to an earlier question came too late to matter and is ignored.
  void on_panel(const PanelResult& result);
  void on_scan(const ScanStats& stats) { stats_ = stats; }

  // Of the newest answer that was taken.
  const Sight& sight() const { return sight_; }
  const ScanStats& scan_stats() const { return stats_; }

 private:
  void begin_deploy(const StepTick& tick);
  void begin_verify_reach(const StepTick& tick);
  void begin_scan(const StepTick& tick);
  Progress run_scan(const StepTick& tick);
  static Progress run_verify_reach(Workbench& bench);
  void begin_question(const StepTick& tick);
  // True when the answer is there; reports vision that is late.
  bool answered(const StepTick& tick);
  StepFailure take_answer(Workbench& bench, PanelMap::Valves wanted);
  Progress run_perceive(const StepTick& tick);
  Progress run_verify(const StepTick& tick);
  void send(const StepTick& tick, ScanCommand::Kind kind) const;

  std::uint32_t sweep_ = 0;
  PanelResult panel_;
  bool panel_arrived_ = false;
  ScanStats stats_, before_sweep_;
  Sight sight_;
};

}  // namespace lf::mission
