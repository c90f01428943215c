// What a scenario's keys change in what the robot does.
#include <gtest/gtest.h>

#include <string>

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

}  // namespace
}  // namespace lf::test
