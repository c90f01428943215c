// Jogs of single joints by an operator, also of an arm that was found outside its limits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Standing;
using mission::Step;
using safety::Fault;

// ---- jog ----

class Jog : public testing::TestWithParam<std::size_t> {};

TEST_P(Jog, MovesItsJointThereAndBackAndNoOther) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const auto before = angles_rad(rig);
  const auto moved = static_cast<std::size_t>(GetParam());
  // A quarter of the joint's own speed, or the joint's stiction speed; the jaw opens and closes as fast as ever.
  const ArmJoint& joint = rig.arm().joints[moved];
  const double part = GetParam() == arm5e_joint::jaw ? 1 : mission::jog_speed_fraction;
  const double fast_rad_s = 1.4 * std::max(part * joint.velocity_rad_s, joint.stiction_rad_s);
  for (const double by_rad : {0.1, -0.2, 0.1}) {
    const auto from = angles_rad(rig);
    ASSERT_TRUE(jog(rig, GetParam(), by_rad));
    rig.run_for(0.02);
    EXPECT_EQ(rig.mission().standing(), Standing::jogging);
    double fastest = 0;
    const Time began = rig.now();
    while (rig.mission().standing() == Standing::jogging && rig.now() - began < Duration::from_s(20)) {
      rig.step();
      fastest = std::max(fastest, rig.fastest_joint_rad_s());
    }
    ASSERT_EQ(rig.mission().standing(), Standing::ready) << rig.story();
    // Where it is done is where it was to go: the jaw's play, and the arm's following at the end of a move.
    EXPECT_NEAR(angle_rad(rig, GetParam()), from[moved] + by_rad, 0.012);
    EXPECT_GT(fastest, standing_rad_s);
    EXPECT_LT(fastest, fast_rad_s) << "nobody sees the end of such a move";
    auto others = angles_rad(rig);
    others[moved] = from[moved];
    EXPECT_LT(farthest_apart(others, from), 0.005);
  }
  EXPECT_NEAR(angle_rad(rig, GetParam()), before[moved], 0.02);
  EXPECT_EQ(rig.step_now(), Step::ready) << rig.story();
}

std::string name_of(const testing::TestParamInfo<std::size_t>& test) {
  constexpr std::array names{"Slew", "Shoulder", "Elbow", "Roll", "Jaw"};
  return names[static_cast<std::size_t>(test.param)];
}

INSTANTIATE_TEST_SUITE_P(OfEachJoint, Jog,
                         testing::Values(arm5e_joint::slew, arm5e_joint::shoulder, arm5e_joint::elbow, arm5e_joint::roll, arm5e_joint::jaw),
                         name_of);

TEST(JogInTheSameTick, AsAnotherIsRefusedAndTheFirstIsDoneOnce) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const double slew_rad = angle_rad(rig, arm5e_joint::slew), roll_rad = angle_rad(rig, arm5e_joint::roll);
  ASSERT_TRUE(jog(rig, arm5e_joint::slew, 0.1));
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, 0.1));
  EXPECT_FALSE(jog(rig, arm5e_joint::roll, 0.2));
  ASSERT_TRUE(finish_jog(rig));
  rig.run_for(2);
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::slew), slew_rad + 0.1, 0.01);
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::roll), roll_rad, 0.005);
  EXPECT_EQ(rig.controller().orders_refused(), 2u);
}

TEST(JogInTheSameTick, AsTheStartIsRefused) {
  Rig rig(press_only());
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(give(rig, Command::start));
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, 0.1));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(JogUnderWay, IsNotReplaced) {
  for (const std::size_t joint : {arm5e_joint::elbow, arm5e_joint::jaw}) {
    Rig rig;
    ASSERT_TRUE(home(rig)) << rig.story();
    const double from_rad = angle_rad(rig, joint);
    ASSERT_TRUE(jog(rig, joint, -0.2));
    rig.run_for(0.2);
    EXPECT_FALSE(jog(rig, joint, -0.2)) << rig.story();
    ASSERT_TRUE(finish_jog(rig));
    EXPECT_NEAR(angle_rad(rig, joint), from_rad - 0.2, 0.012);
  }
}

TEST(JogByTheWrongNumbers, IsRefused) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const auto before = angles_rad(rig);
  for (const double by_rad : {0.36, -0.36, 1e9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(jog(rig, arm5e_joint::slew, by_rad)) << by_rad;
  EXPECT_FALSE(jog(rig, arm5e_joint::count, 0.1));
  rig.run_for(1);
  EXPECT_LT(farthest_apart(angles_rad(rig), before), 0.003);
}

// Before the first look the panel may be 20 mm and 2 degrees nearer than where it should stand.
TEST(JogTowardThePanel, EndsBeforeItAndSaysWhy) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, arm5e_joint::shoulder, 0.35));
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, arm5e_joint::shoulder, 0.3));
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_EQ(rig.count(Fault::step_failed), 0u) << rig.story();
  double before_rad = 0;
  for (int jogs = 0; rig.count(Fault::step_failed) == 0; ++jogs) {
    ASSERT_LT(jogs, 20) << rig.story();
    before_rad = angle_rad(rig, arm5e_joint::elbow);
    ASSERT_TRUE(jog(rig, arm5e_joint::elbow, -0.1)) << rig.story();
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
  }
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::elbow), before_rad, 0.003) << "it moved before it was refused";
  EXPECT_EQ(rig.events().rbegin()[1].code, static_cast<std::int32_t>(StepFailure::panel_in_the_way)) << rig.story();
  EXPECT_TRUE(rig.world().contacts().unintended.empty());
  ASSERT_TRUE(jog(rig, arm5e_joint::elbow, 0.2)) << "back again";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::elbow), before_rad + 0.2, 0.012);
  EXPECT_EQ(rig.count(Fault::step_failed), 1u);
}

class JogToTheEnd : public testing::TestWithParam<std::size_t> {};

// As far as it is let, either way: never out of the limits, nor against a stop.
TEST_P(JogToTheEnd, StopsBeforeIt) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const auto i = static_cast<std::size_t>(GetParam());
  const ArmJoint& stroke = rig.arm().joints[i];
  for (const double direction : {1.0, -1.0}) {
    int jogs = 0;
    for (double by_rad = 0.35; by_rad > 0.01; by_rad /= 2) {
      while (jog(rig, GetParam(), direction * by_rad)) {
        ASSERT_LT(++jogs, 60);
        ASSERT_TRUE(finish_jog(rig)) << rig.story();
        EXPECT_GE(angle_rad(rig, GetParam()), stroke.lower_rad);
        EXPECT_LE(angle_rad(rig, GetParam()), stroke.upper_rad);
      }
    }
    const double end_rad = direction > 0 ? stroke.upper_rad : stroke.lower_rad;
    EXPECT_NEAR(angle_rad(rig, GetParam()), end_rad, 0.07) << "it could have gone on";
  }
  EXPECT_EQ(rig.mission().standing(), Standing::ready) << rig.story();
}

INSTANTIATE_TEST_SUITE_P(OfTheWristAndTheJaw, JogToTheEnd, testing::Values(arm5e_joint::roll, arm5e_joint::jaw), name_of);

TEST(JogOnHold, GoesOnToItsEnd) {
  for (const std::size_t joint : {arm5e_joint::slew, arm5e_joint::jaw}) {
    Rig rig;
    ASSERT_TRUE(home(rig)) << rig.story();
    const double from_rad = angle_rad(rig, joint);
    ASSERT_TRUE(jog(rig, joint, 0.2));
    rig.run_for(0.25);
    ASSERT_TRUE(give(rig, Command::hold));
    rig.run_for(halt_time_s);
    const double held_rad = angle_rad(rig, joint);
    rig.run_for(10);
    EXPECT_NEAR(angle_rad(rig, joint), held_rad, 0.003);
    EXPECT_LT(held_rad, from_rad + 0.19) << "there was nothing left to hold";
    ASSERT_TRUE(give(rig, Command::resume));
    ASSERT_TRUE(run_until(rig, Standing::ready, 20)) << rig.story();
    EXPECT_NEAR(angle_rad(rig, joint), from_rad + 0.2, 0.012);
  }
}

TEST(AbortOfAJog, Stows) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, arm5e_joint::slew, 0.3));
  rig.run_for(0.5);
  ASSERT_EQ(rig.mission().standing(), Standing::jogging);
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::aborted);
}

TEST(AJobAfterJogs, IsDone) {
  Rig rig(turn_only());
  ASSERT_TRUE(home(rig)) << rig.story();
  for (const std::size_t joint : {arm5e_joint::slew, arm5e_joint::roll, arm5e_joint::jaw}) {
    ASSERT_TRUE(jog(rig, joint, 0.15));
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
  }
  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

// ---- the tool's workspace ----

// A mission that keeps the tool from where the slew can take it.
constexpr double left_face_m = -0.30;
void narrow(ControllerConfig& told) { told.mission_limits.workspace_min_m[1] = left_face_m; }

double out_to_the_left_m(const Rig& rig) { return left_face_m - rig.world().base_from_tool().translation().y(); }

// The tool is 0.45 m from the slew's axis, and a negative slew turns it to the left.
Rig::Make stretched_at(double slew_rad) {
  return [slew_rad](hal::SimConfig& truth) { truth.world.start_rad = {slew_rad, 1.5, 1.35, 0, 0.3}; };
}

TEST(AJogOutOfTheWorkspace, IsRefusedAndMovesNothing) {
  Rig rig(press_only(), 1, narrow, stretched_at(-0.5));
  ASSERT_TRUE(home(rig)) << rig.story();
  std::uint32_t jogs = 0;
  while (jog(rig, arm5e_joint::slew, -0.05)) {
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
    ASSERT_LT(++jogs, 30u) << "it was never refused";
  }
  EXPECT_GT(jogs, 0u);
  const double left_m = out_to_the_left_m(rig);
  EXPECT_LT(left_m, 0.002) << "it is outside";
  EXPECT_GT(left_m, -0.06) << "the next jog would have kept inside";
  EXPECT_GT(angle_rad(rig, arm5e_joint::slew) - 0.05, -1.5508) << "the joint's own limit refused it";
  const auto stood = angles_rad(rig);
  rig.run_for(1);
  EXPECT_LT(farthest_apart(angles_rad(rig), stood), 0.002);
  EXPECT_EQ(rig.count(Fault::workspace), 0u) << rig.story();
}

TEST(AnArmOutsideItsWorkspace, IsStoppedAndJoggedBack) {
  Rig rig(press_only(), 1, narrow, stretched_at(-1.3));
  ASSERT_GT(out_to_the_left_m(rig), 0.02);
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::workspace) << rig.story();
  rig.run_for(1.5);
  ASSERT_TRUE(give(rig, Command::reset));
  ASSERT_TRUE(run_until(rig, Standing::idle, 2)) << rig.story();
  ASSERT_TRUE(home(rig)) << rig.story();
  rig.run_for(0.1);
  EXPECT_FALSE(give(rig, Command::start)) << "a job out of there";
  ASSERT_TRUE(jog(rig, arm5e_joint::jaw, 0.3)) << "the stop came while the jaw closed";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, -0.05)) << "farther out";
  for (int i = 0; i < 4 && out_to_the_left_m(rig) > 0; ++i) {
    const double before_m = out_to_the_left_m(rig);
    ASSERT_TRUE(jog(rig, arm5e_joint::slew, 0.3)) << i;
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
    EXPECT_LT(out_to_the_left_m(rig), before_m);
  }
  EXPECT_LT(out_to_the_left_m(rig), 0) << "it is still outside";
  EXPECT_EQ(rig.mission().standing(), Standing::ready) << rig.story();
  EXPECT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << "stowed: " << rig.story();
}

// ---- an arm found outside its limits ----

constexpr double slew_soft_limit_rad = -1.5508;  // shared/safety/limits.yaml

Rig::Make slew_at(double rad) {
  return [rad](hal::SimConfig& truth) { truth.world.start_rad[0] = rad; };
}

TEST(AnArmOutsideItsLimits, IsJoggedBackAndThenWorks) {
  const double found_rad = slew_soft_limit_rad - 0.016;
  Rig rig(press_only(), 1, {}, slew_at(found_rad));
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_EQ(rig.count(Fault::joint_limit), 1u) << rig.story();
  EXPECT_FALSE(rig.outcome().ended);
  rig.run_for(5);
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::slew), found_rad, 0.002) << "power alone moved it";
  EXPECT_FALSE(give(rig, Command::start)) << "a job out of there";
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, -0.003)) << "away from the limits";

  ASSERT_TRUE(jog(rig, arm5e_joint::shoulder, 0.05)) << "others are not in its way";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, arm5e_joint::slew, 0.004)) << "closer, and still outside";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::slew), found_rad + 0.004, 0.002);
  EXPECT_FALSE(give(rig, Command::start));
  ASSERT_TRUE(jog(rig, arm5e_joint::slew, 0.1));
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::slew), found_rad + 0.104, 0.005);
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, -0.1)) << "and out again";

  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_EQ(rig.count(Fault::joint_limit), 1u);
}

TEST(AnArmOutsideItsLimits, DoesNotSetOutOnAJob) {
  const double found_rad = slew_soft_limit_rad - 0.016;
  Rig rig(press_only(), 1, {}, slew_at(found_rad));
  rig.start();
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::joint_limit);
  rig.run_for(1);
  EXPECT_NEAR(angle_rad(rig, arm5e_joint::slew), found_rad, 0.002);
  ASSERT_TRUE(give(rig, Command::reset));
  ASSERT_TRUE(run_until(rig, Standing::idle, 1));
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_TRUE(jog(rig, arm5e_joint::slew, 0.1));
}

TEST(AnArmOutsideItsLimits, CanBeStowedByAnAbort) {
  Rig rig({}, 1, {}, slew_at(slew_soft_limit_rad - 0.016));
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_GT(angle_rad(rig, arm5e_joint::slew), slew_soft_limit_rad);
}

}  // namespace
}  // namespace lf::test
