// Turns the valve: to a stand-off, straight to the handle, grip, turn, let go, straight back. What came of it the second look says (look.hpp).
#pragma once

#include "firmware/arm/guarded_motion.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class TurnValve {
 public:
  Progress begin(const StepTick& tick);
  Progress run(const StepTick& tick);
  // Of `advance`: reports what the arm touches while it is on hold.
  void watch_on_hold(const StepTick& tick);

 private:
  Progress begin_reach(Workbench& bench);
  Progress run_reach(const StepTick& tick);
  void begin_advance(Workbench& bench);
  Progress run_advance(const StepTick& tick);
  Progress run_grip(const StepTick& tick);
  void begin_turn(const StepTick& tick);
  Progress run_turn(const StepTick& tick);
  bool stalled(const StepTick& tick);
  void begin_let_go(Workbench& bench);
  Progress run_let_go(const StepTick& tick);

  arm::GuardedMotion guard_{arm::GuardConfig(0)};  // of the approach: what touches before the pads stand about the bar is in the way
  Time following_since_;                           // the roll was last seen to follow the turn
};

}  // namespace lf::mission
