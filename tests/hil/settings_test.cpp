// What a scenario's keys change in what the robot does.
#include <gtest/gtest.h>

#include <string>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using mission::Step;

double scan_s(const std::vector<std::string>& overrides) {
  Rig rig(overrides);
  rig.start();
  EXPECT_TRUE(rig.run_to(Step::scan)) << rig.story();
  const Time begun = rig.now();
  EXPECT_TRUE(rig.run_to(Step::look)) << rig.story();
  return (rig.now() - begun).s();
}

// The sweep takes its way through its speed; run-up, run-out and the wait for the last image take half a second.
TEST(SweepSpeed, IsTheScenarios) {
  const double usual_s = scan_s({}) - 0.5, faster_s = scan_s({"mission.sweep_speed_rad_s=0.1"}) - 0.5;
  EXPECT_NEAR(usual_s / faster_s, 0.1 / 0.065, 0.05);
}

// A lamp hangs where the sweep begins: the core is told of it, and the arm does not set out. The mission fails where it stands, by the obstacle's name.
TEST(AVehicleInTheWay, IsNamedBeforeAnythingMoves) {
  Rig usual;
  usual.start();
  ASSERT_TRUE(usual.run_to(Step::scan)) << usual.story();
  const Vec3 tool = usual.world().base_from_tool().translation();
  Rig rig({}, 1, [&](ControllerConfig& told) { (void)told.mission.vehicle.rods.push_back({tool, tool, 0.02}); });
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy)) << rig.story();
  const JointReadings before = rig.world().readings();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_EQ(rig.outcome().step, Step::deploy) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::vehicle_in_the_way)) << rig.story();
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i)
    EXPECT_NEAR(rig.world().readings()[i].position_rad, before[i].position_rad, 0.002) << i;
}

// The same where the panel may stand anywhere within a decimetre.
TEST(ADockingThatIsHardlyKnown, KeepsTheArmWhereItIs) {
  Rig rig({}, 1, [](ControllerConfig& told) { told.mission.docking.shift_m = 0.1; });
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.outcome().step, Step::deploy) << rig.story();
}

}  // namespace
}  // namespace lf::test
