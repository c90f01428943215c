#include "host_sim/scenario/duration.hpp"

#include <gtest/gtest.h>

namespace lf::scenario {
namespace {

// There and back over the approach distance, twice for each task: one valve and three buttons.
TEST(Duration, ASlowApproachHasTheTimeThatItTakes) {
  const Scenario fast = load_scenario("default", {"mission.approach_speed_m_s=0.01"}),
                 slow = load_scenario("default", {"mission.approach_speed_m_s=0.001"});
  const double ways_m = 2 * 4 * 2 * fast.mission.approach_distance_m;
  EXPECT_NEAR(longest_mission_s(slow) - longest_mission_s(fast), ways_m / 0.001 - ways_m / 0.01, 1e-6);
}

TEST(Duration, IsNoLongerThanATimeLimitMayBe) {
  EXPECT_EQ(longest_mission_s(load_scenario(
                "default", {"mission.sweep_speed_rad_s=0.001", "mission.move_speed_fraction=0.01", "mission.approach_speed_m_s=0.001"})),
            7200);
}

}  // namespace
}  // namespace lf::scenario
