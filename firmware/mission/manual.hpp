// By hand: waits for an operator's orders under power, and jogs one joint at a time.
#pragma once

#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class Manual {
 public:
  void begin(const StepTick& tick);
  Progress run(const StepTick& tick);

 private:
  Progress run_ready(const StepTick& tick);

  Progress run_jog(const StepTick& tick);

  WaitingOrder jog_;
  bool jaw_waits_ = false;  // until it is known to have room
};

// Where a jog that is ordered now would end. Nothing when its numbers, the joint's limits or the tool's workspace do not allow it, and for an arm joint
// while the jaw may hold something. What stands outside may only come closer.
std::optional<double> jog_goal_rad(const Order& order, const Workbench& bench);

}  // namespace lf::mission
