// Presses a button: to a stand-off, straight into it until the torque says that it has bottomed, and straight back.
#pragma once

#include "firmware/arm/guarded_motion.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class PressButton {
 public:
  Progress begin(const StepTick& tick);
  Progress run(const StepTick& tick);

 private:
  Progress begin_reach(Workbench& bench);
  Progress run_reach(const StepTick& tick);
  Progress begin_press(Workbench& bench);
  Progress run_press(const StepTick& tick);
  Progress run_back(const StepTick& tick);

  arm::GuardedMotion guard_;  // of the press, where touching is meant to happen
  bool pressed_ = false;
};

}  // namespace lf::mission
