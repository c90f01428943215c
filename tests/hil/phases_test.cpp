// The phases that a run's record tells, from missions as they were flown.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "host_sim/app/observers/phase_observer.hpp"
#include "tests/hil/operator.hpp"

namespace lf::test {
namespace {

using mission::Step;

std::map<std::string, std::string> told_of(const Rig& rig) {
  record::RunDigest digest;
  const config::ErrorTexts texts;
  app::PhaseObserver observer(digest, texts, {});
  for (const Event& event : rig.events()) {
    Telemetry telemetry;
    telemetry.t = event.t;
    (void)telemetry.events.push_back(event);
    observer.on_telemetry(telemetry);
  }
  std::map<std::string, std::string> outcomes;
  for (const record::PhaseRecord& phase : observer.phases()) outcomes[phase.name] = phase.outcome;
  return outcomes;
}

TEST(ThePhaseThatIsQuickStopped, IsToldAsFailed) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::turn)) << rig.story();
  rig.devices().set_estop_closed(false);
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  ASSERT_EQ(rig.step_now(), Step::stopped) << rig.story();
  auto told = told_of(rig);
  EXPECT_EQ(told["deploy"], "done");
  EXPECT_EQ(told["scan"], "done");
  EXPECT_EQ(told["turn_valve"], "failed");
}

// The still's picture is lost and taken again; the stop comes meanwhile.
TEST(ThePhaseThatIsQuickStopped, IsNotToldAsRetriedEither) {
  for (const bool stops : {false, true}) {
    Rig rig(turn_only());
    rig.start();
    ASSERT_TRUE(rig.run_to(Step::look)) << rig.story();
    rig.sight().lose_images(1);
    while (rig.count(safety::Fault::image_lost) == 0 && rig.now().s() < 120) rig.step();
    rig.step();
    if (stops) rig.devices().set_estop_closed(false);
    ASSERT_TRUE(rig.run_to_end()) << rig.story();
    EXPECT_EQ(told_of(rig)["scan"], stops ? "failed" : "retried") << rig.story();
  }
}

TEST(ThePhaseThatAnAbortEnds, IsToldAsAborted) {
  Rig rig(turn_only());
  rig.start();
  ASSERT_TRUE(rig.run_to(Step::deploy)) << rig.story();
  ASSERT_TRUE(give(rig, Command::abort));
  ASSERT_TRUE(rig.run_to_end()) << rig.story();
  EXPECT_EQ(told_of(rig)["deploy"], "aborted") << rig.story();
}

}  // namespace
}  // namespace lf::test
