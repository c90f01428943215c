// The judge against runs made by hand, whose times are known to the millisecond: one cause.
#include "host_sim/judge/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/judge/stopping.hpp"

namespace lf::judge {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

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
  for (std::size_t t = 260; t < seen.moments.size(); ++t) {
    if (t < 320) seen.moments[t].speed_rad_s[2] = 0.03f;
    seen.moments[t].angle_rad[2] += 0.00003f * float(std::min<std::size_t>(t, 320) - 260);
  }
  const auto wrong = [&] { return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong; };
  EXPECT_THAT(wrong(), IsEmpty()) << "78 ms after the swing";
  for (std::size_t t = 260; t < 320; ++t) seen.moments[t].speed_rad_s[2] = 0.01f;
  EXPECT_THAT(wrong(), ElementsAre("power is off 0.15 s after standing"));
}

// The elbow was heard last at 0.6 rad/s, from which it takes 0.29 s at 2 rad/s^2 down to 0.02, and stands after 0.14 s. The others stand, and lose their power 0.09 s
// after the stop.
std::vector<std::string> wrong_unheard(const std::string& cause, double power_off_s, std::uint8_t powered, double heard_s) {
  constexpr double stop_s = 0.108;
  Seen seen = Stopping{.off_ms = 5000}.seen();
  for (std::size_t t = 0; t < seen.moments.size(); ++t) {
    Moment& moment = seen.moments[t];
    const double after_s = double(t) * 0.001 - stop_s;
    if (t >= 70 && t < 90) moment.speed_rad_s[2] = 0.6f;
    if (after_s >= 0.09) moment.power &= powered;
    if (after_s >= power_off_s) moment.power = 0;
  }
  seen.last_heard_s[2] = heard_s;
  return judge(seen, situation_of(cause_of(cause)), failed("stale position: elbow")).wrong;
}

TEST(Verdict, AJointThatIsNotHeardIsTakenForMovingUntilItsRampIsOver) {
  constexpr std::uint8_t elbow = 1 << 2, slew = 1;
  constexpr double ramp_s = 0.29;
  const std::string lost = "drop_frames tpdo elbow";
  EXPECT_THAT(wrong_unheard(lost, ramp_s + 0.095, elbow, 0.088), IsEmpty());
  EXPECT_THAT(wrong_unheard(lost, ramp_s + 0.120, elbow, 0.088), ElementsAre("power is off 0.27 s after standing"));
  EXPECT_THAT(wrong_unheard(lost, ramp_s + 0.095, elbow | slew, 0.088), ElementsAre("power is off 0.39 s after standing"))
      << "the slew is heard, and stands";
  EXPECT_THAT(wrong_unheard("drop_frames emcy elbow", ramp_s + 0.095, elbow, 0.088), testing::Not(IsEmpty())) << "it is heard";
}

// The record begins with the fault, 5 ms before the joint is heard last: of the 20 ms whose speed the master knows 15 are not on it.
TEST(Verdict, AJointThatIsNotHeardFromTheRecordsBeginningMayHaveBeenFasterBefore) {
  constexpr std::uint8_t elbow = 1 << 2;
  constexpr double ramp_s = 0.14 + 0.015;
  EXPECT_THAT(wrong_unheard("drop_frames tpdo elbow", ramp_s + 0.095, elbow, 0.005), IsEmpty());
  EXPECT_THAT(wrong_unheard("drop_frames tpdo elbow", ramp_s + 0.110, elbow, 0.005), ElementsAre(testing::HasSubstr("after standing")));
}

// Frames are on the bus, and the master has none of them from then on.
TEST(Verdict, AMasterThatHearsNothingHasHeardNothingSince) {
  constexpr std::uint8_t elbow = 1 << 2;
  EXPECT_THAT(wrong_unheard("can_receive_fails", 0.29 + 0.095, elbow, 3), IsEmpty());
  EXPECT_THAT(wrong_unheard("can_receive_fails", 0.29 + 0.120, elbow, 3), ElementsAre("power is off 0.27 s after standing"));
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
  EXPECT_THAT(judged({.force_n = 4, .pulled_rad = 0.0039, .pulled_ms = 1100}).wrong,
              ElementsAre(testing::HasSubstr("elbow moves 1.04 s after the stop")));
}

// A handle that slips in the pads lets a wound-up joint go whenever it slips: it is excused, and counted.
TEST(Verdict, AJointWithoutPowerGivesWayToTheHandleInTheJawByWhatItsGearGives) {
  for (const int at_ms : {1100, 2500}) {
    const Verdict gives = judged({.grip_n = 6, .pulled_rad = 0.0039, .pulled_ms = at_ms});
    EXPECT_THAT(gives.wrong, IsEmpty());
    EXPECT_TRUE(gives.gave_way);
    EXPECT_NEAR(gives.standing_s.value_or(0), at_ms == 1100 ? 1.04 : 2.44, 0.011) << "the table has the true time";
  }
  EXPECT_TRUE(judged({.grip_n = 6}).gripped);
  EXPECT_FALSE(judged({.grip_n = 6}).gave_way);
  EXPECT_FALSE(judged({.grip_n = 6, .pulled_rad = 0.0039}).gave_way) << "in the half second that every joint has";
  EXPECT_FALSE(judged({.grip_n = 4}).gripped);
  const auto wrong = ElementsAre(testing::HasSubstr("elbow moves 1.04 s after the stop"));
  EXPECT_THAT(judged({.grip_n = 4, .pulled_rad = 0.0039, .pulled_ms = 1100}).wrong, wrong) << "20 N on another body";
  EXPECT_THAT(judged({.grip_n = 6, .pulled_rad = 0.0048, .pulled_ms = 1100}).wrong, wrong);
  EXPECT_THAT(judged({.off_ms = 2000, .grip_n = 6, .pulled_rad = 0.0039, .pulled_ms = 1100}).wrong,
              testing::Contains(testing::HasSubstr("elbow moves 1.04 s")));
}

TEST(Verdict, AJointThatGivesWayToTheHandleIsWithoutPowerAndInTheJawAndTravelsOnce) {
  const auto wrong = [](const auto& change) {
    Seen seen = Stopping{.grip_n = 6, .pulled_rad = 0.0039, .pulled_ms = 1100}.seen();
    for (std::size_t t = 0; t < seen.moments.size(); ++t) change(seen.moments[t], t);
    return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong;
  };
  const auto moves = testing::Contains(testing::HasSubstr("elbow moves 1.0"));
  EXPECT_THAT(wrong([](Moment&, std::size_t) {}), IsEmpty());
  EXPECT_THAT(wrong([](Moment& m, std::size_t t) { m.grip_n = t < 1000 ? 100 : 0; }), moves) << "it was let go before";
  EXPECT_THAT(wrong([](Moment& m, std::size_t) { m.power |= 1U << 2; }), moves) << "this joint has power";
  EXPECT_THAT(wrong([](Moment& m, std::size_t) { m.power |= 1U << 3; }), moves) << "another joint has power, and may drag it";
  EXPECT_THAT(wrong([](Moment& m, std::size_t t) { m.motor_rad[2] += 0.0019f * std::clamp((float(t) - 1100) / 50, 0.0f, 1.0f); }), moves)
      << "its motor turns with it";
  EXPECT_THAT(wrong([](Moment& m, std::size_t t) {  // 2.5 mrad more, back and forth: 6.4 in all
                if (t >= 2000) m.angle_rad[2] -= 0.0064f * std::min(1.0f, float(t - 2000) / 50);
                if (t >= 2000 && t < 2050) m.speed_rad_s[2] = 0.12f;
              }),
              testing::Contains(testing::HasSubstr("elbow moves 1.9")));
}

// It is pulled further than its gear gives, and quivers there at 0.1 rad/s by 0.1 mrad.
TEST(Verdict, AJointThatQuiversInItsWoundUpGearStands) {
  const auto wrong = [](float by_rad) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 0; t < seen.moments.size(); ++t) {
      seen.moments[t].angle_rad[4] = 0.0048f + (t % 2 == 0 ? by_rad : 0);
      seen.moments[t].speed_rad_s[4] = t < 600 ? 0.1f : 0;
    }
    return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(0.00039f), IsEmpty());
  EXPECT_THAT(wrong(0.00041f), testing::Contains(testing::HasSubstr("jaw moves")));
}

// For ten milliseconds, long after it had to stand: a quiver of the joint is excused, a motor that turns is not.
TEST(Verdict, AMotorThatTurnsForSomeMillisecondsMoves) {
  const auto wrong = [](float rad_s) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 500; t < seen.moments.size(); ++t)
      seen.moments[t].motor_rad[3] += rad_s * 0.001f * static_cast<float>(std::min<std::size_t>(t - 500, 10));
    return judge(seen, situation_of(cause_of("overcurrent elbow")), failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(0.019f), IsEmpty());
  EXPECT_THAT(wrong(0.025f), testing::Contains(testing::HasSubstr("roll moves")));
}

// The shoulder's motor stood from the beginning. At 298 ms the power goes; the gear gives 4 mrad.
TEST(Verdict, AScrewUnderALoadMaySettleWhenItsPowerGoesAndAtNoOtherTime) {
  const auto wrong = [](std::size_t moves_at_ms, float by_rad, const Situation& situation = situation_of(cause_of("overcurrent elbow"))) {
    Seen seen = Stopping().seen();
    for (std::size_t t = moves_at_ms; t < seen.moments.size(); ++t) {
      seen.moments[t].motor_rad[1] = seen.moments[t].angle_rad[1] = std::min(by_rad, by_rad * float(t - moves_at_ms) / 4);
      seen.moments[t].speed_rad_s[1] = t < moves_at_ms + 4 ? by_rad / 0.004f : 0;
    }
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(298, 0.0038f), IsEmpty());
  EXPECT_THAT(wrong(298, 0.0045f), testing::Contains(testing::HasSubstr("shoulder moves")));
  EXPECT_THAT(wrong(270, 0.0038f), testing::Contains(testing::HasSubstr("shoulder moves"))) << "under power";
  EXPECT_THAT(wrong(285, 0.0038f), testing::Contains(testing::HasSubstr("shoulder moves"))) << "it did not stand when its power went";
  EXPECT_THAT(wrong(400, 0.0038f), testing::Contains(testing::HasSubstr("shoulder moves"))) << "long after";

  Situation locked = situation_of(cause_of("overcurrent elbow"));
  locked.slips_rad.fill(0.0002);
  EXPECT_THAT(wrong(298, 0.0038f, locked), testing::Contains(testing::HasSubstr("shoulder moves")))
      << "a gear that locks itself does not slip";
}

// Nothing reports it: it may last, and not lead far.
TEST(Verdict, AJointThatRunsOffIsStoppedBeforeItHasGoneFar) {
  const auto wrong = [](const std::string& cause, float rad) {
    Seen seen;
    seen.moments.resize(3000);
    for (std::size_t t = 1000; t < 3000; ++t) seen.moments[t].angle_rad[1] = seen.moments[t].motor_rad[1] = rad;
    return judge(seen, situation_of(cause_of(cause)), failed("following error: shoulder")).wrong;
  };
  EXPECT_THAT(wrong("runaway shoulder", 0.45f), IsEmpty());
  EXPECT_THAT(wrong("runaway shoulder", 0.55f), testing::Contains(testing::HasSubstr("shoulder goes 0.55 rad")));
  EXPECT_THAT(wrong("stuck_encoder shoulder", -0.55f), testing::Contains(testing::HasSubstr("shoulder goes 0.55 rad")));
  EXPECT_THAT(wrong("runaway elbow", 0.55f), IsEmpty()) << "another joint";
}

// The shoulder goes at 0.1 rad/s, and its drive gives 2 N m for it; then 14 N m for a time.
TEST(Verdict, APushIsFeltByAJointThatWorksAgainstItForAsLongAsAForceIsJudged) {
  const auto felt = [](float nm, std::size_t for_ms) {
    Seen seen;
    seen.moments.resize(1000);
    for (std::size_t t = 0; t < 1000; ++t) seen.moments[t].works_nm[1] = t >= 300 && t < 300 + for_ms ? nm : 2;
    SafetyFigures figures;
    figures.felt_nm = 13;
    figures.felt_by_roll_nm = 5;
    return felt_a_push(seen, figures);
  };
  EXPECT_FALSE(felt(14, 500)) << "12 more than before";
  EXPECT_TRUE(felt(16, 60));
  EXPECT_FALSE(felt(16, 40));
  EXPECT_FALSE(felt(-40, 500)) << "along its way";
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

// It is told at 1 s. What the jaw held long before is no contact that the arm has met, nor is what it touches later.
TEST(Verdict, AContactCountsFromShortlyBeforeItIsTold) {
  const auto held_for_nothing = [](int touched_from_ms, int touched_to_ms, float force_n, const Situation& situation) {
    Seen seen = Stopping{.stop_ms = 1000, .force_n = 0}.seen();
    for (int t = touched_from_ms; t < touched_to_ms; ++t) seen.moments[static_cast<std::size_t>(t)].force_n = force_n;
    Ending ending = failed("unexpected contact: elbow");
    ending.holds = true;
    ending.told_s = 1;
    const std::vector<std::string> wrong = judge(seen, situation, ending).wrong;
    return std::any_of(wrong.begin(), wrong.end(), [](const std::string& what) { return what.starts_with("held under power"); });
  };
  const Situation stuck = situation_of(cause_of("stuck_encoder elbow"));
  EXPECT_TRUE(held_for_nothing(0, 490, 30, stuck));
  EXPECT_FALSE(held_for_nothing(0, 510, 30, stuck));
  EXPECT_TRUE(held_for_nothing(1010, 2900, 30, stuck));
  EXPECT_FALSE(held_for_nothing(900, 950, 6, stuck));
  EXPECT_TRUE(held_for_nothing(900, 950, 4, stuck)) << "no contact that could be felt";
  // It was given up for something else, and held later.
  const auto held_at = [&](std::optional<double> held_s, bool touches_when_told = true) {
    Seen seen = Stopping{.stop_ms = 1000, .force_n = 0}.seen();
    for (std::size_t t = 2100; t < 2900; ++t) seen.moments[t].force_n = 30;
    if (touches_when_told) seen.moments[900].force_n = 6;
    Ending ending = failed("the jaw holds nothing: elbow");
    ending.holds = true;
    ending.told_s = 1;
    ending.held_s = held_s;
    return judge(seen, stuck, ending).wrong;
  };
  EXPECT_THAT(held_at(2), testing::Contains(testing::HasSubstr("held under power")));
  EXPECT_THAT(held_at(2.4), testing::Not(testing::Contains(testing::HasSubstr("held under power"))));
  EXPECT_THAT(held_at(2.4, false), testing::Contains(testing::HasSubstr("held under power"))) << "what it met later was its own doing";
  const auto beside = [](const char* cause) { return situation_of(cause_of("stuck_encoder elbow"), cause_of(cause)); };
  for (const char* cause : {"error_frames", "camera_fails", "interlock_open", "torque_frozen roll", "vision_silent"})
    EXPECT_TRUE(held_for_nothing(0, 0, 0, beside(cause))) << cause;
  EXPECT_FALSE(held_for_nothing(0, 0, 0, beside("obstacle")));
  EXPECT_FALSE(held_for_nothing(0, 0, 0, beside("handle_breaks")));
}

// A seized motor that should have gone somewhere could have been told from a contact; one that was to stay could not. A set-point of two counts is rounding.
TEST(Verdict, ASeizedJointMayBeTakenForAContactWhereItWasToStay) {
  const auto verdict = [](std::int32_t to, double units_per_count, bool holds = true, const char* told = "unexpected contact: elbow") {
    Seen seen = Stopping{.force_n = 0}.seen();
    seen.told_to_go[2] = {1000, 1000 + to};
    Ending ending = failed(told);
    ending.holds = holds;
    Situation situation = situation_of(cause_of("following elbow"));
    situation.units_per_count.fill(units_per_count);
    return judge(seen, situation, ending);
  };
  EXPECT_THAT(verdict(2, 1).wrong, IsEmpty());
  EXPECT_THAT(verdict(2, 1).unclear, IsEmpty());
  EXPECT_TRUE(verdict(2, 1).stood_anyway);
  EXPECT_THAT(verdict(3, 1).wrong, ElementsAre(testing::HasSubstr("held under power")));
  EXPECT_THAT(verdict(3, 1).unclear, testing::SizeIs(1));
  EXPECT_FALSE(verdict(3, 1).stood_anyway);
  EXPECT_FALSE(verdict(2, 1, true, "unexpected contact: slew").stood_anyway) << "another joint's";
  EXPECT_TRUE(verdict(2, 1, true, "step failed: touched something (see whether the slew is free), in step press").stood_anyway);
  EXPECT_TRUE(verdict(2, 1, false).stood_anyway) << "it does not hold the arm: told as a contact all the same";
  EXPECT_THAT(verdict(2, 1, false).unclear, IsEmpty());
  EXPECT_FALSE(verdict(3, 1, false).stood_anyway);
  EXPECT_THAT(verdict(20, 10).wrong, IsEmpty()) << "of a drive that counts finer";
  const auto with = [](const char* other) {
    Seen seen = Stopping{.force_n = 0}.seen();
    seen.told_to_go[2] = {1000, 1002};
    Ending ending = failed("unexpected contact: elbow");
    ending.holds = true;
    Situation situation = situation_of(cause_of("following elbow"), cause_of(other));
    situation.units_per_count.fill(1);
    return judge(seen, situation, ending);
  };
  EXPECT_TRUE(with("panel_submit_fails").stood_anyway) << "what else fails moves nothing";
  EXPECT_FALSE(with("following shoulder").stood_anyway) << "two that seized";
  EXPECT_THAT(verdict(21, 10).wrong, testing::SizeIs(1));
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
