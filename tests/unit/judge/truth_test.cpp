// A success is one only when the truth agrees in everything.
#include "host_sim/judge/truth.hpp"

#include <gtest/gtest.h>

#include "tests/arm5e_bodies.hpp"

namespace lf::judge {
namespace {

struct Judged {
  std::vector<mission::TaskResult> results;
  TaskTruth at_start;
  std::vector<TaskTruth> tasks;
  TaskTruth at_end;
  world::ContactReport contacts;
  PanelNames names;

  std::string contradicted() const {
    const auto wrong = contradiction(results, {at_start, tasks, at_end}, contacts, names);
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
  turned.valves_rad = pressed.valves_rad = {rad_from_deg(89)};
  turned.presses = {0, 0, 0};
  pressed.presses = {1, 0, 0};
  run.tasks = {turned, pressed};
  run.at_end = pressed;
  run.contacts.peak_force_n = 60;
  return run;
}

TEST(Truth, AgreesWithARunInWhichEverythingWasDone) { EXPECT_EQ(good_run().contradicted(), ""); }

TEST(Truth, TheValveIsWithinThreeDegreesOfItsTargetAtItsTasksEnd) {
  Judged run = good_run();
  run.tasks[0].valves_rad = run.at_end.valves_rad = {rad_from_deg(86.5)};
  EXPECT_EQ(run.contradicted(), "turn_valve: the valve stands at 86.5 deg instead of 90.0, against the core's account");
}

TEST(Truth, AValveThatMovesAfterItsTaskIsAFailure) {
  Judged run = good_run();
  run.at_end.valves_rad = {rad_from_deg(86.5)};
  EXPECT_EQ(run.contradicted(), "turn_valve: the valve has turned by -2.5 deg after its task");
  run.at_end.valves_rad = {rad_from_deg(88.0)};
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
  run.contacts.unintended = {{arm5e_body::wrist, arm5e_body::panel, 12.3, 4.0, "wrist", "panel"}};
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

// Two valves, V1 and V2, and three buttons, B1 to B3, from a file. V2 was turned to 90 degrees, then B3 pressed; V1 stood at 30 all the time.
Judged run_of_two_valves() {
  Judged run = good_run();
  run.names = {{"V1", "V2"}, {"B1", "B2", "B3"}, {"7"}};
  run.results[0].task.valve = 1;
  run.results[1].task.button = 2;
  const double first_rad = rad_from_deg(30);
  run.at_start.valves_rad = {first_rad, rad_from_deg(-20)};
  run.at_start.presses = {0, 0, 0};
  run.tasks[0].valves_rad = run.tasks[1].valves_rad = {first_rad, rad_from_deg(89)};
  run.tasks[1].presses = {0, 0, 1};
  run.at_end = run.tasks[1];
  return run;
}

TEST(Truth, OfATurnIsThatOfItsOwnValve) {
  EXPECT_EQ(run_of_two_valves().contradicted(), "");
  Judged run = run_of_two_valves();
  // The first one stands where the second was wanted: that is not the second's.
  for (TaskTruth* truth : {&run.tasks[0], &run.tasks[1], &run.at_end}) truth->valves_rad = {rad_from_deg(90), rad_from_deg(-20)};
  EXPECT_EQ(run.contradicted(), "turn_valve: valve V2 stands at -20.0 deg instead of 90.0, against the core's account");
  EXPECT_EQ(truly_done(run.results, run.tasks), (std::vector<bool>{false, true}));
}

TEST(Truth, OfEachValveIsHeldAgainstItsOwnLastTask) {
  Judged run = run_of_two_valves();
  mission::TaskResult first = run.results[0];
  first.task.valve = 0;
  first.task.to_rad = rad_from_deg(-45);
  run.results.push_back(first);
  TaskTruth both = run.at_end;
  both.valves_rad[0] = rad_from_deg(-45);
  run.tasks.push_back(both);
  run.at_end = both;
  EXPECT_EQ(run.contradicted(), "");
  run.at_end.valves_rad[1] = rad_from_deg(86.5);
  EXPECT_EQ(run.contradicted(), "turn_valve: valve V2 has turned by -2.5 deg after its task");
  run.at_end = both;
  run.at_end.valves_rad[0] = rad_from_deg(-42);
  EXPECT_EQ(run.contradicted(), "turn_valve: valve V1 has turned by 3.0 deg after its task");
  // Before its own task, as another one ends.
  run.at_end = both;
  run.tasks[1].valves_rad[0] = rad_from_deg(35);
  EXPECT_EQ(run.contradicted(), "turn_valve: valve V1 had turned by 5.0 deg before its task");
}

TEST(Truth, AValveThatTurnsWithoutATaskIsAFailure) {
  Judged run = run_of_two_valves();
  run.at_end.valves_rad[0] = rad_from_deg(35);
  EXPECT_EQ(run.contradicted(), "turn_valve: valve V1 has turned by 5.0 deg without a task");
  run.at_end.valves_rad[0] = rad_from_deg(31);
  EXPECT_EQ(run.contradicted(), "") << "a detent's pull";
  run.at_end.valves_rad[0] = rad_from_deg(35);
  run.at_start.valves_rad.clear();
  EXPECT_EQ(run.contradicted(), "") << "its start was not seen";
  run = good_run();
  run.results.erase(run.results.begin());
  run.tasks.erase(run.tasks.begin());
  run.at_start.valves_rad = {rad_from_deg(84)};
  EXPECT_EQ(run.contradicted(), "turn_valve: the valve has turned by 5.0 deg without a task");
}

TEST(Truth, OfAFilesPanelHasItsNames) {
  Judged run = run_of_two_valves();
  run.tasks[1].presses = run.at_end.presses = {0, 0, 0};
  EXPECT_EQ(run.contradicted(), "press_buttons: the B3 button did not click, against the core's account");
  run = run_of_two_valves();
  run.at_end.presses = {0, 1, 1};
  EXPECT_EQ(run.contradicted(), "press_buttons: the B2 button has clicked 1 times, 0 were asked for");
}

}  // namespace
}  // namespace lf::judge
