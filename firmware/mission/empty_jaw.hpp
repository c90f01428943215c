// Before the first motion: finds out what the jaw holds, and gets free of it.
//
// After a stop in mid-turn the handle is still in the jaw. The jaw closes first, which moves nothing else: when it closes completely it is empty. Otherwise
// it opens, with the arm giving way, and the arm goes straight back along the tool's axis under guard. Only then does anything else move.
#pragma once

#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class EmptyJaw {
 public:
  Progress begin(const StepTick& tick);
  Progress run(const StepTick& tick);

 private:
  Progress run_check(const StepTick& tick);
  Progress begin_back_out(Workbench& bench);

  bool freed_ = false;  // already, since the last start: what stalls the jaw now is not a handle
};

}  // namespace lf::mission
