#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"

namespace lf::scenario {

namespace {

config::Machine machine_of(const Scenario& scenario, bool lamps_lit) {
  config::Machine machine;
  machine.file = scenario.file;
  machine.panel = scenario.panel;
  machine.valve = scenario.valve;
  machine.camera = scenario.camera;
  machine.laser = scenario.laser;
  machine.vehicle = scenario.vehicle;
  machine.arm_urdf = scenario.arm.urdf;
  machine.safety_limits = scenario.safety.limits;
  machine.mission_limits = scenario.safety.mission_limits;
  machine.homing_file = homing_file;
  machine.drives = scenario.drives;
  machine.mission = scenario.mission;
  machine.tasks = scenario.tasks;
  machine.lamps_lit = lamps_lit;
  machine.camera_always_on = scenario.camera.always_on;
  return machine;
}

}  // namespace

std::string joined(const std::vector<std::string>& problems) {
  std::string text;
  for (const std::string& problem : problems) text += (text.empty() ? "" : "\n") + problem;
  return text;
}

void add_job_problems(const Scenario& scenario, std::vector<std::string>& problems) {
  (void)config::make_core(machine_of(scenario, true), problems);
}

Nominal make_nominal(const Scenario& scenario, bool lamps_lit) {
  std::vector<std::string> problems;
  Nominal nominal = config::make_core(machine_of(scenario, lamps_lit), problems);
  if (!problems.empty()) throw InputError(joined(problems));
  for (const Fault& fault : scenario.faults) {
    if (fault.kind == "limits_refused") nominal.controller.limits.checksum ^= 1u;  // a bit of the file that turned over on the way
  }
  return nominal;
}

}  // namespace lf::scenario
