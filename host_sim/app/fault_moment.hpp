// When a fault is made.
#pragma once

#include <string>

#include "firmware/mission/steps.hpp"

namespace lf::app {

// When a step of a walk has a fault made in it.
struct FaultMoment {
  std::string walk;
  mission::Step step = mission::Step::idle;
  std::string name;  // of the step, or "power-on"
  double at_s = 0;
  double into_s = 0;  // since the step began
};

// Of a step's duration: whatever it does is under way.
inline constexpr double usual_share_of_step = 0.4;

}  // namespace lf::app
