// Valves that do not turn as they should, and handles that are not where they were seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "firmware/arm/gripper.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using mission::Step;
using safety::Fault;

std::vector<std::string> turn_only() { return {"tasks=[{turn_valve: {to_deg: 90}}]"}; }

long times_begun(const Rig& rig, Step step) {
  return std::count_if(rig.events().begin(), rig.events().end(),
                       [step](const Event& event) { return event.kind == Event::Kind::step && event.step == step; });
}

double when_turning_s() {
  Rig rehearsal(turn_only());
  rehearsal.start();
  EXPECT_TRUE(rehearsal.run_to(Step::turn)) << rehearsal.story();
  rehearsal.run_for(1);
  return rehearsal.now().s();
}

// The roll does not move for a while, as a gear with a pebble in it.
TEST(Turn, ThatStallsIsLetGoLookedAtAndTakenUpAgain) {
  std::vector<std::string> overrides = turn_only();
  overrides.push_back("faults=[{at_s: " + std::to_string(when_turning_s()) + ", kind: following, node: roll, duration_s: 0.6}]");
  Rig rig(overrides);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_NEAR(rig.world().valve_angle_rad(0), pi / 2, rad_from_deg(3)) << rig.story();
  EXPECT_EQ(times_begun(rig, Step::turn), 2) << rig.story();
  EXPECT_EQ(rig.count(Fault::step_failed), 1u) << rig.story();
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
}

// It stalls as a stuck handle would, and goes on pushing when the jaw has let go.
TEST(Turn, WhoseRollHasSeizedNamesItAndLosesItsPower) {
  for (const Step step : {Step::advance, Step::turn}) {
    Rig rig(turn_only());
    rig.start();
    ASSERT_TRUE(rig.run_to(step)) << rig.story();
    rig.run_for(0.5);
    rig.devices().add_fault({0, devices::DeviceFaultKind::following, 4}, rig.now());
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    rig.run_for(2);
    EXPECT_EQ(rig.outcome().fault, Fault::following_error) << rig.story();
    EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(arm5e_joint::roll)) << rig.story();
    EXPECT_FALSE(rig.any_power()) << rig.story();
  }
}

// Something thicker than the bar is between the fingers: they are not closed on it again.
TEST(AGrip, OfWhatIsNoBarIsGivenUpAtOnce) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::grip)) << rig.story();
  rig.block_jaw(arm::jaw_from_gap(test::jaw5e, 0.030), test::arm5e.model().joints[4].upper_rad);
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::step_failed) << rig.story();
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::not_gripped)) << rig.story();
  EXPECT_EQ(times_begun(rig, Step::grip), 1) << rig.story();
  EXPECT_EQ(times_begun(rig, Step::turn), 0) << rig.story();
}

// The handle breaks off in the jaw, which closes on nothing.
TEST(Turn, ThatLosesItsHandleSaysSoAndLooksAgain) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
  rig.run_for(1);
  rig.break_handle();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.count(Fault::grip_lost), 1u) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::not_gripped)) << "there is nothing any more: " << rig.story();
  EXPECT_EQ(times_begun(rig, Step::turn), 1) << rig.story();
}

// The handle has followed, and both looks after it see it elsewhere.
TEST(Turn, WhoseHandleIsSeenElsewhereIsTriedAsOftenAsMayBeAndFails) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
  rig.sight().mistake_handle(rad_from_deg(-25));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_FALSE(rig.outcome().success);
  EXPECT_EQ(rig.outcome().fault, Fault::step_failed) << rig.story();
  const auto why = static_cast<StepFailure>(rig.outcome().code);
  EXPECT_TRUE(why == StepFailure::slipped || why == StepFailure::wrong_angle || why == StepFailure::not_gripped) << rig.story();
  EXPECT_EQ(times_begun(rig, Step::turn), 3) << rig.story();
}

TEST(Turn, OfAHandleThatIsStuckIsTriedThreeTimesAndEndsStowed) {
  std::vector<std::string> overrides = turn_only();
  overrides.emplace_back("valve.friction_nm=20");
  Rig rig(overrides);
  const double before_rad = rig.world().valve_angle_rad(0);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::step_failed);
  EXPECT_EQ(rig.outcome().code, static_cast<std::int32_t>(StepFailure::stalled)) << rig.story();
  EXPECT_EQ(times_begun(rig, Step::turn), 3) << rig.story();
  EXPECT_LT(std::abs(rig.world().valve_angle_rad(0) - before_rad), rad_from_deg(25)) << "20 N m give way a little to a roll at its limit";
  EXPECT_LT(rig.world().contacts().grip_force_n, 1) << "still held";
}

// How hard the arm pulls at the panel while it turns a handle that is not where it was seen.
struct Pull {
  double settled_n = 0;  // by the end of the turn
  Step end = Step::idle;
  std::string story;
};

Pull pull(const Vec3& mistake_m) {
  Rig rig(turn_only());
  rig.sight().mistake(mistake_m);
  rig.start();
  Pull pull;
  if (!rig.run_to(Step::let_go)) ADD_FAILURE() << rig.story();
  pull.settled_n = rig.world().contacts().handle_force_n.norm();
  EXPECT_NEAR(rig.world().valve_angle_rad(0), pi / 2, rad_from_deg(3)) << rig.story();
  rig.run_to_end();
  pull.end = rig.step_now();
  pull.story = rig.story();
  return pull;
}

class MisplacedHandle : public testing::TestWithParam<Vec3> {};

// They pull with 17 to 43 N: 0.01 mm of the mistake, or another build's rounding, moves that by 30. The bound is midway to what a rigid arm was seen to pull with.
TEST_P(MisplacedHandle, IsTurnedWithoutForcingIt) {
  const Pull pulled = pull(GetParam());
  std::printf("it pulls with %.0f N\n", pulled.settled_n);
  EXPECT_LT(pulled.settled_n, 95) << pulled.story;
  EXPECT_EQ(pulled.end, Step::done) << pulled.story;
}

INSTANTIATE_TEST_SUITE_P(ByFourMillimetres, MisplacedHandle,
                         testing::Values(Vec3(0.004, 0, 0), Vec3(-0.004, 0, 0), Vec3(0, 0.004, 0), Vec3(0, -0.004, 0)));

}  // namespace
}  // namespace lf::test
