// Missions from boot to park with everything simulated, held to the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/heap_guard/heap_guard.hpp"
#include "tests/hil/mission_run.hpp"

namespace lf::test {
namespace {

constexpr double target_rad = pi / 2;

struct Seeded {
  const char* scenario;
  std::uint64_t seed;
  std::string set;
  const char* name;
};

void PrintTo(const Seeded& c, std::ostream* out) { *out << c.scenario << ", seed " << c.seed; }

class WholeMission : public testing::TestWithParam<Seeded> {};

TEST_P(WholeMission, TurnsTheValvePressesEachButtonOnceAndTouchesNothingElse) {
  const Seeded& c = GetParam();
  const MissionRun run = run_mission(c.scenario, c.seed, {c.set});
  SCOPED_TRACE(describe(run));
  EXPECT_TRUE(run.outcome.success);
  EXPECT_NEAR(run.valve_rad, target_rad, rad_from_deg(3));
  for (const std::uint32_t presses : run.presses) EXPECT_EQ(presses, 1u);
  EXPECT_TRUE(run.contacts.unintended.empty());
  EXPECT_LE(run.contacts.peak_force_n, 150);
  EXPECT_FALSE(run.laser_on_at_end);
  EXPECT_FALSE(run.lamps_on_at_end);
  EXPECT_EQ(run.refused_frames, 0u);
  if (hal::HeapGuard::available()) {
    EXPECT_EQ(run.heap_calls, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Seeds, WholeMission,
    testing::Values(Seeded{"default", 1, "lamps.lit=either", "Default1"}, Seeded{"turbid", 7, "lamps.lit=false", "TurbidInTheDark7"},
                    // Six joints with a spherical wrist, and with three parallel axes.
                    Seeded{"oberon7", 1, "lamps.lit=true", "Oberon1"}, Seeded{"ur5", 2, "lamps.lit=true", "Ur2"},
                    // Seven joints: one stands beyond half a turn, the range of another leaves out angle 0.
                    Seeded{"ur5", 1, "machine=" LANTERNFISH_TEST_DATA "/arms/seven_joints/seven_joints.yaml", "SevenJoints1"}),
    [](const testing::TestParamInfo<Seeded>& test) { return std::string(test.param.name); });

// Five joints, the last of which swings the hand.
TEST(WithoutARoll, AnArmPressesEachButtonOnceAndTouchesNothingElse) {
  const MissionRun run = run_mission("predator", 1, {});
  SCOPED_TRACE(describe(run));
  EXPECT_TRUE(run.outcome.success);
  for (const std::uint32_t presses : run.presses) EXPECT_EQ(presses, 1u);
  EXPECT_TRUE(run.contacts.unintended.empty());
  EXPECT_LE(run.contacts.peak_force_n, 150);
  EXPECT_EQ(run.refused_frames, 0u);
  if (hal::HeapGuard::available()) {
    EXPECT_EQ(run.heap_calls, 0u);
  }
}

struct Rate {
  const char* syncs;
  const char* name;
};

class FrameRate : public testing::TestWithParam<Rate> {};

// As often, and as seldom, as the camera may be triggered: no image is lost, nothing overflows, and the handle is found and turned.
TEST_P(FrameRate, AtTheEndsOfItsRangeServesAMission) {
  ScanStats at_end;
  const Meddle look = [&](Time, Controller& controller, hal::SimPlatform&) { at_end = controller.mission().scan_stats(); };
  const MissionRun run = run_mission("turn_only", 1, {std::string("mission.camera_syncs=") + GetParam().syncs}, 2, look);
  SCOPED_TRACE(describe(run));
  EXPECT_TRUE(run.outcome.success);
  EXPECT_NEAR(run.valve_rad, target_rad, rad_from_deg(3));
  EXPECT_EQ(at_end.points_overflowed, 0u);
  EXPECT_EQ(at_end.points_no_joints, 0u);
  EXPECT_EQ(at_end.images_missing, 0u);
  EXPECT_LE(at_end.images_refused, 2u) << "the last one of each sweep, over which the laser goes off";
  EXPECT_GT(at_end.points, 50'000u);
}

INSTANTIATE_TEST_SUITE_P(Ends, FrameRate, testing::Values(Rate{"2", "At125Hz"}, Rate{"20", "At12Hz"}),
                         [](const testing::TestParamInfo<Rate>& test) { return std::string(test.param.name); });

// Five images of the sweep are lost, every sixth one: with a background every fifth frame one of them is a background.
TEST(LostBackground, IsBridgedByTheOneBeforeIt) {
  std::string faults;
  for (const char* after_s : {"8.00", "8.24", "8.48", "8.72", "8.96"})
    faults += std::string(faults.empty() ? "" : ", ") + "{at_step: scan, after_s: " + after_s + ", kind: image_lost}";
  const MissionRun run = run_mission("turn_only", 1, {"faults=[" + faults + "]"}, 2);
  SCOPED_TRACE(describe(run));
  EXPECT_TRUE(run.outcome.success);
  EXPECT_NEAR(run.valve_rad, target_rad, rad_from_deg(3));
  const auto lost = std::count_if(run.events.begin(), run.events.end(), [](const Event& event) {
    return event.kind == Event::Kind::fault && event.fault == safety::Fault::image_lost;
  });
  EXPECT_EQ(lost, 5);
}

// Boot, deployment and the first pictures of the sweep: everything that could depend on threads is at work by then.
TEST(Digest, IsTheSameForOneAndTwoRenderThreadsAndForARepetition) {
  const std::vector<std::string> short_run{"time_limit_s=12"};
  const MissionRun once = run_mission("default", 3, short_run, 1);
  const MissionRun again = run_mission("default", 3, short_run, 1);
  const MissionRun two_threads = run_mission("default", 3, short_run, 2);
  EXPECT_EQ(once.digest, again.digest);
  EXPECT_EQ(once.digest, two_threads.digest);
  EXPECT_NE(once.digest, run_mission("default", 4, short_run, 1).digest);
}

}  // namespace
}  // namespace lf::test
