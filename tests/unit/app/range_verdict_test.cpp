#include "host_sim/app/range_verdict.hpp"

#include <gtest/gtest.h>

#include "host_sim/judge/truth.hpp"
#include "shared/input_error.hpp"

namespace lf::app {
namespace {

const RangeRow far_panel{"panel.ahead_m 0.7", "panel.ahead_m", {"panel.ahead_m=0.7"}, 1, false};

record::RunResult succeeded() {
  record::RunResult run;
  run.success = true;
  return run;
}

record::RunResult failed(const std::string& reason) {
  record::RunResult run;
  run.failure = record::FailureRecord{"scan", reason};
  run.contact = {};
  return run;
}

RangeResult refused(const std::string& text) {
  return verdict_of(
      far_panel, [&] { throw InputError(text); }, succeeded);
}

RangeResult flown(const std::string& reason) {
  return verdict_of(
      far_panel, [] {}, [&] { return failed(reason); });
}

TEST(RangeVerdict, ARefusalHasToNameADrawnKey) {
  const RangeResult named = refused("default.yaml: the valve is out of the arm's reach. 'panel.ahead_m' is 0.7");
  EXPECT_EQ(named.verdict, "refused");
  EXPECT_EQ(named.set, "panel.ahead_m=0.7");
  EXPECT_EQ(named.reason, "default.yaml: the valve is out of the arm's reach. 'panel.ahead_m' is 0.7");
  const RangeResult unnamed = refused("default.yaml: the laser cannot be swept over the whole panel with 'mission.docking_m' at 0.02");
  EXPECT_EQ(unnamed.verdict, "unnamed");
  EXPECT_EQ(
      unnamed.reason,
      "refused without naming the key: default.yaml: the laser cannot be swept over the whole panel with 'mission.docking_m' at 0.02");
}

TEST(RangeVerdict, OfEightKeysOneIsNamedByTheRefusal) {
  const RangeRow many{"many 3", "many", {"water.ambient=2", "panel.ahead_m=0.7", "valve.detent_nm=1"}, 3, true};
  const auto refuse = [](const char* text) { return [text] { throw InputError(text); }; };
  EXPECT_EQ(verdict_of(many, refuse("out of reach. 'panel.ahead_m' is 0.7"), succeeded).verdict, "refused");
  EXPECT_EQ(verdict_of(many, refuse("out of reach. 'panel.down_m' is 0.7"), succeeded).verdict, "unnamed");
}

// What a check should have refused, and did not: whatever it names.
TEST(RangeVerdict, ARefusalOutOfTheMissionItselfIsUnsafe) {
  const RangeResult late = verdict_of(
      far_panel, [] {}, []() -> record::RunResult { throw InputError("'panel.ahead_m' is 0.7"); });
  EXPECT_EQ(late.verdict, "unsafe");
  EXPECT_EQ(late.reason, "refused only when the mission had begun: 'panel.ahead_m' is 0.7");
}

TEST(RangeVerdict, AMissionIsJudgedByItsReasonAndItsForces) {
  EXPECT_EQ(verdict_of(
                far_panel, [] {}, succeeded)
                .verdict,
            "success");
  const RangeResult safe = flown("step failed: out of reach (Dock nearer.), in step grip");
  EXPECT_EQ(safe.verdict, "safe");
  EXPECT_EQ(safe.reason, "scan: step failed: out of reach (Dock nearer.), in step grip");
  EXPECT_EQ(flown("panel vision late, in step scan").verdict, "unnamed");
  EXPECT_EQ(flown("step failed: out of reach; the arm moves or has power 3 s after the end").verdict, "unsafe");
  const auto lied = [] {
    record::RunResult run = failed("step failed: out of reach");
    run.false_success = true;
    return run;
  };
  EXPECT_EQ(verdict_of(
                far_panel, [] {}, lied)
                .verdict,
            "unsafe");
  const auto forced = [] {
    record::RunResult run = failed("step failed: out of reach");
    run.contact.peak_force_n = judge::contact_limit_n + 1;
    return run;
  };
  EXPECT_EQ(verdict_of(
                far_panel, [] {}, forced)
                .verdict,
            "unsafe");
}

}  // namespace
}  // namespace lf::app
