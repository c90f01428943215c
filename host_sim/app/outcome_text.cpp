#include "host_sim/app/outcome_text.hpp"

#include "hal/config/fault_text.hpp"

namespace lf::app {

std::string reason_of(const mission::Outcome& outcome, const config::ErrorTexts& texts, const mission::Sight& sight) {
  return config::fault_text(outcome.fault, outcome.code, outcome.emcy, texts, sight) + ", in step " + mission::row(outcome.step).name;
}

}  // namespace lf::app
