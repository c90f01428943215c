// The judge against runs made by hand: several causes, and drives that cannot be told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/judge/verdict.hpp"
#include "tests/unit/judge/stopping.hpp"

namespace lf::judge {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(VerdictOfSeveral, TwoCausesThatNoFrameToldAreStillAStop) {
  Seen seen = Stopping{.stop_ms = 900}.seen();
  seen.fault_reported_s.reset();
  Situation situation = situation_of(cause_of("overcurrent elbow"));
  situation.causes.push_back(cause_of("hot slew"));
  situation.begins_s.push_back(0.3);
  EXPECT_FALSE(judge(seen, situation, failed("drive fault: elbow")).wrong.empty());
}

TEST(VerdictOfSeveral, AShutDownMayHaltOnItsPathFirst) {
  Seen seen = Stopping{.stop_ms = 400}.seen();
  seen.fault_reported_s.reset();
  EXPECT_THAT(judge(seen, situation_of(cause_of("shut_down_ordered")), failed("shut down")).wrong, IsEmpty());
}

TEST(VerdictOfSeveral, AnEmergencyStopAfterAShutDownHasItsOwnDeadline) {
  const Situation situation = situation_of(cause_of("shut_down_ordered"), cause_of("estop"));
  const auto wrong = [&](int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.chain_open_s = seen.fault_reported_s = 0.2;
    return judge(seen, situation, failed("emergency stop: the chain is open")).wrong;
  };
  EXPECT_THAT(wrong(112), IsEmpty());
  EXPECT_THAT(wrong(114), ElementsAre("still told to run 14 ms after the report"));
}

TEST(VerdictOfSeveral, ADriveFaultAfterAShutDownHasItsOwnDeadline) {
  const Situation situation = situation_of(cause_of("shut_down_ordered"), cause_of("overcurrent elbow"));
  const auto wrong = [&](int stop_ms) {
    Seen seen = Stopping{.stop_ms = stop_ms}.seen();
    seen.fault_reported_s = 0.2;
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  EXPECT_THAT(wrong(112), IsEmpty());
  EXPECT_THAT(wrong(114), ElementsAre("still told to run 14 ms after the report"));
}

TEST(VerdictOfSeveral, ALaterCauseDoesNotExcuseALateReactionToTheFirst) {
  Seen seen = Stopping{.stop_ms = 40}.seen();
  seen.chain_open_s = seen.fault_reported_s = 0.1;
  EXPECT_THAT(judge(seen, situation_of(cause_of("estop"), cause_of("shut_down_ordered")), failed("emergency stop")).wrong,
              ElementsAre("still told to run 40 ms after the report"));
}

TEST(VerdictOfSeveral, AFaultThatNoFrameReportedHasNoDeadlineOfItsOwnBesideAnother) {
  Seen seen = Stopping{.stop_ms = 400}.seen();  // the halt was over before the drive noticed
  seen.fault_reported_s.reset();
  EXPECT_THAT(judge(seen, situation_of(cause_of("shut_down_ordered"), cause_of("hot elbow")), failed("shut down")).wrong, IsEmpty());
  EXPECT_THAT(judge(seen, situation_of(cause_of("hot elbow")), failed("drive fault: elbow")).wrong,
              testing::Contains("still told to run 410 ms after the report"))
      << "alone it counts from its beginning";
}

TEST(VerdictOfSeveral, AMasterThatIsCutOffIsJudgedByTheDrivesOwnStop) {
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

TEST(VerdictOfSeveral, AStopBeforeTheMasterIsCutOffHasToBeOnTheBusByThen) {
  Seen seen = Stopping{.stop_ms = 60}.seen();
  seen.chain_open_s = seen.fault_reported_s = 0.1;  // 90 ms before the cut
  EXPECT_THAT(judge(seen, situation_of(cause_of("estop"), cause_of("can_send_fails")), failed("emergency stop")).wrong,
              ElementsAre("still told to run 60 ms after the report"));
}

TEST(VerdictOfSeveral, AMasterThatHearsNothingIsNotBlamedForAReportItMissed) {
  Seen seen = Stopping{.stop_ms = 14}.seen();  // 24 ms after the receiving call began to fail
  seen.chain_open_s = seen.fault_reported_s = 0.095;
  Situation situation = situation_of(cause_of("can_receive_fails"), cause_of("estop"));
  situation.begins_s[1] = 0.094;
  EXPECT_THAT(judge(seen, situation, failed("emergency-stop chain unread")).wrong, IsEmpty());
  seen = Stopping{.stop_ms = 20}.seen();
  EXPECT_THAT(judge(seen, situation, failed("emergency-stop chain unread")).wrong, ElementsAre("still told to run 30 ms after the report"));
}

// NMT reaches it: 20 ms after it has not heeded a stop.
TEST(VerdictOfSeveral, ADriveThatLosesItsProcessDataIsToldByNmt) {
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
TEST(VerdictOfSeveral, ADriveThatLosesItsProcessDataAndIsCutOffStopsByItself) {
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

// Its motor stands.
TEST(VerdictOfSeveral, WhoIsPushedWindsUpItsGear) {
  const auto wrong = [](const std::string& other, double begins_s, float push_n, bool motor_turns) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 600; t < 900; ++t) {
      Moment& moment = seen.moments[t];
      moment.speed_rad_s[0] = 0.1f;
      moment.angle_rad[0] = 0.0001f * static_cast<float>(t - 600);
      moment.motor_rad[0] = motor_turns ? moment.angle_rad[0] : 0;
      moment.force_n = 80;
      moment.push_n = push_n;
    }
    Situation situation = situation_of(cause_of("overcurrent elbow"), cause_of(other));
    situation.begins_s[1] = begins_s;
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  const auto moves = ElementsAre(testing::ContainsRegex("slew moves 0.(79|80) s after the stop"));
  EXPECT_THAT(wrong("obstacle", 0.5, 80, false), IsEmpty());
  EXPECT_THAT(wrong("obstacle", 0.5, 80, true), moves);
  EXPECT_THAT(wrong("obstacle", 0.5, 0, false), moves) << "it touches something else";
  EXPECT_THAT(wrong("obstacle", 1.5, 80, false), moves) << "not yet";
  EXPECT_THAT(wrong("handle_breaks", 0.5, 80, false), moves);
}

// The motor stands from 200 ms on, the power goes at 298, and the push begins at 600.
TEST(VerdictOfSeveral, WhoIsPushedWithoutPowerGivesWayByAMilliradian) {
  const auto wrong = [](float by_rad, float push_n, std::size_t power_off_ms = 298, std::size_t still_from_ms = 200,
                        float settles_rad = 0) {
    constexpr std::size_t from_ms = 600;
    Seen seen = Stopping().seen();
    for (std::size_t t = 0; t < seen.moments.size(); ++t) {
      Moment& moment = seen.moments[t];
      const float earlier_rad = -0.0001f * static_cast<float>(std::min(t, still_from_ms));
      const float pushed_rad = t < from_ms ? 0 : std::min(by_rad, 0.0001f * static_cast<float>(t - from_ms));
      moment.motor_rad[0] = moment.angle_rad[0] = earlier_rad + pushed_rad + (t < 300 ? 0 : settles_rad);
      if (t >= from_ms && t < from_ms + 100) moment.force_n = moment.push_n = push_n;
      if (t < power_off_ms) moment.power |= 1;
    }
    Situation situation = situation_of(cause_of("overcurrent elbow"), cause_of("obstacle"));
    return judge(seen, situation, failed("drive fault: elbow")).wrong;
  };
  const auto moves = testing::Contains(testing::HasSubstr("slew moves"));
  EXPECT_THAT(wrong(0.0009f, 80), IsEmpty());
  EXPECT_THAT(wrong(0.0011f, 80), moves) << "too far";
  EXPECT_THAT(wrong(0.0009f, 0), moves) << "nothing pushes";
  EXPECT_THAT(wrong(0.0009f, 80, 700), moves) << "under power";
  EXPECT_THAT(wrong(0.0009f, 80, 298, 297), moves) << "it did not stand when its power went";
  EXPECT_THAT(wrong(0.0009f, 80, 298, 200, 0.003f), IsEmpty()) << "it settled before";
}

TEST(VerdictOfSeveral, AForceIsAForceWhateverPushes) {
  for (const char* cause : {"obstacle", "handle_breaks"}) {
    Seen seen = Stopping().seen();
    for (std::size_t t = 1000; t < 3000; ++t) seen.moments[t].force_n = 160;
    const Verdict verdict = judge(seen, situation_of(cause_of("overcurrent elbow"), cause_of(cause)), failed("drive fault: elbow"));
    EXPECT_THAT(verdict.wrong, ElementsAre("160 N of contact")) << cause;
  }
}

// The elbow hears no process data: it is restarted.
TEST(VerdictOfSeveral, ADriveThatIsRestartedLosesItsPowerALittleLater) {
  const auto wrong = [](int off_ms, const std::string& lost) {
    Seen seen = Stopping().seen();
    for (int t = 0; t < 3000; ++t) {
      JointBits& power = seen.moments[static_cast<std::size_t>(t)].power;
      power = static_cast<std::uint8_t>((power & ~0x04) | (t < 108 + 140 + off_ms ? 0x04 : 0));
      if (lost == "drop_frames tpdo elbow" && t >= 200) power &= 0x04;  // the others are heard, and stand
    }
    if (lost == "drop_frames tpdo elbow") seen.last_heard_s[2] = 0.19;
    return judge(seen, situation_of(cause_of("overcurrent slew"), cause_of(lost)), failed("drive fault: slew")).wrong;
  };
  EXPECT_THAT(wrong(210, "drop_frames rpdo elbow"), IsEmpty());
  EXPECT_THAT(wrong(230, "drop_frames rpdo elbow"), ElementsAre("power is off 0.23 s after standing without process data"));
  EXPECT_THAT(wrong(210, "drop_frames tpdo elbow"), ElementsAre("power is off 0.21 s after standing"));
}

// Nothing that our master sends arrives, and another one keeps the drives running: no software stops them.
TEST(VerdictOfSeveral, OnlyTheChainStopsWhatAnotherMasterHasTakenOver) {
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

// Nobody hears the other master, ours included: there is no stop to judge.
TEST(VerdictOfSeveral, AnotherMastersFrameThatIsLostOnItsWayStopsNobody) {
  const auto wrong = [](const char* lost) {
    Seen seen = Stopping{.stop_ms = 900}.seen();
    seen.fault_reported_s.reset();
    return judge(seen, situation_of(cause_of(lost), cause_of("foreign_rpdo elbow")), failed("step failed")).wrong;
  };
  EXPECT_THAT(wrong("drop_frames rpdo elbow"), IsEmpty());
  EXPECT_THAT(wrong("drop_frames rpdo slew"), testing::Not(IsEmpty())) << "another node's";
  EXPECT_THAT(wrong("drop_frames (one frame) rpdo elbow"), testing::Not(IsEmpty())) << "those that follow arrive";
}

TEST(VerdictOfSeveral, ADriveWhoseProcessDataAreLostBothWaysIsRestartedInItsTime) {
  const auto wrong = [](int off_ms, bool elbow_stands = false) {
    const Situation situation = situation_of(cause_of("drop_frames rpdo elbow"), cause_of("drop_frames tpdo elbow"));
    Stopping stopping{.stop_ms = 32};
    Seen seen = stopping.seen();
    seen.last_heard_s[2] = 0;
    const auto elbow = static_cast<std::uint8_t>(1u << 2);
    for (std::size_t i = 0; i < seen.moments.size(); ++i) {
      const bool before = static_cast<int>(i) < off_ms;
      const bool others = i < (elbow_stands ? 330 : 225);  // they are heard, and stand
      const auto powered = static_cast<std::uint8_t>(others ? seen.moments[i].power : 0);
      seen.moments[i].power = static_cast<std::uint8_t>(before ? powered | elbow : powered & ~elbow);
      if (!elbow_stands) continue;
      std::swap(seen.moments[i].speed_rad_s[1], seen.moments[i].speed_rad_s[2]);
      std::swap(seen.moments[i].angle_rad[1], seen.moments[i].angle_rad[2]);
      std::swap(seen.moments[i].motor_rad[1], seen.moments[i].motor_rad[2]);
    }
    return judge(seen, situation, failed("stale position: elbow")).wrong;
  };
  EXPECT_THAT(wrong(700), IsEmpty());
  EXPECT_THAT(wrong(700, true), IsEmpty()) << "the others brake as long, and only then a drive is told to go down";
  EXPECT_THAT(wrong(750), testing::Contains(testing::EndsWith("s after the stop of a drive that nothing reaches")))
      << "0.62 s; 0.15 of them are its ramp";
  EXPECT_THAT(wrong(900), testing::Contains(testing::EndsWith("s after the stop of a drive that nothing reaches")));
}

}  // namespace
}  // namespace lf::judge
