// A success is one only when the truth agrees in everything.
#include "host_sim/judge/truth.hpp"

#include <gtest/gtest.h>

namespace lf::judge {
namespace {

struct Judged {
  std::vector<mission::TaskResult> results;
  std::vector<TaskTruth> tasks;
  TaskTruth at_end;
  world::ContactReport contacts;

  std::string contradicted() const {
    const auto wrong = contradiction(results, tasks, at_end, contacts);
    return wrong ? wrong->phase + ": " + wrong->reason : "";
  }
};

// To 90 degrees, then the left button.
Judged good_run() {
  Judged run;
  mission::TaskResult turn, press;
  turn.task.kind = mission::Task::Kind::turn_valve;
  turn.task.to_rad = rad_from_deg(90);
  turn.done = press.done = true;
  press.task.kind = mission::Task::Kind::press_button;
  press.task.button = 0;
  run.results = {turn, press};
  TaskTruth turned, pressed;
  turned.valve_rad = pressed.valve_rad = rad_from_deg(89);
  pressed.presses = {1, 0, 0};
  run.tasks = {turned, pressed};
  run.at_end = pressed;
  run.contacts.peak_force_n = 60;
  return run;
}

TEST(Truth, AgreesWithARunInWhichEverythingWasDone) { EXPECT_EQ(good_run().contradicted(), ""); }

TEST(Truth, TheValveIsWithinThreeDegreesOfItsTargetAtItsTasksEnd) {
  Judged run = good_run();
  run.tasks[0].valve_rad = run.at_end.valve_rad = rad_from_deg(86.5);
  EXPECT_EQ(run.contradicted(), "turn_valve: the valve stands at 86.5 deg instead of 90.0, against the core's account");
}

TEST(Truth, AValveThatMovesAfterItsTaskIsAFailure) {
  Judged run = good_run();
  run.at_end.valve_rad = rad_from_deg(86.5);
  EXPECT_EQ(run.contradicted(), "turn_valve: the valve has turned by -2.5 deg after its task");
  run.at_end.valve_rad = rad_from_deg(88.0);
  EXPECT_EQ(run.contradicted(), "") << "a detent's pull";
}

TEST(Truth, AButtonThatDidNotClickIsAFailureAndSoIsOneTooMany) {
  Judged run = good_run();
  run.tasks[1].presses = run.at_end.presses = {0, 0, 0};
  EXPECT_EQ(run.contradicted(), "press_buttons: the left button did not click, against the core's account");
  run = good_run();
  run.at_end.presses = {2, 0, 0};
  EXPECT_EQ(run.contradicted(), "press_buttons: the left button has clicked 2 times, 1 were asked for");
  run = good_run();
  run.at_end.presses = {1, 0, 1};
  EXPECT_EQ(run.contradicted(), "press_buttons: the right button has clicked 1 times, 0 were asked for");
}

TEST(Truth, ATouchOfWhatMustNotMeetIsAFailureFromAForceOn) {
  Judged run = good_run();
  run.contacts.unintended = {{scene::BodyId::wrist, scene::BodyId::panel, 12.3, 4.0, "wrist", "panel"}};
  EXPECT_EQ(run.contradicted(), "");
  run.contacts.unintended[0].peak_force_n = 40;
  EXPECT_EQ(run.contradicted(), "contact: unintended contact of wrist and panel at 12.30 s, up to 40 N");
}

TEST(Truth, TooMuchForceIsAFailureWhateverItIsOn) {
  Judged run = good_run();
  run.contacts.peak_force_n = 151;
  EXPECT_EQ(run.contradicted(), "contact: 151 N of contact, 150 are allowed");
}

TEST(Truth, OfATaskWhoseEndWasNotSeenIsThatOfTheRunsEnd) {
  Judged run = good_run();
  run.tasks.clear();
  EXPECT_EQ(run.contradicted(), "");
  run.at_end.presses = {0, 0, 0};
  EXPECT_EQ(run.contradicted(), "press_buttons: the left button did not click, against the core's account");
}

}  // namespace
}  // namespace lf::judge
