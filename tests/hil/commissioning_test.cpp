// Commissioning against simulated drives whose encoders say something else than the arm's description does.
#include "hal/vehicle/commissioning.hpp"

#include <gtest/gtest.h>

#include "firmware/arm/actuator.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/arm/arm_geometry.hpp"

namespace lf::test {
namespace {

// Gears' play and what the arm gives under a third of its torque: the stop is felt that far beyond where it is.
constexpr double tolerance_rad = 0.02;

struct Bench {
  explicit Bench(const std::string& offset_deg) {
    const scenario::Scenario scenario = scenario::load_scenario("default", {"mounting.joints_deg=" + offset_deg});
    const scenario::Sample sample = scenario::draw(scenario, 1);
    const scenario::Nominal nominal = scenario::make_nominal(scenario, false);
    hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal, 1);
    truth.world.base_from_panel.translation().x() += 2;  // commissioned on deck
    config.network = nominal.controller.network;
    platform = std::make_unique<hal::SimPlatform>(truth, observer);
  }
  void run(hal::Commissioning& commissioning) {
    hal::run_commissioning(
        *platform, commissioning, [] { return false; }, [this](std::size_t joint) { told.push_back(joint); });
  }

  hal::SimObserver observer;
  std::unique_ptr<hal::SimPlatform> platform;
  hal::Commissioning::Config config;
  std::vector<std::size_t> told;
};

TEST(Commissioning, FindsWhatTheEncodersReadTooMuch) {
  for (const double offset_deg : {3.0, -3.0}) {
    Bench bench(std::to_string(offset_deg));
    hal::Commissioning commissioning(bench.config);
    bench.run(commissioning);
    ASSERT_EQ(commissioning.state(), hal::Commissioning::State::done) << commissioning.failure();
    EXPECT_EQ(bench.told, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
    for (std::size_t i = 0; i < joint_count; ++i) {
      const auto joint = static_cast<Joint>(i);
      const double lower = arm_geometry::joints[i].lower_rad;
      const double found_rad = commissioning.zero_counts()[i] * arm::rad_per_count(joint, lower);
      EXPECT_NEAR(found_rad, rad_from_deg(offset_deg), tolerance_rad) << hal::joint_name(i);
      EXPECT_TRUE(commissioning.found()[i]);
    }
  }
}

TEST(Commissioning, OneJointLeavesTheOthersAlone) {
  Bench bench("0");
  bench.config.joints = {false, false, false, true, false};
  const JointReadings before = bench.platform->world().readings();
  hal::Commissioning commissioning(bench.config);
  bench.run(commissioning);
  ASSERT_EQ(commissioning.state(), hal::Commissioning::State::done) << commissioning.failure();
  for (const std::size_t i : {0, 1, 2, 4})
    EXPECT_NEAR(bench.platform->world().readings()[i].position_rad, before[i].position_rad, 0.01) << i;
  EXPECT_EQ(commissioning.found(), bench.config.joints);
}

TEST(Commissioning, AnOpenEmergencyStopEndsItAndNothingIsFound) {
  Bench bench("0");
  bench.platform->devices().set_estop_closed(false);
  hal::Commissioning commissioning(bench.config);
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), hal::Commissioning::State::failed);
  EXPECT_EQ(commissioning.failure(), "the emergency-stop chain is open");
  for (const bool found : commissioning.found()) EXPECT_FALSE(found);
}

TEST(Commissioning, CanBeCancelled) {
  Bench bench("0");
  hal::Commissioning commissioning(bench.config);
  int ticks = 0;
  hal::run_commissioning(
      *bench.platform, commissioning, [&ticks] { return ++ticks > 500; }, [](std::size_t) {});
  EXPECT_EQ(commissioning.failure(), "cancelled");
}

}  // namespace
}  // namespace lf::test
