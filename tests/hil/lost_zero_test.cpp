// A zero that a drive has lost leaves the homing file, whatever else the commissioner is at.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "tests/hil/commissioner_at_work.hpp"

namespace lf::test {
namespace {

using hal::Commissioning;
using Bench = CommissioningBench;

// A full disk, say. It is tried again: whoever frees the disk need not think of the zeros.
TEST(ALostZero, LeavesTheFileAsSoonAsThatCanBeWritten) {
  AtWork work(somewhere[4]);
  const std::filesystem::path in_the_way = work.folder / "homing.yaml.partial";
  ASSERT_TRUE(std::filesystem::create_directory(in_the_way));
  hal::ControlReport report;
  report.zeros_lost = only_jaw;
  const auto gone = [&] {
    work.commissioner->hear(report);
    return !config::read_homing_file(work.folder / "homing.yaml", {}).known[4];
  };
  for (int i = 0; i < 300; ++i) {
    EXPECT_FALSE(gone());
    work.commissioner->step();
    usleep(1000);
  }
  std::filesystem::remove(in_the_way);
  EXPECT_TRUE(work.wait_for(gone));
}

// The report that is the newest when the cores were exchanged is still of the core before, to which the zero was lost: it took the new one out of the file.
TEST(ALostZero, ThatWasFoundAgainStaysInTheFile) {
  AtWork work(somewhere[4]);
  hal::ControlReport report;
  report.zeros_lost = only_jaw;
  const auto known = [&] { return work.file().known[4]; };
  const auto forgotten = [&] {
    work.commissioner->hear(report);
    return !known();
  };
  ASSERT_TRUE(work.wait_for(forgotten));
  ASSERT_NO_FATAL_FAILURE(work.commission_jaw());
  for (int i = 0; i < 200; ++i) {
    ASSERT_FALSE(forgotten());
    work.commissioner->step();
    usleep(1000);
  }
  EXPECT_EQ(work.commissioner->unknown_joints(), "");
  report.cores_taken = 1;
  report.commissionings_ended = 1;
  EXPECT_TRUE(work.wait_for(forgotten)) << "lost once more";
}

// Found, written as good, and lost again at the next power-up, before the stop's reset: it stayed in the file since it had been lost before as well.
TEST(ALostZero, ThatIsLostAgainLeavesTheFileWhileTheNewCoreWaits) {
  AtWork work(somewhere[4]);
  hal::ControlReport report;
  report.zeros_lost = only_jaw;
  ASSERT_TRUE(work.wait_for([&] {
    work.commissioner->hear(report);
    return !work.file().known[4];
  }));
  Bench bench(somewhere);
  Commissioning* lent = work.begin(only_jaw);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent);
  const std::unique_ptr<Controller> core = work.end(lent);
  ASSERT_NE(core, nullptr);
  ASSERT_TRUE(work.file().known[4]);
  work.commissioner->hear(report);
  for (int i = 0; i < 100; ++i) {
    work.commissioner->step();
    usleep(1000);
  }
  EXPECT_TRUE(work.file().known[4]) << "a report from before it was found";
  report.commissionings_ended = 1;
  EXPECT_TRUE(work.wait_for([&] {
    work.commissioner->hear(report);
    return !work.file().known[4];
  }));
  EXPECT_EQ(work.commissioner->unknown_joints(), "jaw");
}

// Stopped before the zero was found, the core without it waits for its reset, and meanwhile a drive loses its position at power-up. The file kept that zero.
TEST(ALostZero, LeavesTheFileWhileACoreWaitsForItsReset) {
  Bench bench(somewhere);
  AtWork work(somewhere[4]);
  Commissioning* lent = work.begin(only_jaw, true);
  ASSERT_NE(lent, nullptr);
  bench.run(*lent, [&] { return lent->state() == Commissioning::State::seeking; });
  ASSERT_NE(work.end(lent), nullptr);
  hal::ControlReport report;
  report.commissionings_ended = 1;
  report.zeros_lost[2] = true;
  EXPECT_TRUE(work.wait_for([&] {
    work.commissioner->hear(report);
    return !work.file().known[2];
  }));
  EXPECT_TRUE(work.commissioner->busy()) << "it still waits";
  EXPECT_EQ(work.commissioner->unknown_joints(), "elbow, jaw");
  ASSERT_TRUE(work.take_over());
  EXPECT_EQ(work.commissioner->unknown_joints(), "elbow, jaw");
}

}  // namespace
}  // namespace lf::test
