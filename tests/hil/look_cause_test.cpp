// Looks that fail for different causes, rendered and seen: the core's own numbers tell them apart. What is wrong is wrong in the simulated truth only; the core
// is told the default machine.
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/config/cause.hpp"
#include "hal/lockstep.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf {
namespace {

using Differ = std::function<void(scenario::Scenario&)>;

class FirstVerdict : public hal::SimObserver {
 public:
  void on_telemetry(const Telemetry& telemetry) override {
    for (const Event& event : telemetry.events) {
      if (told || (event.kind != Event::Kind::fault && event.kind != Event::Kind::located)) continue;
      if (event.kind == Event::Kind::fault && event.fault != safety::Fault::vision_poor && event.fault != safety::Fault::step_failed)
        continue;
      told = event;
      sight = telemetry.sight;
    }
  }
  std::optional<Event> told;
  mission::Sight sight;
};

struct Verdict {
  bool located = false;
  config::Cause cause;
  std::string seen;
};

// What the first look of a mission comes to.
Verdict first_look(const Differ& differ, std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.begin(), {"docking.x_m=0", "docking.y_m=0", "docking.z_m=0", "water.attenuation_per_m=0.3"});
  const scenario::Scenario told = scenario::load_scenario("turn_only", overrides);
  scenario::Scenario real = told;
  differ(real);
  const scenario::Sample sample = scenario::draw(real, 1);
  const scenario::Nominal nominal = scenario::make_nominal(told, sample.lamps_lit);
  FirstVerdict first;
  hal::SimPlatform platform(scenario::make_truth(real, sample, nominal, 2), first);
  hal::Lockstep<hal::SimPlatform> lockstep(platform, nominal.controller, nominal.scan);
  lockstep.controller().on_command(Command::start, Time{});
  while (!first.told && !lockstep.ended() && lockstep.now().s() < 120) lockstep.step();
  Verdict verdict;
  verdict.located = first.told && first.told->kind == Event::Kind::located;
  verdict.seen = config::sight_text(first.sight);
  if (first.told && !verdict.located) verdict.cause = config::cause_of(first.told->fault, first.told->code, first.sight);
  return verdict;
}

void expect_cause(const std::string& name, const std::string& remedy, const Differ& differ,
                  const std::vector<std::string>& overrides = {}) {
  const Verdict verdict = first_look(differ, overrides);
  EXPECT_FALSE(verdict.located) << verdict.seen;
  EXPECT_NE(verdict.cause.name.find(name), std::string::npos) << verdict.cause.name << "\n  " << verdict.seen;
  EXPECT_NE(verdict.cause.remedy.find(remedy), std::string::npos) << verdict.cause.remedy;
}

TEST(LookCause, APanelAtItsPlaceInClearWaterIsLocated) {
  const Verdict verdict = first_look([](scenario::Scenario&) {});
  EXPECT_TRUE(verdict.located) << verdict.cause.name << verdict.seen;
}

TEST(LookCause, WaterThatHidesAll) {
  expect_cause("the water is too turbid", "clearer water",
               [](scenario::Scenario& real) {
                 real.water.attenuation_per_m = {5, 5};
               },
               {"lamps.lit=false"});
}

TEST(LookCause, AnExposureThatIsTooShort) {
  expect_cause("the pictures are dark", "camera.exposure_us", [](scenario::Scenario&) {}, {"camera.exposure_us=10", "lamps.lit=true"});
}

TEST(LookCause, AnExposureThatIsTooLong) {
  expect_cause("the pictures are white", "camera.exposure_us", [](scenario::Scenario&) {}, {"camera.exposure_us=30000", "lamps.lit=true"});
}

TEST(LookCause, AVehicleDockedHalfAMetreOff) {
  expect_cause("off its nominal place", "Dock again", [](scenario::Scenario& real) { real.panel.nominal_x_m += 0.5; });
  expect_cause("neither marker nor handle is at its place", "dock again", [](scenario::Scenario& real) { real.panel.nominal_y_m -= 0.5; });
}

TEST(LookCause, AMarkerHiddenByAButton) {
  expect_cause("the marker is hidden", "what covers, blurs or outshines the marker",
               [](scenario::Scenario& real) { real.panel.buttons[0].at_m = real.panel.markers[0].centre_m; }, {"lamps.lit=false"});
}

TEST(LookCause, ALaserThatIsOff) {
  expect_cause("the laser's line is missing or too weak", "the laser's power", [](scenario::Scenario& real) { real.laser.power_w = 0; });
}

}  // namespace
}  // namespace lf
