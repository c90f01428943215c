// The judge against runs made by hand, whose times are known to the millisecond.
#include "host_sim/judge/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace lf::judge {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint8_t all_joints = 0x1F;

Cause cause_of(const std::string& name) {
  for (const Cause& cause : all_causes()) {
    if (cause.name() == name) return cause;
  }
  ADD_FAILURE() << "no cause " << name;
  return {};
}

// The elbow moves at 0.3 rad/s when its drive reports a fault at 100 ms. The stop is on the bus `stop_ms` later, the elbow brakes with 2 rad/s2, and
// the power goes off `off_ms` after it stands.
struct Stopping {
  int stop_ms = 8, off_ms = 50;
  double force_n = 20, stands_at_rad_s = 0;
  double pulled_rad = 0;  // the joint, by a motor that stands, in 50 ms
  int pulled_ms = 600;    // then

  Seen seen() const {
    Seen seen;
    seen.fault_reported_s = 0.100;
    double angle_rad = 0, motor_rad = 0;
    for (int t = 0; t < 3000; ++t) {
      Moment moment;
      const int braking_ms = t - (100 + stop_ms);
      double speed = std::clamp(0.3 - 0.002 * braking_ms, stands_at_rad_s, 0.3);
      motor_rad += 0.001 * speed;
      if (t >= pulled_ms && t < pulled_ms + 50) speed += pulled_rad / 0.050;
      angle_rad += 0.001 * speed;
      moment.speed_rad_s[2] = static_cast<float>(speed);
      moment.angle_rad[2] = static_cast<float>(angle_rad);
      moment.motor_rad[2] = static_cast<float>(motor_rad);
      moment.force_n = static_cast<float>(force_n);
      moment.told_to_run = braking_ms < 0 ? all_joints : 0;
      moment.power = braking_ms < 140 + off_ms ? all_joints : 0;  // 0.02 rad/s are reached after 140 ms
      seen.moments.push_back(moment);
    }
    return seen;
  }
};

Situation situation_of(const Cause& cause) {
  Situation situation;
  situation.causes = {cause};
  situation.begins_s = {0.09};
  situation.deceleration_rad_s2.fill(2);
  situation.gear_gives_rad.fill(0.004);
  return situation;
}

Ending failed(const std::string& reason) {
  Ending ending;
  ending.ended = true;
  ending.step = "stopped";
  ending.reason = reason;
  return ending;
}

Verdict judged(const Stopping& run, const std::string& reason = "drive fault: elbow, EMCY 0x2310 (continuous over-current)") {
  return judge(run.seen(), situation_of(cause_of("overcurrent elbow")), failed(reason));
}

TEST(Verdict, AStopInTimeIsSafeAndItsFiguresAreThoseOfTheRun) {
  const Verdict verdict = judged({});
  EXPECT_THAT(verdict.wrong, IsEmpty());
  EXPECT_THAT(verdict.unclear, IsEmpty());
  EXPECT_NEAR(*verdict.stop_ms, 8, 1.1);
  EXPECT_NEAR(*verdict.standing_s, 0.140, 0.003);
  EXPECT_NEAR(*verdict.power_off_s, 0.050, 0.003);
  EXPECT_NEAR(*verdict.stop_to_off_s, 0.190, 0.003);
  EXPECT_NEAR(verdict.force_n, 20, 1e-6);
}

TEST(Verdict, AStopMayBeOnTheBusTwelveMillisecondsAfterTheReportAndNotFourteen) {
  EXPECT_THAT(judged({.stop_ms = 12}).wrong, IsEmpty());
  EXPECT_THAT(judged({.stop_ms = 14}).wrong, ElementsAre("still told to run 14 ms after the report"));
}

TEST(Verdict, PowerGoesOffAHundredMillisecondsAfterStanding) {
  EXPECT_THAT(judged({.off_ms = 95}).wrong, IsEmpty());
  EXPECT_THAT(judged({.off_ms = 120}).wrong, ElementsAre("power is off 0.12 s after standing"));
  EXPECT_EQ(judged({.off_ms = 5000}).wrong.size(), 3u) << "after standing, after the stop, and at the end";
}

// Its motor stands, and the joint swings in the gear's play at 0.03 rad/s and less than 4 mrad, for 60 ms, while its drive has power.
TEST(Verdict, PowerIsCountedFromTheLastSwingUnderPower) {
  Stopping run{.off_ms = 150};
  Seen seen = run.seen();
  for (std::size_t t = 260; t < 320; ++t) seen.moments[t].speed_rad_s[2] = 0.03f;
  const auto wrong = [&] { return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong; };
  EXPECT_THAT(wrong(), IsEmpty()) << "78 ms after the swing";
  for (std::size_t t = 260; t < 320; ++t) seen.moments[t].speed_rad_s[2] = 0.01f;
  EXPECT_THAT(wrong(), ElementsAre("power is off 0.15 s after standing"));
}

TEST(Verdict, AJointThatCreepsOnIsNotStopped) {
  const std::vector<std::string> wrong = judged({.stands_at_rad_s = 0.03}).wrong;
  ASSERT_FALSE(wrong.empty());
  EXPECT_THAT(wrong.front(), testing::HasSubstr("elbow moves"));
}

// Where its gear gives 4 mrad. Half a second after the joint had to stand its gear has unwound.
TEST(Verdict, AJointWhoseMotorStandsMayBePulledThroughItsPlayForATimeAndNoFarther) {
  EXPECT_THAT(judged({.pulled_rad = 0.0039}).wrong, IsEmpty());
  EXPECT_THAT(judged({.pulled_rad = 0.0048}).wrong, ElementsAre(testing::HasSubstr("elbow moves 0.54 s after the stop")));
  EXPECT_THAT(judged({.pulled_rad = 0.0039, .pulled_ms = 800}).wrong, IsEmpty());
  EXPECT_THAT(judged({.pulled_rad = 0.0039, .pulled_ms = 1100}).wrong,
              ElementsAre(testing::HasSubstr("elbow moves 1.04 s after the stop")));
}

TEST(Verdict, TwoCausesThatNoFrameToldAreStillAStop) {
  Seen seen = Stopping{.stop_ms = 900}.seen();
  seen.fault_reported_s.reset();
  Situation situation = situation_of(cause_of("overcurrent elbow"));
  situation.causes.push_back(cause_of("hot slew"));
  situation.begins_s.push_back(0.3);
  EXPECT_FALSE(judge(seen, situation, failed("drive fault: elbow")).wrong.empty());
}

TEST(Verdict, TheAdviceOfAReasonNamesNothing) {
  EXPECT_TRUE(cause_of("torque_frozen elbow").named_in("step failed: no button there (Or something.)"));
  EXPECT_FALSE(cause_of("torque_high elbow").named_in("step failed: the jaw does not open (The overload: elbow.)"));
  EXPECT_FALSE(cause_of("runaway slew").named_in("unexpected contact: roll"));
  EXPECT_TRUE(cause_of("runaway slew").named_in("following error: slew, in step grip"));
  EXPECT_FALSE(cause_of("silent io").named_in("camera silent"));
}

// At the end: 0.02 rad/s for 0.2 s.
TEST(Verdict, AtTheEndAJointThatTravelsMovesAndOneThatQuiversStands) {
  Seen seen = Stopping().seen();
  for (std::size_t t = 2500; t < seen.moments.size(); ++t) seen.moments[t].speed_rad_s[4] = 0.03f;
  const Situation situation = situation_of(cause_of("camera_silent"));
  EXPECT_THAT(judge(seen, situation, failed("camera silent")).wrong, IsEmpty());
  for (std::size_t t = 2500; t < seen.moments.size(); ++t) seen.moments[t].angle_rad[4] = 0.00003f * float(t - 2500);
  EXPECT_THAT(judge(seen, situation, failed("camera silent")).wrong, testing::Contains("the arm moves after the end"));
}

TEST(Verdict, TooMuchForceIsUnsafe) { EXPECT_THAT(judged({.force_n = 151}).wrong, ElementsAre("151 N of contact")); }

TEST(Verdict, AnEndThatDoesNotNameTheCauseIsUnclear) {
  EXPECT_THAT(judged({}, "panel vision unsure, in step scan").unclear,
              ElementsAre("the reason does not name the cause: panel vision unsure, in step scan"));
}

TEST(Verdict, AReasonNamesTheCauseAndItsNode) {
  const auto named = [](const char* cause, const char* reason) { return cause_of(cause).named_in(reason); };
  EXPECT_TRUE(named("overcurrent elbow", "drive fault: elbow, EMCY 0x2310 (continuous over-current)"));
  EXPECT_FALSE(named("overcurrent elbow", "drive fault: slew, EMCY 0x2310 (continuous over-current)")) << "another node";
  EXPECT_FALSE(named("overcurrent elbow", "step timed out"));
  EXPECT_FALSE(named("stuck_encoder roll", "step failed: the turn stalled")) << "a step that fails says nothing of the encoder";
  EXPECT_TRUE(named("silent io", "output node lost"));
  EXPECT_FALSE(named("silent io", "stale position: slew"));
  EXPECT_TRUE(named("reboot io", "node rebooted: io"));
  EXPECT_TRUE(named("drop_frames tpdo slew", "stale position: slew"));
  EXPECT_FALSE(named("drop_frames tpdo slew", "stale position: shoulder"));
  EXPECT_TRUE(named("foreign_rpdo io", "another master on the bus: identifier 0x0206"));
  EXPECT_FALSE(named("foreign_rpdo io", "another master on the bus: identifier 0x0201"));
  EXPECT_TRUE(named("foreign_sdo jaw", "another master on the bus: identifier 0x0605"));
  EXPECT_TRUE(named("foreign_sync", "another master on the bus: identifier 0x0080"));
  EXPECT_TRUE(named("stuck_encoder jaw", "step failed: the jaw does not open (Look at what it holds; free it by hand without power.)"));
  EXPECT_FALSE(named("stuck_encoder roll", "step failed: the jaw does not open (Look at what it holds; free it by hand without power.)"));
  EXPECT_TRUE(named("bus_off master", "CAN bus off"));
  EXPECT_TRUE(named("can_send_fails", "CAN bus off: sending fails"));
  EXPECT_FALSE(named("can_send_fails", "output node lost")) << "the node is well";
  EXPECT_TRUE(named("encoder_jump elbow", "tool outside its workspace")) << "all joints make the tool's place";
}

TEST(Verdict, ASuccessThatTheTruthContradictsIsFalse) {
  Ending ending = failed("");
  ending.success = true;
  ending.contradicted = "the left button did not click";
  const Verdict verdict = judge(Stopping().seen(), situation_of(cause_of("camera_silent")), ending);
  EXPECT_TRUE(verdict.false_success);
  EXPECT_FALSE(verdict.went_on);
}

TEST(Verdict, AMissionThatDoesNotEndIsWrongUnlessItWaitsForOrders) {
  Ending ending;
  ending.step = "scan";
  EXPECT_THAT(judge(Stopping().seen(), situation_of(cause_of("camera_silent")), ending).wrong, ElementsAre("it did not end"));
  ending.expected_to_end = false;
  EXPECT_THAT(judge(Stopping().seen(), situation_of(cause_of("camera_silent")), ending).wrong, IsEmpty());
}

TEST(Verdict, AnUnreadChainHasSixAndTwentyMillisecondsFromTheLastGoodData) {
  Seen seen = Stopping{.stop_ms = 0}.seen();  // told to stop at 100 ms
  seen.fault_reported_s.reset();
  seen.last_heard_s[5] = 0.075;
  EXPECT_THAT(judge(seen, situation_of(cause_of("silent io")), failed("emergency-stop chain unread")).wrong, IsEmpty());
  Situation earlier = situation_of(cause_of("silent io"));
  earlier.begins_s = {0.06};
  seen.last_heard_s[5] = 0.060;
  EXPECT_THAT(judge(seen, earlier, failed("emergency-stop chain unread")).wrong, ElementsAre("still told to run 40 ms after the report"));
}

// Two causes 0.1 s apart, the first 90 ms after watching began.
Situation situation_of(const Cause& first, const Cause& second) {
  Situation situation = situation_of(first);
  situation.causes.push_back(second);
  situation.begins_s.push_back(0.19);
  return situation;
}

TEST(Verdict, AShutDownMayHaltOnItsPathFirst) {
  Seen seen = Stopping{.stop_ms = 400}.seen();
  seen.fault_reported_s.reset();
  EXPECT_THAT(judge(seen, situation_of(cause_of("shut_down_ordered")), failed("shut down")).wrong, IsEmpty());
}

TEST(Verdict, AnEmergencyStopAfterAShutDownHasItsOwnDeadline) {
  const Situation situation = situation_of(cause_of("shut_down_ordered"), cause_of("estop"));
  const auto wrong = [&](int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.chain_open_s = seen.fault_reported_s = 0.2;
    return judge(seen, situation, failed("emergency stop: the chain is open")).wrong;
  };
  EXPECT_THAT(wrong(112), IsEmpty());
  EXPECT_THAT(wrong(114), ElementsAre("still told to run 14 ms after the report"));
}

TEST(Verdict, ADriveFaultAfterAShutDownHasItsOwnDeadline) {
  const Situation situation = situation_of(cause_of("shut_down_ordered"), cause_of("overcurrent elbow"));
  const auto wrong = [&](int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.fault_reported_s = 0.2;
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(112), IsEmpty());
  EXPECT_THAT(wrong(114), ElementsAre("still told to run 14 ms after the report"));
}

TEST(Verdict, ALaterCauseDoesNotExcuseALateReactionToTheFirst) {
  Seen seen = Stopping{.stop_ms = 40}.seen();
  seen.chain_open_s = seen.fault_reported_s = 0.1;
  EXPECT_THAT(judge(seen, situation_of(cause_of("estop"), cause_of("shut_down_ordered")), failed("emergency stop")).wrong,
              ElementsAre("still told to run 40 ms after the report"));
}

TEST(Verdict, AFaultThatNoFrameReportedHasNoDeadlineOfItsOwnBesideAnother) {
  Seen seen = Stopping{.stop_ms = 400}.seen();  // the halt was over before the drive noticed
  seen.fault_reported_s.reset();
  EXPECT_THAT(judge(seen, situation_of(cause_of("shut_down_ordered"), cause_of("hot elbow")), failed("shut down")).wrong, IsEmpty());
  EXPECT_THAT(judge(seen, situation_of(cause_of("hot elbow")), failed("drive fault: elbow")).wrong,
              testing::Contains("still told to run 410 ms after the report"))
      << "alone it counts from its beginning";
}

TEST(Verdict, AMasterThatIsCutOffIsJudgedByTheDrivesOwnStop) {
  const auto wrong = [](const Situation& situation, int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.chain_open_s = seen.fault_reported_s = 0.2;
    return judge(seen, situation, failed("CAN bus off, emergency stop")).wrong;
  };
  for (const char* cut : {"can_send_fails", "bus_off master"}) {
    SCOPED_TRACE(cut);
    EXPECT_THAT(wrong(situation_of(cause_of(cut)), 385), IsEmpty());
    EXPECT_THAT(wrong(situation_of(cause_of(cut)), 500), testing::Contains(testing::StartsWith("still told to run 51")));
    EXPECT_THAT(wrong(situation_of(cause_of(cut), cause_of("estop")), 385), IsEmpty()) << "no frame tells the drives of the later stop";
    EXPECT_THAT(wrong(situation_of(cause_of("estop"), cause_of(cut)), 385), IsEmpty()) << "the chain's frame came after the cut";
  }
}

TEST(Verdict, AStopBeforeTheMasterIsCutOffHasToBeOnTheBusByThen) {
  Seen seen = Stopping{.stop_ms = 60}.seen();
  seen.chain_open_s = seen.fault_reported_s = 0.1;  // 90 ms before the cut
  EXPECT_THAT(judge(seen, situation_of(cause_of("estop"), cause_of("can_send_fails")), failed("emergency stop")).wrong,
              ElementsAre("still told to run 60 ms after the report"));
}

TEST(Verdict, AMasterThatHearsNothingIsNotBlamedForAReportItMissed) {
  Seen seen = Stopping{.stop_ms = 14}.seen();  // 24 ms after the receiving call began to fail
  seen.chain_open_s = seen.fault_reported_s = 0.095;
  Situation situation = situation_of(cause_of("can_receive_fails"), cause_of("estop"));
  situation.begins_s[1] = 0.094;
  EXPECT_THAT(judge(seen, situation, failed("emergency-stop chain unread")).wrong, IsEmpty());
  seen = Stopping{.stop_ms = 20}.seen();
  EXPECT_THAT(judge(seen, situation, failed("emergency-stop chain unread")).wrong, ElementsAre("still told to run 30 ms after the report"));
}

// A joint may brake from the highest speed of the 20 ms after the order: at 2 rad/s2 and 0.15 s it may move for 0.30 s after 0.3 rad/s.
TEST(Verdict, AnOrderTakesEffectWithinTwentyMilliseconds) {
  const auto wrong = [](int peak_ms) {
    Seen seen = Stopping{.stop_ms = 8}.seen();
    // It crept before, too: 0.03 rad/s.
    for (int t = 0; t < 108; ++t) seen.moments[static_cast<std::size_t>(t)].motor_rad[2] = 0.00003f * static_cast<float>(t);
    const float stood_rad = seen.moments[107].motor_rad[2];
    for (int t = 108; t < 3000; ++t) {
      Moment& moment = seen.moments[static_cast<std::size_t>(t)];
      moment.speed_rad_s[2] = t < 108 + 250 ? 0.03f : 0;
      moment.angle_rad[2] = moment.motor_rad[2] = stood_rad + 0.00003f * static_cast<float>(std::min(t - 107, 251));
    }
    // The elbow creeps for 250 ms, which only a peak of at least 0.2 rad/s allows.
    seen.moments[static_cast<std::size_t>(108 + peak_ms)].speed_rad_s[2] = 0.3f;
    for (int t = 108 + 250; t < 3000; ++t) seen.moments[static_cast<std::size_t>(t)].power = 0;
    return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(0), IsEmpty());
  EXPECT_THAT(wrong(19), IsEmpty()) << "the last millisecond of the window";
  EXPECT_THAT(wrong(20), ElementsAre(testing::HasSubstr("elbow moves 0.25 s after the stop, 0.16 s are allowed")));
}

// NMT reaches it: 20 ms after it has not heeded a stop.
TEST(Verdict, ADriveThatLosesItsProcessDataIsToldByNmt) {
  const auto wrong = [](int elbow_ms, const std::string& lost, double lost_s = 0.05) {
    Seen seen = Stopping().seen();
    for (int t = 108; t < 100 + elbow_ms; ++t) seen.moments[static_cast<std::size_t>(t)].told_to_run = 0x04;
    Situation situation = situation_of(cause_of("overcurrent slew"), cause_of(lost));
    situation.begins_s[1] = lost_s;
    return judge(seen, situation, failed("drive fault: slew")).wrong;
  };
  EXPECT_THAT(wrong(32, "drop_frames rpdo elbow", 0.115), ElementsAre("still told to run 32 ms after the report"))
      << "lost after it had to be told";
  EXPECT_THAT(wrong(32, "drop_frames rpdo elbow"), IsEmpty());
  EXPECT_THAT(wrong(35, "drop_frames rpdo elbow"), ElementsAre("still runs without process data 35 ms after the report"));
  EXPECT_THAT(wrong(32, "drop_frames rpdo slew"), ElementsAre("still told to run 32 ms after the report"));
  EXPECT_THAT(wrong(32, "drop_frames (one frame) rpdo elbow"), ElementsAre("still told to run 32 ms after the report"));
}

// It hears neither process data nor NMT: it stops when it misses the master's heartbeat.
TEST(Verdict, ADriveThatLosesItsProcessDataAndIsCutOffStopsByItself) {
  const auto wrong = [](int elbow_ms) {
    Seen seen = Stopping().seen();
    for (int t = 108; t < 100 + elbow_ms; ++t) {
      seen.moments[static_cast<std::size_t>(t)].told_to_run = 0x04;
      seen.moments[static_cast<std::size_t>(t)].power = 0x04;
    }
    Situation situation = situation_of(cause_of("drop_frames rpdo elbow"), cause_of("silent elbow"));
    situation.begins_s = {0.05, 0.095};
    seen.last_heard_s[2] = 0.095;
    return judge(seen, situation, failed("stale position: elbow")).wrong;
  };
  EXPECT_THAT(wrong(245), IsEmpty());
}

// The drives are enabled at 1 s, `moving_ms` before they lose their power; the jaw runs off meanwhile. The fault is reported at 0.1 s, or at 1.1 s.
std::vector<std::string> powering_up(const std::string& cause, int moving_ms, double begins_s = 0.09) {
  Seen seen;
  for (int t = 0; t < 4000; ++t) {
    Moment moment;
    const int moved_ms = std::clamp(t - 1000, 0, moving_ms);
    if (t >= 1000 && t < 1000 + moving_ms) {
      moment.power = moment.told_to_run = all_joints;
      moment.speed_rad_s[4] = 1;
    }
    moment.angle_rad[4] = moment.motor_rad[4] = 0.001f * static_cast<float>(moved_ms);
    seen.moments.push_back(moment);
  }
  seen.fault_reported_s = seen.chain_open_s = begins_s + 0.01;
  Situation situation = situation_of(cause_of(cause));
  situation.causes.push_back(cause_of("runaway jaw"));
  situation.begins_s = {begins_s, 0.5};
  situation.powering_up = true;
  return judge(seen, situation, failed("drive fault: elbow")).wrong;
}

TEST(Verdict, PoweringUpThatHadToEndMovesNothing) {
  EXPECT_THAT(powering_up("estop", 0), IsEmpty());
  EXPECT_THAT(powering_up("estop", 200), testing::Contains("jaw moves from 1.00 to 1.20 s although powering up had to end"));
}

// The others are enabled while a drive's fault is reset.
TEST(Verdict, ADriveThatRunsOffBesideOneInFaultHasTheTimeOfAStop) {
  EXPECT_THAT(powering_up("overcurrent elbow", 1100), IsEmpty());
  EXPECT_THAT(powering_up("overcurrent elbow", 1300), ElementsAre("jaw moves from 1.00 to 2.30 s although powering up had to end"));
}

TEST(Verdict, AFaultThatComesWhenTheDrivesRunAlreadyStopsThem) {
  EXPECT_THAT(powering_up("estop", 112, 1.09), IsEmpty());
  EXPECT_THAT(powering_up("estop", 150, 1.09), ElementsAre("still told to run 50 ms after the report"));
}

// Its motor stands.
TEST(Verdict, WhoIsPushedWindsUpItsGear) {
  const auto wrong = [](const std::string& other, double begins_s, float force_n, bool motor_turns) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 600; t < 900; ++t) {
      Moment& moment = seen.moments[t];
      moment.speed_rad_s[0] = 0.1f;
      moment.angle_rad[0] = 0.0001f * static_cast<float>(t - 600);
      moment.motor_rad[0] = motor_turns ? moment.angle_rad[0] : 0;
      moment.force_n = force_n;
    }
    Situation situation = situation_of(cause_of("overcurrent elbow"), cause_of(other));
    situation.begins_s[1] = begins_s;
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  const auto moves = ElementsAre(testing::ContainsRegex("slew moves 0.(79|80) s after the stop"));
  EXPECT_THAT(wrong("obstacle", 0.5, 80, false), IsEmpty());
  EXPECT_THAT(wrong("obstacle", 0.5, 80, true), moves);
  EXPECT_THAT(wrong("obstacle", 0.5, 0, false), moves) << "nothing touches it";
  EXPECT_THAT(wrong("obstacle", 1.5, 80, false), moves) << "not yet";
  EXPECT_THAT(wrong("handle_breaks", 0.5, 80, false), moves);
}

TEST(Verdict, AForceIsAForceWhateverPushes) {
  for (const char* cause : {"obstacle", "handle_breaks"}) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 1000; t < 3000; ++t) seen.moments[t].force_n = 160;
    const Verdict verdict = judge(seen, situation_of(cause_of("overcurrent elbow"), cause_of(cause)), failed("drive fault: elbow"));
    EXPECT_THAT(verdict.wrong, ElementsAre("160 N of contact")) << cause;
  }
}

// The elbow hears no process data: it is restarted.
TEST(Verdict, ADriveThatIsRestartedLosesItsPowerALittleLater) {
  const auto wrong = [](int off_ms, const std::string& lost) {
    Seen seen = Stopping().seen();
    for (int t = 0; t < 3000; ++t) {
      std::uint8_t& power = seen.moments[static_cast<std::size_t>(t)].power;
      power = static_cast<std::uint8_t>((power & ~0x04) | (t < 108 + 140 + off_ms ? 0x04 : 0));
    }
    return judge(seen, situation_of(cause_of("overcurrent slew"), cause_of(lost)), failed("drive fault: slew")).wrong;
  };
  EXPECT_THAT(wrong(210, "drop_frames rpdo elbow"), IsEmpty());
  EXPECT_THAT(wrong(230, "drop_frames rpdo elbow"), ElementsAre("power is off 0.23 s after standing without process data"));
  EXPECT_THAT(wrong(210, "drop_frames tpdo elbow"), ElementsAre("power is off 0.21 s after standing"));
}

// Nothing that our master sends arrives, and another one keeps the drives running: no software stops them.
TEST(Verdict, OnlyTheChainStopsWhatAnotherMasterHasTakenOver) {
  Seen seen = Stopping{.stop_ms = 2000}.seen();
  seen.second_master_s = 0.1;
  const auto wrong = [&](const std::string& first, double first_s, const std::string& second) {
    Situation situation = situation_of(cause_of(first), cause_of(second));
    situation.begins_s[0] = first_s;
    return judge(seen, situation, failed("another master on the bus")).wrong;
  };
  EXPECT_THAT(wrong("can_send_fails", 0.05, "foreign_master"), IsEmpty());
  EXPECT_THAT(wrong("can_send_fails", 0.111, "foreign_master"), IsEmpty()) << "before it could have told them";
  EXPECT_FALSE(wrong("can_send_fails", 0.13, "foreign_master").empty());
  EXPECT_FALSE(wrong("can_send_fails", -0.31, "foreign_master").empty()) << "the drives had missed ours before";
  EXPECT_FALSE(wrong("can_send_fails", 0.05, "foreign_heartbeat").empty()) << "the drives miss our heartbeat";
  EXPECT_FALSE(wrong("hot slew", 0.05, "foreign_master").empty());
}

// Nothing asks for a time of its own; the drive says that it is in fault at 0.1 s.
TEST(Verdict, ADriveThatSaysItIsInFaultIsAStopWhateverCausedIt) {
  const auto wrong = [](int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.drive_fault_s = 0.100;
    return judge(seen, situation_of(cause_of("torque_high elbow")), failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(12), IsEmpty());
  EXPECT_THAT(wrong(14), ElementsAre("still told to run 14 ms after the report"));
}

TEST(Verdict, AnEndThatNothingReportedStandsAndTakesThePowerAsAStopDoes) {
  const auto wrong = [](const Stopping& run) {
    Seen seen = run.seen();
    seen.fault_reported_s.reset();
    return judge(seen, situation_of(cause_of("stuck_encoder elbow")), failed("following error: elbow")).wrong;
  };
  EXPECT_THAT(wrong({.stop_ms = 400}), IsEmpty()) << "it has no time in which it must be found";
  EXPECT_THAT(wrong({.stop_ms = 400, .off_ms = 120}), ElementsAre("power is off 0.12 s after standing"));
  EXPECT_THAT(wrong({.pulled_rad = 0.0048}), ElementsAre(testing::HasSubstr("elbow moves")));
}

TEST(Verdict, AChainThatCannotBeReadIsTimedWhereItsFramesAreLost) {
  const auto wrong = [](double heard_s) {
    Seen seen = Stopping{.stop_ms = 0}.seen();  // told to stop at 100 ms
    seen.fault_reported_s.reset();
    seen.last_heard_s[5] = heard_s;
    Situation situation = situation_of(cause_of("drop_frames tpdo io"));
    situation.begins_s = {heard_s};
    return judge(seen, situation, failed("output node lost")).wrong;
  };
  EXPECT_THAT(wrong(0.075), IsEmpty());
  EXPECT_THAT(wrong(0.060), ElementsAre("still told to run 40 ms after the report"));
}

TEST(Verdict, AContactThatIsNoneIsNoReasonToHoldADriveThatMisleads) {
  const auto judged_with = [](float force_n, const std::string& reason, bool holds) {
    const Seen seen = Stopping{.force_n = force_n}.seen();
    Ending ending = failed(reason);
    ending.holds = holds;
    return judge(seen, situation_of(cause_of("stuck_encoder elbow")), ending);
  };
  EXPECT_THAT(judged_with(0, "unexpected contact: elbow", true).wrong, ElementsAre(testing::HasSubstr("held under power")));
  EXPECT_THAT(judged_with(0, "unexpected contact: elbow", false).unclear, testing::SizeIs(1));
  EXPECT_THAT(judged_with(0, "following error: elbow", false).unclear, IsEmpty());
  EXPECT_THAT(judged_with(20, "unexpected contact: elbow", true).wrong, IsEmpty());
}

// Its drives get power at 1 s.
TEST(Verdict, AChainThatOpensBeforePowerLeavesEveryDriveWithoutIt) {
  const auto wrong = [](const std::string& cause, bool powered) {
    Seen seen;
    for (int t = 0; t < 4000; ++t) {
      seen.moments.emplace_back();
      if (powered && t >= 1000 && t < 2000) seen.moments.back().power = all_joints;
    }
    seen.fault_reported_s = seen.chain_open_s = 0.1;
    Situation situation = situation_of(cause_of(cause));
    situation.powering_up = true;
    return judge(seen, situation, failed("emergency stop, drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong("estop", false), IsEmpty());
  EXPECT_THAT(wrong("estop", true), ElementsAre(testing::HasSubstr("power is on")));
  EXPECT_THAT(wrong("overcurrent elbow", true), IsEmpty()) << "the others are enabled while a drive's fault is reset";
}

// From the first to the second cause the others are enabled.
TEST(Verdict, PowerWhileADrivesFaultIsResetEndsWithAnotherMaster) {
  const auto wrong = [](int until_ms) {
    Seen seen;
    for (int t = 0; t < 4000; ++t) {
      seen.moments.emplace_back();
      if (t >= 300 && t < until_ms) seen.moments.back().power = all_joints;
    }
    seen.fault_reported_s = 0.1;
    seen.second_master_s = 0.6;
    Situation situation = situation_of(cause_of("overcurrent elbow"), cause_of("foreign_nmt"));
    situation.begins_s[1] = 0.59;
    situation.powering_up = true;
    return judge(seen, situation, failed("another master on the bus")).wrong;
  };
  EXPECT_THAT(wrong(700), IsEmpty());
  EXPECT_THAT(wrong(730), ElementsAre("power is on 0.12 s after powering up had to end"));
}

TEST(Verdict, WhatWaitsForOrdersMovesByNoneOfItsOwn) {
  Seen seen = Stopping().seen();
  for (std::size_t t = 2500; t < seen.moments.size(); ++t) seen.moments[t].angle_rad[4] = 0.0001f * float(t - 2500);
  Ending ending;
  ending.step = "ready";
  ending.expected_to_end = false;
  EXPECT_THAT(judge(seen, situation_of(cause_of("runaway jaw")), ending).wrong, ElementsAre("the arm moves and no order moves it"));
}

TEST(Verdict, WhatMustGoOnIsUnclearWhenItEnds) {
  const Verdict verdict = judge(Stopping().seen(), situation_of(cause_of("image_lost")), failed("image lost, in step scan"));
  EXPECT_THAT(verdict.unclear, ElementsAre("it should have gone on: image lost, in step scan"));
}

}  // namespace
}  // namespace lf::judge
