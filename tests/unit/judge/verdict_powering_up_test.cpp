// The judge against runs made by hand: causes that come before any drive runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/judge/verdict.hpp"
#include "tests/unit/judge/stopping.hpp"

namespace lf::judge {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

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

TEST(VerdictPoweringUp, PoweringUpThatHadToEndMovesNothing) {
  EXPECT_THAT(powering_up("estop", 0), IsEmpty());
  EXPECT_THAT(powering_up("estop", 200), testing::Contains("jaw moves from 1.00 to 1.20 s although powering up had to end"));
}

// The others are enabled while a drive's fault is reset.
TEST(VerdictPoweringUp, ADriveThatRunsOffBesideOneInFaultHasTheTimeOfAStop) {
  EXPECT_THAT(powering_up("overcurrent elbow", 1100), IsEmpty());
  EXPECT_THAT(powering_up("overcurrent elbow", 1300), ElementsAre("jaw moves from 1.00 to 2.30 s although powering up had to end"));
}

TEST(VerdictPoweringUp, AFaultThatComesWhenTheDrivesRunAlreadyStopsThem) {
  EXPECT_THAT(powering_up("estop", 112, 1.09), IsEmpty());
  EXPECT_THAT(powering_up("estop", 150, 1.09), ElementsAre("still told to run 50 ms after the report"));
}

// The report came at 0.993 s, and has 12 ms: enabling was on its way, and no farther.
TEST(VerdictPoweringUp, WhatIsEnabledBeforeTheReportIsDueMayStop) {
  EXPECT_THAT(powering_up("estop", 40, 0.983), IsEmpty());
  EXPECT_THAT(powering_up("estop", 200, 0.983), testing::Contains("jaw moves from 1.00 to 1.20 s although powering up had to end"));
  EXPECT_THAT(powering_up("estop", 40, 0.970), testing::Contains("jaw moves from 1.00 to 1.04 s although powering up had to end"));
}

// Its drives get power at 1 s.
TEST(VerdictPoweringUp, AChainThatOpensBeforePowerLeavesEveryDriveWithoutIt) {
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
TEST(VerdictPoweringUp, PowerWhileADrivesFaultIsResetEndsWithAnotherMaster) {
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

}  // namespace
}  // namespace lf::judge
