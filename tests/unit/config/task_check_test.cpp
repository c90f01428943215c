#include "hal/config/task_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/limits_file.hpp"
#include "hal/config/share.hpp"

namespace lf::config {
namespace {

using testing::HasSubstr;

mission::Tasks press(std::uint8_t button) {
  mission::Tasks tasks;
  mission::Task task;
  task.kind = mission::Task::Kind::press_button;
  task.button = button;
  (void)tasks.push_back(task);
  return tasks;
}

mission::Tasks turn() {
  mission::Tasks tasks;
  (void)tasks.push_back(mission::Task{});
  return tasks;
}

Core usual() {
  Machine machine;
  return make_core(machine);
}

// A configuration whose own tasks press nothing may have low caps; an order that presses one may not.
TEST(TasksProblem, OfAnOrderThatPressesALowCapIsTold) {
  Machine machine;
  machine.tasks = {Task{}};
  EXPECT_EQ(tasks_problem(machine, usual(), press(1)), "");
  for (PanelLayout::Button& button : machine.panel.buttons) button.height_m = 0.012;
  EXPECT_THAT(tasks_problem(machine, usual(), press(1)), HasSubstr("'panel.button_height_m' is 0.012"));
  EXPECT_EQ(tasks_problem(machine, usual(), turn()), "");
}

TEST(TasksProblem, OfAButtonOutOfReachIsToldByItsName) {
  Machine machine;
  machine.panel.buttons[2].at_m = Vec2(0.38, -0.38);
  EXPECT_THAT(tasks_problem(machine, usual(), press(2)), HasSubstr("the right button is out of the arm's reach"));
  EXPECT_EQ(tasks_problem(machine, usual(), press(0)), "");
}

TEST(TasksProblem, OfAPoseBeyondTheMissionsLimitsIsTold) {
  Core core = usual();
  core.controller.mission_limits.joints[2].min_rad = 1.8;  // nearly folded
  const Machine machine;
  EXPECT_THAT(tasks_problem(machine, core, turn()), HasSubstr("'joints.elbow.min_rad' is 1.8: the valve takes the elbow to"));
}

// What a file says that a valve takes counts for an order as for the configuration's own tasks, and so do its bar and its neighbours.
TEST(TasksProblem, OfAValveThatIsTooStiffTooThinOrTooNearToAnotherIsTold) {
  Machine machine;
  machine.survey = {"panel.yaml", {{"V1", "V2"}, {}, {"7"}}, {ValveNature{}, ValveNature{.torque_nm = 67}}};
  (void)machine.panel.valves.push_back({.at_m = Vec2(0, -0.2)});
  machine.panel.buttons.clear();
  machine.tasks.clear();
  const auto turn_of = [](std::uint8_t valve) {
    mission::Tasks tasks;
    (void)tasks.push_back({mission::Task::Kind::turn_valve, 0.5, 0, valve});
    return tasks;
  };
  EXPECT_EQ(tasks_problem(machine, usual(), turn_of(0)), "");
  EXPECT_THAT(tasks_problem(machine, usual(), turn_of(1)), HasSubstr("valve V2 needs 67 N m, the arm gives 4.0"));
  machine.panel.valves[1].handle_thickness_m = 0.05;
  EXPECT_EQ(tasks_problem(machine, usual(), turn_of(0)), "") << "nobody turns the thick one";
  EXPECT_THAT(tasks_problem(machine, usual(), turn_of(1)), HasSubstr("'valves.V2.thickness_m'"));
  machine.panel.valves[1] = {.at_m = Vec2(0, -0.125)};
  machine.survey.valves[1].torque_nm = 3;
  EXPECT_THAT(tasks_problem(machine, usual(), turn_of(0)),
              HasSubstr("valve V1 stands 0.125 m from valve V2: the hand that turns it needs 0.127"));
  machine.panel.valves[1].at_m = Vec2(0, -0.13);
  EXPECT_EQ(tasks_problem(machine, usual(), turn_of(0)), "");
}

}  // namespace
}  // namespace lf::config
