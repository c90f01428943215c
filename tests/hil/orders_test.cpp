// What an operator orders, on the bench: the arm does it, and nothing that the table of orders does not allow.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/kinematics.hpp"
#include "tests/hil/rig.hpp"

namespace lf::test {
namespace {

using mission::Standing;
using mission::Step;

Standing standing(Rig& rig) { return rig.mission().standing(); }

bool give(Rig& rig, Command command) { return rig.controller().on_command(command, rig.now()); }

bool jog(Rig& rig, Joint joint, double by_rad) {
  mission::Order order;
  order.command = Command::jog;
  order.joint = joint;
  order.by_rad = by_rad;
  return rig.controller().on_order(order, rig.now());
}

bool run_to(Rig& rig, Standing wanted, double limit_s = 60) {
  const Time end = rig.now() + Duration::from_s(limit_s);
  while (standing(rig) != wanted && rig.now() < end) rig.step();
  return standing(rig) == wanted;
}

TEST(Orders, HomeWaitsReadyAndAJogMovesOneJointByWhatWasSaid) {
  Rig rig;
  ASSERT_TRUE(give(rig, Command::home));
  ASSERT_TRUE(run_to(rig, Standing::ready)) << rig.story();
  rig.run_for(1);
  const safety::JointStates before = rig.mission().joints();
  EXPECT_FALSE(jog(rig, Joint::elbow, 0.5)) << "farther than a jog may go";
  EXPECT_FALSE(jog(rig, Joint::elbow, std::nan("")));
  ASSERT_GT(before.position_rad[2] + 0.34, 2.133);
  EXPECT_FALSE(jog(rig, Joint::elbow, 0.34)) << "beyond its limit";
  ASSERT_TRUE(jog(rig, Joint::elbow, -0.2));
  EXPECT_TRUE(run_to(rig, Standing::jogging, 1));
  EXPECT_FALSE(jog(rig, Joint::slew, 0.1));
  ASSERT_TRUE(run_to(rig, Standing::ready));
  rig.run_for(1);
  const safety::JointStates after = rig.mission().joints();
  EXPECT_NEAR(after.position_rad[2] - before.position_rad[2], -0.2, 0.01);
  for (const std::size_t other : {0, 1, 3}) EXPECT_NEAR(after.position_rad[other], before.position_rad[other], 0.01) << other;
}

TEST(Orders, AHeldArmStandsStillAndGoesOnToTheSameEnd) {
  Rig rig;
  rig.start();
  for (const Step step : {Step::deploy, Step::scan, Step::advance, Step::turn}) {
    ASSERT_TRUE(rig.run_to(step)) << mission::row(step).name << ": " << rig.story();
    rig.run_for(0.5);
    ASSERT_TRUE(give(rig, Command::hold)) << mission::row(step).name;
    EXPECT_FALSE(give(rig, Command::hold));
    EXPECT_FALSE(give(rig, Command::start));
    rig.run_for(1.5);  // half a second of it to come to rest, and the arm swings on
    const safety::JointStates held = rig.mission().joints();
    EXPECT_FALSE(rig.devices().laser_on());
    rig.run_for(60);  // longer than the steps' own time-outs
    EXPECT_EQ(standing(rig), Standing::on_hold) << rig.story();
    const safety::JointStates later = rig.mission().joints();
    for (std::size_t i = 0; i < joint_count; ++i)
      EXPECT_NEAR(later.position_rad[i], held.position_rad[i], 0.02) << mission::row(step).name << " joint " << i;
    ASSERT_TRUE(give(rig, Command::resume));
    EXPECT_FALSE(give(rig, Command::resume));
  }
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
}

TEST(Orders, AbortOnHoldGoesHome) {
  Rig rig;
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
  rig.run_for(0.5);
  ASSERT_TRUE(give(rig, Command::hold));
  rig.run_for(2);
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end());
  EXPECT_EQ(rig.step_now(), Step::failed) << rig.story();
  EXPECT_EQ(rig.outcome().fault, safety::Fault::aborted);
}

TEST(Orders, NothingSetsAHeldArmMoving) {
  Rig rig;
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::advance)) << rig.story();
  ASSERT_TRUE(give(rig, Command::hold));
  rig.run_for(1);
  rig.devices().set_interlock_closed(false);
  rig.run_for(5);
  EXPECT_LT(rig.fastest_joint_rad_s(), 0.02);
}

TEST(Orders, AfterAnEmergencyStopResetAndStartFlyTheMissionAnew) {
  Rig rig;
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy));
  rig.run_for(1);
  rig.devices().set_estop_closed(false);
  rig.run_for(0.5);
  ASSERT_EQ(rig.step_now(), Step::stopped) << rig.story();
  EXPECT_FALSE(give(rig, Command::start));
  ASSERT_TRUE(give(rig, Command::reset));
  rig.run_for(0.1);
  EXPECT_EQ(standing(rig), Standing::ended) << "with the chain open there is no way back";
  rig.devices().set_estop_closed(true);
  rig.run_for(0.1);
  ASSERT_TRUE(give(rig, Command::reset));
  rig.run_for(0.1);
  ASSERT_EQ(standing(rig), Standing::idle) << rig.story();
  ASSERT_TRUE(give(rig, Command::start));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
}

TEST(Orders, OtherTasksAreTakenBeforeTheStartAndNotDuringTheJob) {
  Rig rig;
  mission::Order order;
  order.command = Command::set_tasks;
  EXPECT_FALSE(rig.controller().on_order(order, rig.now())) << "no task at all";
  ASSERT_TRUE(order.tasks.push_back({mission::Task::Kind::press_button, 0, 1}));
  ASSERT_TRUE(rig.controller().on_order(order, rig.now()));
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy));
  EXPECT_FALSE(rig.controller().on_order(order, rig.now()));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_TRUE(rig.outcome().success) << rig.story();
  EXPECT_EQ(rig.world().button(1).presses, 1u);
  EXPECT_EQ(rig.world().button(0).presses, 0u);
}

TEST(Orders, ShutDownTakesThePowerAndStopsEveryNode) {
  Rig rig;
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy));
  rig.run_for(1);
  ASSERT_TRUE(give(rig, Command::shut_down));
  const Time ordered = rig.now();
  ASSERT_TRUE(rig.run_to(Step::off, 5)) << rig.story();
  EXPECT_LT((rig.now() - ordered).s(), 3);
  rig.run_for(0.5);
  EXPECT_LT(rig.fastest_joint_rad_s(), 0.01);
  EXPECT_EQ(rig.controller().network().boot().state, canopen::BootState::idle);
}

}  // namespace
}  // namespace lf::test
