#include "host_sim/app/tell_arm.hpp"

#include <cstdio>

#include "hal/config/arm_notes.hpp"
#include "hal/config/share.hpp"

namespace lf::app {

void tell_arm_notes(const scenario::Scenario& scenario) {
  const std::string urdf = config::named_file(scenario.file, "arm.urdf", scenario.arm.urdf);
  for (const std::string& note : config::arm_notes(urdf)) std::fprintf(stderr, "note: %s\n", note.c_str());
}

}  // namespace lf::app
