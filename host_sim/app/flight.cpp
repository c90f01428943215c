#include "host_sim/app/flight.hpp"

#include "host_sim/judge/gear_limits.hpp"

namespace lf::app {
Flight::Flight(const scenario::Scenario& scenario, std::uint64_t seed, hal::SimObserver& observer, Sight sight) {
  const scenario::Sample sample = scenario::draw(scenario, seed);
  const scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  error_texts_ = nominal.error_texts;
  hal::SimConfig sim = scenario::make_truth(scenario, sample, nominal, 1);
  sim.given_sight = sight == Sight::given;
  names_ = scenario.survey.names;
  for (std::size_t i = 0; i < sim.devices.drives.size(); ++i) {
    deceleration_rad_s2_[i] = sim.devices.drives[i].max_acceleration_rad_s2;
    has_own_drives_ = has_own_drives_ && sim.devices.drives[i].habit == nullptr;
    const canopen::Ratio& position = nominal.controller.network.drives[i].profile.scale.position;
    units_per_count_[i] = double(position.num) / double(position.den);
    const judge::GearLimits gear = judge::gear_limits(sim.world.arm.joints[i], sim.world.drive_stiffness_nm_rad[i]);
    gear_gives_rad_[i] = gear.gives_rad;
    slips_rad_[i] = gear.slips_rad;
  }
  platform_ = std::make_unique<hal::SimPlatform>(sim, observer);
  controller_ = std::make_unique<Controller>(nominal.controller);
  pipeline_ = std::make_unique<ScanPipeline>(nominal.scan);
  rings_ = std::make_unique<hal::CoreRings>();
}

void Flight::step() {
  hal::NoProbe no_probe;
  (void)hal::control_turn(*platform_, *controller_, *rings_, out_, now_, no_probe);
  if (!platform_->vision_runs()) return;
  hal::vision_turn(*platform_, *pipeline_, *rings_, no_probe,
                   [this](Port port, hal::PortStatus code) { controller_->on_port_error(port, code, now_); });
}

}  // namespace lf::app
