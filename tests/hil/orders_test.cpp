// An operator's orders on the whole robot: what each does where the mission stands, and that what is refused changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Standing;
using mission::Step;
using safety::Fault;

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
  const double valve_rad = rig.world().valve_angle_rad(0);
  const double grip_n = rig.world().contacts().grip_force_n;
  rig.run_for(mission::row(moment.step).margin_s + 20);
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
  EXPECT_LT(farthest_apart(angles_rad(rig), stood), 0.004) << "it crept";
  EXPECT_NEAR(rig.world().valve_angle_rad(0), valve_rad, 0.005);
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
    EXPECT_NEAR(rig.world().valve_angle_rad(0), pi / 2, 0.05) << rig.story();
  }
}

INSTANTIATE_TEST_SUITE_P(InEveryPhase, Hold,
                         testing::Values(Moment{Step::deploy, 1.0, "Deploying"}, Moment{Step::scan, 1.5, "Scanning"},
                                         Moment{Step::advance, 1.0, "Advancing"}, Moment{Step::grip, 0.3, "ClosingTheJaw"},
                                         Moment{Step::turn, 1.0, "Turning"}, Moment{Step::press, 0.6, "Pressing"},
                                         Moment{Step::stow, 0.5, "Stowing"}),
                         [](const testing::TestParamInfo<Moment>& test) { return std::string(test.param.name); });

// ---- what an arm on hold touches ----

class ContactOnHold : public testing::TestWithParam<Moment> {};

// It reaches the wrist within the half second that the arm takes to halt.
TEST_P(ContactOnHold, EndsHeldOnTheWayToAContactAndBackToo) {
  const Moment& moment = GetParam();
  Rig rig(moment.step == Step::advance ? turn_only() : press_only());
  ASSERT_TRUE(reach(rig, moment)) << rig.story();
  rig.push_obstacle();
  rig.run_for(0.45);
  ASSERT_TRUE(rig.world().contacts().unintended.empty()) << "too late for a hold";
  ASSERT_TRUE(give(rig, Command::hold)) << rig.story();
  ASSERT_TRUE(run_until(rig, Standing::held, 1)) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::unexpected_contact) << rig.story();
  rig.run_for(1);
  EXPECT_FALSE(rig.world().contacts().unintended.empty()) << "nothing was touched";
  EXPECT_LT(rig.world().contacts().peak_force_n, 150) << rig.story();
  EXPECT_LT(rig.fastest_joint_rad_s(), standing_rad_s);
}

INSTANTIATE_TEST_SUITE_P(WhereTheStepsHaveTheirOwnGuards, ContactOnHold,
                         testing::Values(Moment{Step::advance, 0.4, "Advancing"}, Moment{Step::press, 0.4, "Pressing"},
                                         Moment{Step::button_back, 0.6, "LeavingTheButton"}),
                         [](const testing::TestParamInfo<Moment>& test) { return std::string(test.param.name); });

// In the half second of the halt the finger goes on by up to 6 mm: it bottoms on hold.
class HoldInAPress : public testing::TestWithParam<int> {};

TEST_P(HoldInAPress, DoesNotGoOnPushingAndIsResumedToSuccess) {
  Rig rig(press_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::press)) << rig.story();
  const double depth_m = 0.001 * GetParam();
  while (rig.world().button(1).depth_m <= depth_m && rig.step_now() == Step::press) rig.step();
  ASSERT_TRUE(give(rig, Command::hold)) << rig.story();
  rig.run_for(3);
  EXPECT_EQ(rig.mission().standing(), Standing::on_hold) << rig.story();
  EXPECT_EQ(rig.count(Fault::unexpected_contact), 0U);
  // 50 N on a button of its nominal height. The seed's may be half a millimetre higher, which is 5 N of an arm that gives way by 6 mm at 60 N.
  EXPECT_LT(rig.world().contacts().tool_wrench.force_n.norm(), 55);
  ASSERT_TRUE(give(rig, Command::resume));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
  EXPECT_EQ(rig.world().button(1).presses, 1U);
}

INSTANTIATE_TEST_SUITE_P(MillimetresIn, HoldInAPress, testing::Values(0, 1, 2, 3, 4));

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

TEST(Orders, ThatHaveExpiredAreRefusedButAStopIsObeyed) {
  Rig rig(press_only());
  rig.run_for(0.1);
  mission::Order order;
  order.command = Command::start;
  order.expires = rig.now() - Duration::from_ms(1);
  EXPECT_FALSE(rig.controller().on_order(order, rig.now()));
  rig.run_for(0.5);
  EXPECT_EQ(rig.step_now(), Step::idle) << rig.story();
  order.expires = rig.now() + Duration::from_ms(500);
  EXPECT_TRUE(rig.controller().on_order(order, rig.now()));
  rig.run_for(0.1);
  EXPECT_EQ(rig.step_now(), Step::boot) << rig.story();
  order.command = Command::emergency_stop;
  order.expires = rig.now() - Duration::from_s(1);
  EXPECT_TRUE(rig.controller().on_order(order, rig.now()));
  rig.run_for(0.1);
  EXPECT_TRUE(rig.outcome().ended) << rig.story();
  EXPECT_EQ(rig.outcome().fault, Fault::estop) << rig.story();
}

TEST(SetTasks, ReplacesTheJob) {
  Rig rig(turn_only());
  const double valve_rad = rig.world().valve_angle_rad(0);
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
  EXPECT_NEAR(rig.world().valve_angle_rad(0), valve_rad, 0.01);
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
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(rig.controller().network().axis(i).state(), canopen::AxisState::disabled);
  rig.start();
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(rig.step_now(), Step::done) << rig.story();
}

// A stop in mid-turn leaves the handle in the jaw. Neither a new job nor the way to the park drags it along.
TEST(Reset, AfterAStopInTheTurnGetsFreeOfTheHandleFirst) {
  for (const Command next : {Command::start, Command::abort}) {
    SCOPED_TRACE(next == Command::start ? "start" : "abort");
    Rig rig(turn_only());
    ASSERT_TRUE(reach(rig, {Step::turn, 1.0, "turning"})) << rig.story();
    ASSERT_TRUE(give(rig, Command::emergency_stop));
    rig.run_for(1.5);
    ASSERT_EQ(rig.step_now(), Step::stopped) << rig.story();
    ASSERT_GT(rig.world().contacts().grip_force_n, 10) << "the handle is held";
    const double valve_rad = rig.world().valve_angle_rad(0);
    ASSERT_TRUE(give(rig, Command::reset));
    rig.run_for(0.5);
    ASSERT_TRUE(home(rig)) << rig.story();
    const double force_before_n = rig.world().contacts().peak_force_n;
    ASSERT_TRUE(give(rig, next));
    double pulled_n = 0, turned_rad = 0;
    const bool job = next == Command::start;
    for (int i = 0; i < 60'000 && !rig.outcome().ended && !(job && rig.step_now() == Step::deploy); ++i) {
      rig.step();
      pulled_n = std::max(pulled_n, rig.world().contacts().base_wrench.force_n.norm());
      turned_rad = std::max(turned_rad, std::abs(rig.world().valve_angle_rad(0) - valve_rad));
    }
    EXPECT_EQ(rig.step_now(), job ? Step::deploy : Step::failed) << rig.story();
    EXPECT_LT(pulled_n, 60) << "before: " << force_before_n;
    EXPECT_LT(turned_rad, 0.1);
    EXPECT_LT(rig.world().contacts().grip_force_n, 1) << "it is let go";
  }
}

// By hand nobody has looked yet what the jaw holds, and a jog moves no joint but its own. So the operator opens the jaw first.
TEST(Reset, AfterAStopInTheTurnNoArmJointIsJoggedBeforeTheJawIsOpen) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, {Step::turn, 1.0, "turning"})) << rig.story();
  ASSERT_TRUE(give(rig, Command::emergency_stop));
  rig.run_for(1.5);
  ASSERT_TRUE(give(rig, Command::reset));
  rig.run_for(0.5);
  ASSERT_TRUE(home(rig)) << rig.story();
  ASSERT_GT(rig.world().contacts().grip_force_n, 10) << "the handle is held";
  const double valve_rad = rig.world().valve_angle_rad(0);
  double pulled_n = 0;
  const auto finish = [&] {
    for (int i = 0; i < 1500; ++i) {
      rig.step();
      pulled_n = std::max(pulled_n, rig.world().contacts().base_wrench.force_n.norm());
    }
  };
  for (const double by_rad : {0.3, -0.3, 0.01}) {
    for (const std::size_t joint : {arm5e_joint::slew, arm5e_joint::shoulder, arm5e_joint::elbow, arm5e_joint::roll}) {
      EXPECT_FALSE(jog(rig, joint, by_rad)) << static_cast<int>(joint);
      finish();
    }
  }
  EXPECT_LT(pulled_n, 60) << rig.story();
  EXPECT_NEAR(rig.world().valve_angle_rad(0), valve_rad, 0.02);
  ASSERT_TRUE(jog(rig, arm5e_joint::jaw, 0.1));
  finish();
  EXPECT_FALSE(jog(rig, arm5e_joint::slew, -0.1)) << "the bar is still between the fingers";
  ASSERT_TRUE(jog(rig, arm5e_joint::jaw, 0.2));
  finish();
  EXPECT_LT(rig.world().contacts().grip_force_n, 1) << "it is let go";
  EXPECT_TRUE(jog(rig, arm5e_joint::slew, -0.05)) << rig.story();
  finish();
  EXPECT_LT(pulled_n, 60) << rig.story();
}

// The jaw's encoder says "open" while the jaw closes on the bar. A reset makes it no more trustworthy.
TEST(Reset, OfAJawWhoseEncoderStoodStillLetsNoArmJointBeJogged) {
  Rig rig(turn_only());
  ASSERT_TRUE(reach(rig, {Step::grip, 0.0, "gripping"})) << rig.story();
  rig.devices().add_fault({0, devices::DeviceFaultKind::stuck_encoder, 5}, rig.now());
  rig.run_for(1);
  ASSERT_TRUE(give(rig, Command::emergency_stop));
  rig.run_for(1.5);
  ASSERT_TRUE(give(rig, Command::reset));
  rig.run_for(0.5);
  ASSERT_TRUE(home(rig)) << rig.story();
  for (const std::size_t joint : {arm5e_joint::slew, arm5e_joint::shoulder, arm5e_joint::elbow, arm5e_joint::roll})
    EXPECT_FALSE(jog(rig, joint, 0.05));
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
      if (!home(rig) || !jog(rig, arm5e_joint::elbow, -0.3)) return false;
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
    case Standing::held:  // an unexpected contact holds in free motion
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
    return [](ControllerConfig& told) { told.mission_limits.max_contact_torque_nm = 0.3; };
  }
};

TEST_P(Standings, AreLeftByAShutDownWithoutPowerAndWithTheNodesStopped) {
  Rig rig(press_only(), 1, told());
  ASSERT_TRUE(bring_to(rig, GetParam())) << rig.story();
  ASSERT_TRUE(give(rig, Command::shut_down));
  rig.run_for(3);
  EXPECT_TRUE(rig.mission().over()) << rig.story();
  EXPECT_FALSE(rig.any_power()) << "from the drives' side";
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(rig.devices().power(i), devices::DrivePower::off) << "joint " << i;
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
