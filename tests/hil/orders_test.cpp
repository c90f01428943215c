// An operator's orders on the whole robot: what each does where the mission stands, and that what is refused changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using mission::Standing;
using mission::Step;
using safety::Fault;

// Half a second on the motion's own way (mission/motion.cpp), the drives behind it, and the arm's swing.
constexpr double halt_time_s = 0.9;
constexpr double standing_rad_s = 0.02;

std::vector<std::string> turn_only() { return {"tasks=[{turn_valve: {to_deg: 90}}]"}; }
std::vector<std::string> press_only() { return {"tasks=[{press_buttons: {order: [centre]}}]"}; }

bool give(Rig& rig, Command command) { return rig.controller().on_command(command, rig.now()); }

bool jog(Rig& rig, Joint joint, double by_rad) {
  mission::Order order;
  order.command = Command::jog;
  order.joint = joint;
  order.by_rad = by_rad;
  return rig.controller().on_order(order, rig.now());
}

bool set_tasks(Rig& rig, std::initializer_list<mission::Task> tasks) {
  mission::Order order;
  order.command = Command::set_tasks;
  for (const mission::Task& task : tasks) EXPECT_TRUE(order.tasks.push_back(task));
  return rig.controller().on_order(order, rig.now());
}

bool run_until(Rig& rig, Standing wanted, double limit_s) {
  const Time end = rig.now() + Duration::from_s(limit_s);
  while (rig.mission().standing() != wanted && rig.now() < end) rig.step();
  return rig.mission().standing() == wanted;
}

bool home(Rig& rig) { return give(rig, Command::home) && run_until(rig, Standing::ready, 30); }

double angle_rad(const Rig& rig, Joint joint) { return rig.world().readings()[static_cast<std::size_t>(joint)].position_rad; }

std::array<double, joint_count> angles_rad(const Rig& rig) {
  std::array<double, joint_count> all{};
  for (std::size_t i = 0; i < joint_count; ++i) all[i] = angle_rad(rig, static_cast<Joint>(i));
  return all;
}

double farthest_apart(const std::array<double, joint_count>& a, const std::array<double, joint_count>& b) {
  double most = 0;
  for (std::size_t i = 0; i < joint_count; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// Lets the ordered jog end; false when it takes longer than a person would wait.
bool finish_jog(Rig& rig) {
  rig.run_for(0.02);
  return run_until(rig, Standing::ready, 20);
}

// ---- hold and resume ----

struct Moment {
  Step step;
  double later_s;
  const char* name;
};
void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }

bool reach(Rig& rig, const Moment& moment) {
  rig.start();
  if (!rig.run_to(moment.step)) return false;
  rig.run_for(moment.later_s);
  return rig.step_now() == moment.step;
}

class Hold : public testing::TestWithParam<Moment> {};

TEST_P(Hold, StandsStillForAsLongAsItTakesAndGoesOnFromThere) {
  const Moment& moment = GetParam();
  const bool button = moment.step == Step::press;
  Rig rig(button ? press_only() : turn_only());
  ASSERT_TRUE(reach(rig, moment)) << rig.story();
  EXPECT_GT(rig.fastest_joint_rad_s(), standing_rad_s) << "there was nothing to hold";
  ASSERT_TRUE(give(rig, Command::hold));
  EXPECT_EQ(rig.mission().standing(), Standing::on_hold);
  rig.run_for(halt_time_s);
  EXPECT_FALSE(rig.devices().laser_on());
  const auto stood = angles_rad(rig);
  const double valve_rad = rig.world().valve_angle_rad();
  const double grip_n = rig.world().contacts().grip_force_n;
  rig.run_for(mission::row(moment.step).timeout_s + 2);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_LT(farthest_apart(angles_rad(rig), stood), 0.004) << "it crept";
  EXPECT_NEAR(rig.world().valve_angle_rad(), valve_rad, 0.005);
  EXPECT_EQ(rig.step_now(), moment.step) << rig.story();
  EXPECT_EQ(rig.mission().standing(), Standing::on_hold);
  EXPECT_FALSE(rig.devices().laser_on());
  if (moment.step == Step::turn) {
    EXPECT_GT(grip_n, 20);
    EXPECT_GT(rig.world().contacts().grip_force_n, 0.7 * grip_n) << "let go";
  }

  ASSERT_TRUE(give(rig, Command::resume));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_EQ(rig.count(Fault::step_timeout), 0u);
  if (button) {
    EXPECT_EQ(rig.world().button(1).presses, 1u);
  } else {
    EXPECT_NEAR(rig.world().valve_angle_rad(), pi / 2, 0.05) << rig.story();
  }
}

INSTANTIATE_TEST_SUITE_P(InEveryPhase, Hold,
                         testing::Values(Moment{Step::deploy, 1.0, "Deploying"}, Moment{Step::scan, 1.5, "Scanning"},
                                         Moment{Step::advance, 1.0, "Advancing"}, Moment{Step::grip, 0.3, "ClosingTheJaw"},
                                         Moment{Step::turn, 1.0, "Turning"}, Moment{Step::press, 0.6, "Pressing"},
                                         Moment{Step::stow, 0.5, "Stowing"}),
                         [](const testing::TestParamInfo<Moment>& test) { return std::string(test.param.name); });

TEST(HoldAgainAndAgain, ChangesOnlyTheTimeItTakes) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy)) << rig.story();
  int holds = 0;
  while (!rig.outcome().ended && rig.now().s() < 400) {
    rig.run_for(1.3);
    if (!give(rig, Command::hold)) continue;
    ++holds;
    rig.run_for(0.2);  // shorter than the halt takes
    EXPECT_TRUE(give(rig, Command::resume));
  }
  EXPECT_GT(holds, 20);
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(AbortOnHold, LetsGoAndStows) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, {Step::turn, 1.0, "turning"})) << rig.story();
  ASSERT_TRUE(give(rig, Command::hold));
  rig.run_for(1);
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end(120)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::aborted);
  EXPECT_LT(rig.world().contacts().grip_force_n, 1);
}

TEST(EmergencyStopOnHold, Stops) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, {Step::deploy, 1.0, "deploying"})) << rig.story();
  ASSERT_TRUE(give(rig, Command::hold));
  rig.run_for(1);
  ASSERT_TRUE(give(rig, Command::emergency_stop));
  rig.run_for(0.1);
  EXPECT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_EQ(rig.mission().standing(), Standing::ended);
  EXPECT_FALSE(give(rig, Command::resume));
}

// ---- jog ----

class Jog : public testing::TestWithParam<Joint> {};

TEST_P(Jog, MovesItsJointThereAndBackAndNoOther) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const auto before = angles_rad(rig);
  const auto moved = static_cast<std::size_t>(GetParam());
  // A quarter of the joint's own speed, or what a drive pulses with below the joint's stiction; the jaw opens and closes as fast as ever.
  const ArmJoint& joint = rig.arm().joints[moved];
  const double part = GetParam() == Joint::jaw ? 1 : mission::jog_speed_fraction;
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

std::string name_of(const testing::TestParamInfo<Joint>& test) {
  constexpr std::array names{"Slew", "Shoulder", "Elbow", "Roll", "Jaw"};
  return names[static_cast<std::size_t>(test.param)];
}

INSTANTIATE_TEST_SUITE_P(OfEachJoint, Jog, testing::Values(Joint::slew, Joint::shoulder, Joint::elbow, Joint::roll, Joint::jaw), name_of);

TEST(JogInTheSameTick, AsAnotherIsRefusedAndTheFirstIsDoneOnce) {
  Rig rig;
  ASSERT_TRUE(home(rig)) << rig.story();
  const double slew_rad = angle_rad(rig, Joint::slew), roll_rad = angle_rad(rig, Joint::roll);
  ASSERT_TRUE(jog(rig, Joint::slew, 0.1));
  EXPECT_FALSE(jog(rig, Joint::slew, 0.1));
  EXPECT_FALSE(jog(rig, Joint::roll, 0.2));
  ASSERT_TRUE(finish_jog(rig));
  rig.run_for(2);
  EXPECT_NEAR(angle_rad(rig, Joint::slew), slew_rad + 0.1, 0.01);
  EXPECT_NEAR(angle_rad(rig, Joint::roll), roll_rad, 0.005);
  EXPECT_EQ(rig.controller().orders_refused(), 2u);
}

TEST(JogInTheSameTick, AsTheStartIsRefused) {
  Rig rig(press_only());
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(give(rig, Command::start));
  EXPECT_FALSE(jog(rig, Joint::slew, 0.1));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(JogUnderWay, IsNotReplaced) {
  for (const Joint joint : {Joint::elbow, Joint::jaw}) {
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
    EXPECT_FALSE(jog(rig, Joint::slew, by_rad)) << by_rad;
  EXPECT_FALSE(jog(rig, static_cast<Joint>(joint_count), 0.1));
  rig.run_for(1);
  EXPECT_LT(farthest_apart(angles_rad(rig), before), 0.003);
}

class JogToTheEnd : public testing::TestWithParam<Joint> {};

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

INSTANTIATE_TEST_SUITE_P(OfTheWristAndTheJaw, JogToTheEnd, testing::Values(Joint::roll, Joint::jaw), name_of);

TEST(JogOnHold, GoesOnToItsEnd) {
  for (const Joint joint : {Joint::slew, Joint::jaw}) {
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
  ASSERT_TRUE(jog(rig, Joint::slew, 0.3));
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
  for (const Joint joint : {Joint::slew, Joint::roll, Joint::jaw}) {
    ASSERT_TRUE(jog(rig, joint, 0.15));
    ASSERT_TRUE(finish_jog(rig)) << rig.story();
  }
  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
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
  EXPECT_NEAR(angle_rad(rig, Joint::slew), found_rad, 0.002) << "power alone moved it";
  EXPECT_FALSE(give(rig, Command::start)) << "a job out of there";
  EXPECT_FALSE(jog(rig, Joint::slew, -0.003)) << "away from the limits";

  ASSERT_TRUE(jog(rig, Joint::shoulder, 0.05)) << "others are not in its way";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  ASSERT_TRUE(jog(rig, Joint::slew, 0.004)) << "closer, and still outside";
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, Joint::slew), found_rad + 0.004, 0.002);
  EXPECT_FALSE(give(rig, Command::start));
  ASSERT_TRUE(jog(rig, Joint::slew, 0.1));
  ASSERT_TRUE(finish_jog(rig)) << rig.story();
  EXPECT_NEAR(angle_rad(rig, Joint::slew), found_rad + 0.104, 0.005);
  EXPECT_FALSE(jog(rig, Joint::slew, -0.1)) << "and out again";

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
  EXPECT_NEAR(angle_rad(rig, Joint::slew), found_rad, 0.002);
  ASSERT_TRUE(give(rig, Command::reset));
  ASSERT_TRUE(run_until(rig, Standing::idle, 1));
  ASSERT_TRUE(home(rig)) << rig.story();
  EXPECT_TRUE(jog(rig, Joint::slew, 0.1));
}

TEST(AnArmOutsideItsLimits, CanBeStowedByAnAbort) {
  Rig rig({}, 1, {}, slew_at(slew_soft_limit_rad - 0.016));
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end(60)) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_GT(angle_rad(rig, Joint::slew), slew_soft_limit_rad);
}

// ---- home, tasks, reset, shut down ----

TEST(Home, WaitsForTheStart) {
  Rig rig(press_only());
  const auto before = angles_rad(rig);
  ASSERT_TRUE(home(rig)) << rig.story();
  rig.run_for(60);
  EXPECT_EQ(rig.mission().standing(), Standing::ready);
  EXPECT_LT(farthest_apart(angles_rad(rig), before), 0.005);
  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(SetTasks, ReplacesTheJob) {
  Rig rig(turn_only());
  const double valve_rad = rig.world().valve_angle_rad();
  ASSERT_TRUE(set_tasks(rig, {{mission::Task::Kind::press_button, 0, 0}}));
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_TRUE(set_tasks(rig, {{mission::Task::Kind::press_button, 0, 2}, {mission::Task::Kind::press_button, 0, 1}}));
  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  ASSERT_EQ(rig.mission().tasks().size(), 2u);
  EXPECT_EQ(rig.world().button(0).presses, 0u);
  EXPECT_EQ(rig.world().button(1).presses, 1u);
  EXPECT_EQ(rig.world().button(2).presses, 1u);
  EXPECT_NEAR(rig.world().valve_angle_rad(), valve_rad, 0.01);
}

TEST(SetTasks, ThatMakeNoSenseAreRefused) {
  Rig rig(press_only());
  EXPECT_FALSE(set_tasks(rig, {}));
  EXPECT_FALSE(set_tasks(rig, {{mission::Task::Kind::press_button, 0, 3}}));
  EXPECT_FALSE(set_tasks(rig, {{mission::Task::Kind::turn_valve, 4, 0}}));
  EXPECT_FALSE(set_tasks(rig, {{mission::Task::Kind::turn_valve, std::numeric_limits<double>::quiet_NaN(), 0}}));
  ASSERT_EQ(rig.mission().tasks().size(), 1u);
  EXPECT_EQ(rig.mission().tasks()[0].task.button, 1);
}

TEST(Reset, OfAHeldArmTakesThePowerOffAndTheNextJobIsDone) {
  Rig rig(press_only());
  ASSERT_TRUE(reach(rig, {Step::deploy, 1.0, "deploying"})) << rig.story();
  ASSERT_TRUE(give(rig, Command::hold));
  rig.run_for(1);
  rig.ports().fail(hal::Call::receive_image, rig.ports().calls(hal::Call::receive_image), 5, 1);
  rig.devices().set_estop_closed(false);
  rig.run_for(0.5);
  ASSERT_EQ(rig.step_now(), Step::stopped) << rig.story();
  rig.devices().set_estop_closed(true);
  rig.run_for(0.5);
  ASSERT_TRUE(give(rig, Command::reset));
  ASSERT_TRUE(run_until(rig, Standing::idle, 1));
  EXPECT_FALSE(rig.outcome().ended);
  rig.run_for(1);
  for (std::size_t i = 0; i < joint_count; ++i)
    EXPECT_EQ(rig.controller().network().axis(static_cast<Joint>(i)).state(), canopen::AxisState::disabled);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

TEST(Reset, AfterAnEndIsAsNew) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  ASSERT_EQ(rig.step_now(), Step::done) << rig.story();
  ASSERT_TRUE(give(rig, Command::reset));
  ASSERT_TRUE(run_until(rig, Standing::idle, 1));
  EXPECT_FALSE(rig.mission().tasks()[0].done);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_EQ(rig.world().button(1).presses, 2u);
}

// Brings a robot to where its mission stands so.
bool bring_to(Rig& rig, Standing standing) {
  switch (standing) {
    case Standing::idle: return true;
    case Standing::starting:
      rig.start();
      rig.run_for(0.5);
      break;
    case Standing::ready: return home(rig);
    case Standing::jogging:
      if (!home(rig) || !jog(rig, Joint::elbow, -0.3)) return false;
      rig.run_for(0.5);
      break;
    case Standing::working:
    case Standing::on_hold:
      if (!reach(rig, {Step::deploy, 1.0, "deploying"})) return false;
      if (standing == Standing::on_hold && !give(rig, Command::hold)) return false;
      rig.run_for(0.5);
      break;
    case Standing::leaving: return reach(rig, {Step::stow, 0.5, "stowing"});
    case Standing::ended:
      rig.start();
      rig.run_to_end();
      break;
    case Standing::held:  // an overload holds in free motion
      rig.start();
      rig.run_to_end();
      break;
    case Standing::count: return false;
  }
  return rig.mission().standing() == standing;
}

class Standings : public testing::TestWithParam<Standing> {
 protected:
  static Rig::Tell told() {
    if (GetParam() != Standing::held) return {};
    return [](ControllerConfig& told) {
      for (safety::JointLimit& joint : told.mission_limits.joints) joint.max_torque_nm = 0.5;
    };
  }
};

TEST_P(Standings, AreLeftByAShutDownWithoutPowerAndWithTheNodesStopped) {
  Rig rig(press_only(), 1, told());
  ASSERT_TRUE(bring_to(rig, GetParam())) << rig.story();
  ASSERT_TRUE(give(rig, Command::shut_down));
  rig.run_for(3);
  EXPECT_TRUE(rig.mission().over()) << rig.story();
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  const std::uint64_t heard = rig.controller().network().stats().frames_in;
  const auto stood = angles_rad(rig);
  rig.run_for(1);
  // A node that is stopped has nothing to say but its heartbeat, ten times a second.
  EXPECT_LE(rig.controller().network().stats().frames_in - heard, 6u * 11u);
  EXPECT_LT(farthest_apart(angles_rad(rig), stood), 0.001);
  for (const Command command : {Command::start, Command::home, Command::reset, Command::hold, Command::resume, Command::abort})
    EXPECT_FALSE(give(rig, command)) << name(command);
  EXPECT_TRUE(give(rig, Command::emergency_stop));
}

TEST_P(Standings, DoNotMindOrdersThatAreRefused) {
  Rig rig(press_only(), 1, told());
  ASSERT_TRUE(bring_to(rig, GetParam())) << rig.story();
  const Step step = rig.step_now();
  const bool success = rig.outcome().success;
  std::uint32_t refused = 0;
  for (std::size_t i = 0; i < command_count; ++i) {
    const auto command = static_cast<Command>(i);
    if (mission::may(command, GetParam())) continue;
    EXPECT_FALSE(give(rig, command)) << name(command);
    ++refused;
  }
  EXPECT_EQ(rig.controller().orders_refused(), refused);
  EXPECT_GE(refused, 3u);
  rig.run_for(0.012);
  EXPECT_EQ(rig.mission().standing(), GetParam()) << rig.story();
  EXPECT_EQ(rig.step_now(), step);
  switch (GetParam()) {
    case Standing::starting:
    case Standing::working:
    case Standing::leaving:
      ASSERT_TRUE(rig.run_to_end()) << rig.story();
      EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
      return;
    case Standing::jogging: EXPECT_TRUE(run_until(rig, Standing::ready, 20)) << rig.story(); return;
    default:
      rig.run_for(3);
      EXPECT_EQ(rig.step_now(), step) << rig.story();
      EXPECT_EQ(rig.outcome().success, success);
      return;
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheMission, Standings,
                         testing::Values(Standing::idle, Standing::starting, Standing::ready, Standing::jogging, Standing::working,
                                         Standing::leaving, Standing::on_hold, Standing::held, Standing::ended),
                         [](const testing::TestParamInfo<Standing>& test) {
                           std::string words = mission::name(test.param);
                           std::erase(words, ' ');
                           return words;
                         });

}  // namespace
}  // namespace lf::test
