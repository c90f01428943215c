#include "tests/hil/rig.hpp"

#include <algorithm>
#include <cmath>

#include "tests/hil/mission_run.hpp"

namespace lf::test {

Rig::Rig(const std::vector<std::string>& overrides, std::uint64_t seed, const Tell& tell, const Make& make) {
  const scenario::Scenario scenario = scenario::load_scenario("default", overrides);
  const scenario::Sample sample = scenario::draw(scenario, seed);
  scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal, 1);
  // Nobody looks at the pictures.
  for (optics::CameraConfig& camera : truth.optics.cameras) {
    camera.intrinsics.width = 16;
    camera.intrinsics.height = 12;
  }
  if (tell) tell(nominal.controller);
  if (make) make(truth);
  arm_ = truth.world.arm;
  platform_ = std::make_unique<hal::SimPlatform>(truth, recorder_);
  sight_ = std::make_unique<KnownSight>(*platform_, nominal.controller, scenario::true_base_from_panel(scenario.panel, sample));
  failing_ = std::make_unique<Platform>(*sight_);
  lockstep_ = std::make_unique<hal::Lockstep<Platform>>(*failing_, nominal.controller, nominal.scan);
}

void Rig::step() { lockstep_->step(); }

void Rig::run_for(double seconds) {
  const Time end = now() + Duration::from_s(seconds);
  while (now() < end) step();
}

bool Rig::run_to(mission::Step wanted, double limit_s) {
  const Time end = now() + Duration::from_s(limit_s);
  while (step_now() != wanted && !outcome().ended && now() < end) step();
  return step_now() == wanted;
}

bool Rig::run_to_end(double limit_s) {
  const Time end = now() + Duration::from_s(limit_s);
  while (!outcome().ended && now() < end) step();
  return outcome().ended;
}

double Rig::fastest_joint_rad_s() const {
  double fastest = 0;
  for (const JointReading& joint : world().readings()) fastest = std::max(fastest, std::abs(joint.velocity_rad_s));
  return fastest;
}

std::uint32_t Rig::count(safety::Fault fault) const {
  return static_cast<std::uint32_t>(std::count_if(recorder_.events.begin(), recorder_.events.end(), [fault](const Event& event) {
    return event.kind == Event::Kind::fault && event.fault == fault;
  }));
}

std::string Rig::story() {
  MissionRun run;
  run.outcome = outcome();
  run.events = recorder_.events;
  run.simulated_s = now().s();
  run.valve_rad = world().valve_angle_rad(0);
  for (std::size_t i = 0; i < run.presses.size(); ++i) run.presses[i] = world().button(i).presses;
  return describe(run);
}

}  // namespace lf::test
