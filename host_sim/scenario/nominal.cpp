#include "host_sim/scenario/instance.hpp"

namespace lf::scenario {

Nominal make_nominal(const Scenario& scenario, bool lamps_lit) {
  config::Machine machine;
  machine.file = scenario.file;
  machine.panel = scenario.panel;
  machine.camera = scenario.camera;
  machine.laser = scenario.laser;
  machine.arm_urdf = scenario.arm.urdf;
  machine.safety_limits = scenario.safety.limits;
  machine.mission = scenario.mission;
  machine.tasks = scenario.tasks;
  machine.lamps_lit = lamps_lit;
  machine.camera_always_on = scenario.camera.always_on;
  return config::make_core(machine);
}

}  // namespace lf::scenario
