// Power up: waits for the order, boots the nodes, enables the drives, and homes the joints.
#pragma once

#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class StartUp {
 public:
  void begin(const StepTick& tick);
  Progress run(const StepTick& tick);

 private:
  enum class Aim : std::uint8_t { job, wait };  // what follows: the job, or waiting for orders

  Progress run_idle(const StepTick& tick);
  void begin_boot(const StepTick& tick);
  Progress run_boot(const StepTick& tick);
  Progress run_enable(const StepTick& tick);
  Progress run_home(const StepTick& tick);
  static void forget_complaints(const StepTick& tick);
  static void tolerate_excursion(const StepTick& tick);

  Aim aim_ = Aim::job;
};

}  // namespace lf::mission
