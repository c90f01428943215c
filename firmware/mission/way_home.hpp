// The way home: out of a contact, to the park position, and the power off.
#pragma once

#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class WayHome {
 public:
  void begin(const StepTick& tick);
  Progress run(const StepTick& tick);

 private:
  static Progress run_abandon(const Workbench& bench);
  Progress run_stow(Workbench& bench);
  static void begin_shut_down(const StepTick& tick);

  bool freed_ = false;        // the jaw lets go of what it has closed on
  bool stops_ = false;        // before that
  bool leaves_open_ = false;  // on with an open jaw
};

}  // namespace lf::mission
