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

safety::Limits shipped_limits() { return read_limits(share_folder() / "safety" / "limits.yaml"); }

// A configuration whose own tasks press nothing may have low caps; an order that presses one may not.
TEST(TasksProblem, OfAnOrderThatPressesALowCapIsTold) {
  Machine machine;
  machine.tasks = {Task{}};
  EXPECT_EQ(tasks_problem(machine, shipped_limits(), press(1)), "");
  machine.panel.button_height_m = 0.012;
  EXPECT_THAT(tasks_problem(machine, shipped_limits(), press(1)), HasSubstr("'panel.button_height_m' is 0.012"));
  EXPECT_EQ(tasks_problem(machine, shipped_limits(), turn()), "");
}

TEST(TasksProblem, OfAButtonOutOfReachIsToldByItsName) {
  Machine machine;
  machine.panel.buttons_m[2] = Vec2(0.38, -0.38);
  EXPECT_THAT(tasks_problem(machine, shipped_limits(), press(2)), HasSubstr("the right button is out of the arm's reach"));
  EXPECT_EQ(tasks_problem(machine, shipped_limits(), press(0)), "");
}

TEST(TasksProblem, OfAPoseBeyondTheMissionsLimitsIsTold) {
  safety::Limits limits = shipped_limits();
  limits.joints[2].min_rad = 1.8;  // nearly folded
  const Machine machine;
  EXPECT_THAT(tasks_problem(machine, limits, turn()), HasSubstr("'joints.elbow.min_rad' is 1.8: the valve takes the elbow to"));
}

}  // namespace
}  // namespace lf::config
