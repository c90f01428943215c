// Reasons as runs gave them when a key was drawn over its range.
#include "host_sim/judge/range_rules.hpp"

#include <gtest/gtest.h>

#include "host_sim/scenario/keys.hpp"

namespace lf::judge {
namespace {

TEST(RangeRules, AReasonNamesTheKeyThatItCameOf) {
  EXPECT_TRUE(names_a_key({"water.ambient"}, "panel vision unsure: too few points of the panel"));
  EXPECT_TRUE(names_a_key({"lamps.power"}, "panel vision unsure: the handle's pointer mark was not recognised"));
  EXPECT_TRUE(names_a_key({"valve.friction_nm"}, "step failed: the turn stalled (The valve is stiff.)"));
  EXPECT_TRUE(names_a_key({"mounting.joints_deg"}, "step failed: the button gives way without bottoming"));
  EXPECT_TRUE(names_a_key({"mission.press_torque_nm"}, "overload: elbow, in step press"));
  EXPECT_TRUE(names_a_key({"drives.elbow.rated_torque_nm"}, "boot failed: elbow, in step boot; elbow"));
}

TEST(RangeRules, AReasonThatNamesAnotherCauseDoesNot) {
  EXPECT_FALSE(names_a_key({"water.ambient"}, "overload: elbow, in step press"));
  EXPECT_FALSE(names_a_key({"drives.elbow.rated_torque_nm"}, "boot failed: slew, in step boot; slew"));
  EXPECT_FALSE(names_a_key({"mission.approach_speed_m_s"}, "not ended by the time limit of 400 s, at 400.0 s"));
  EXPECT_FALSE(names_a_key({"friction.coulomb"}, "panel vision unsure: no panel seen"));
  // The name of the step is no cause.
  EXPECT_FALSE(names_a_key({"valve.friction_nm"}, "overload: slew, in step turn"));
  EXPECT_FALSE(names_a_key({"valve.friction_nm"}, "drive fault: jaw, in step reach valve"));
  EXPECT_FALSE(names_a_key({"buttons.spring_n_m"}, "following error: slew, in step press"));
  EXPECT_FALSE(names_a_key({"friction.coulomb"}, "camera silent, in step reach button"));
  EXPECT_FALSE(names_a_key({"camera.noise_grey"}, "overload: elbow (Look at the camera.)")) << "advice names nothing";
}

TEST(RangeRules, OfSeveralKeysOneIsNamed) {
  EXPECT_TRUE(names_a_key({"friction.coulomb", "water.ambient"}, "panel vision unsure: no panel seen"));
  EXPECT_FALSE(names_a_key({"friction.coulomb", "buttons.spring_n_m"}, "panel vision unsure: no panel seen"));
}

TEST(RangeRules, EveryKeyThatIsDrawnHasItsWords) {
  scenario::Scenario scenario;
  for (const config::Key& key : scenario::keys(scenario)) {
    const bool not_drawn = key.path == "description" || key.path == "time_limit_s" || key.path == "faults" ||
                           key.path == "expect.failure" || key.path == "safety.limits" || key.path == "safety.mission_limits";
    EXPECT_EQ(words_for(key.path).empty(), not_drawn) << key.path;
  }
}

}  // namespace
}  // namespace lf::judge
