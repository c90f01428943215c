#include <array>
#include <cstdio>

#include "hal/config/joined.hpp"
#include "hal/config/share.hpp"
#include "host_sim/scenario/bounds.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"

namespace lf::scenario {

namespace {

config::Machine machine_of(const Scenario& scenario, bool lamps_lit) {
  config::Machine machine;
  machine.file = scenario.file;
  machine.told_also = scenario.machine;
  machine.panel = scenario.panel;
  machine.survey = scenario.survey;
  machine.camera = scenario.camera;
  machine.laser = scenario.laser;
  machine.vehicle = scenario.vehicle;
  machine.arm_urdf = scenario.arm.urdf;
  machine.park_rad = scenario.arm.park_rad;
  machine.arm = scenario.told_arm;
  machine.joints = scenario.joints;
  machine.arm_told = scenario.arm_told;
  machine.safety_limits = scenario.safety.limits;
  machine.mission_limits = scenario.safety.mission_limits;
  // The shipped file has the default machine's joints.
  if (scenario.joints == JointNames()) machine.homing_file = homing_file;
  machine.zeros_by_construction = true;
  machine.drives = scenario.drives;
  machine.mission = scenario.mission;
  machine.tasks = scenario.tasks;
  machine.lamps_lit = lamps_lit;
  machine.camera_always_on = scenario.camera.always_on;
  return machine;
}

template <class... Values>
std::string formatted(const char* form, Values... values) {
  std::array<char, 320> text;
  (void)std::snprintf(text.data(), text.size(), form, values...);
  return text.data();
}

// A scenario that is to end by late images or answers may make them late.
void check_latencies(const Scenario& scenario, std::vector<std::string>& problems) {
  const auto expects = [&](safety::Fault fault) { return scenario.expect.failure == safety::name(fault); };
  const bool late_images = expects(safety::Fault::image_lost) || expects(safety::Fault::camera_lost);
  const LongestLatencies longest = longest_latencies(scenario);
  const auto refuse = [&](const std::string& text) { problems.push_back(scenario.file + ": " + text); };
  const Latency& latency = scenario.latency;
  if (latency.image_ms > longest.image_ms && !late_images)
    refuse(formatted("'latency.image_ms' is %.6g: by 'stale_image_s' in %s every image later than %.6g ms counts as lost", latency.image_ms,
                     longest.limits_file.c_str(), longest.image_ms));
  if (latency.panel_vision_ms > longest.panel_vision_ms && !expects(safety::Fault::vision_late))
    refuse(formatted("'latency.panel_vision_ms' is %.6g: by 'vision_timeout_s' in %s no answer is waited for longer than %.6g ms",
                     latency.panel_vision_ms, longest.limits_file.c_str(), longest.panel_vision_ms));
}

void check_jaw(const Scenario& scenario, std::vector<std::string>& problems) {
  const std::string file = config::named_file(scenario.file, "arm.urdf", scenario.arm.urdf);
  const double rated_nm = load_arm_urdf(file).jaw().rated_torque_nm;
  if (scenario.jaw.torque_nm == 0 || scenario.jaw.torque_nm >= rated_nm) return;
  problems.push_back(
      scenario.file + ": " +
      formatted("'jaw.torque_nm' is %.4g, below the rated torque of %.4g N m that %s states for the jaw: the jaw closes with "
                "its motor's peak torque. 0 takes the URDF's",
                scenario.jaw.torque_nm, rated_nm, file.c_str()));
}

// With what of the simulation does not go with the core's limits and arm.
Nominal make_core(const Scenario& scenario, bool lamps_lit, std::vector<std::string>& problems) {
  const std::size_t told = problems.size();
  Nominal core = config::make_core(machine_of(scenario, lamps_lit), problems);
  if (problems.size() > told) return core;  // a file that cannot be read is told once
  check_latencies(scenario, problems);
  check_jaw(scenario, problems);
  return core;
}

}  // namespace

void add_job_problems(const Scenario& scenario, std::vector<std::string>& problems) { (void)make_core(scenario, true, problems); }

Nominal make_nominal(const Scenario& scenario, bool lamps_lit) {
  std::vector<std::string> problems;
  Nominal nominal = make_core(scenario, lamps_lit, problems);
  if (!problems.empty()) throw InputError(config::joined(problems));
  for (const Fault& fault : scenario.faults) {
    if (fault.kind == "limits_refused") nominal.controller.limits.checksum ^= 1u;  // a bit of the file that turned over on the way
  }
  return nominal;
}

}  // namespace lf::scenario
