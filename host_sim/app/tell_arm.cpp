#include "host_sim/app/tell_arm.hpp"

#include <cstdio>

#include "hal/config/arm_notes.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/share.hpp"
#include "shared/arm/arm_description.hpp"

namespace lf::app {

void tell_arm_notes(const scenario::Scenario& scenario) {
  const std::string urdf = config::named_file(scenario.file, "arm.urdf", scenario.arm.urdf);
  std::vector<std::string> notes = config::arm_notes(urdf);
  const ArmDescription arm = load_arm_urdf(urdf);
  for (const std::string& note : config::holding_notes(arm, config::holding_of(arm, scenario.drives)))
    notes.push_back(scenario.file + ": " + note);
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
}

}  // namespace lf::app
