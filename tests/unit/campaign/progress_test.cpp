#include "host_sim/campaign/progress.hpp"

#include <gtest/gtest.h>

#include "host_sim/campaign/utc_time.hpp"

namespace lf::campaign {
namespace {

TEST(Progress, TheTimeLeftIsThatOfTheRunsFlown) {
  Progress progress(50, "run", false, 1000);
  EXPECT_EQ(progress.state(1010), "0 of 50 runs");
  for (int i = 0; i < 10; ++i) progress.ended(i == 3);
  EXPECT_EQ(progress.state(1050), "10 of 50 runs, 1 failed, about 3 min 20 s left");  // 5 s a run, 40 to go
  for (int i = 0; i < 40; ++i) progress.ended(false);
  EXPECT_EQ(progress.state(1300), "50 of 50 runs, 1 failed");
}

TEST(Progress, WithoutATerminalThereIsALineAtOnceAndOneAMinute) {
  Progress progress(3, "run", false, 0);
  EXPECT_EQ(progress.tick(0), "0 of 3 runs\n");
  EXPECT_EQ(progress.tick(59), "");
  progress.ended(false);
  EXPECT_EQ(progress.tick(60), "1 of 3 runs, about 2 min 00 s left\n");
  EXPECT_EQ(progress.tick(61), "");
  EXPECT_EQ(progress.clear(), "");
}

TEST(Progress, OnATerminalOneLineIsWrittenAnew) {
  Progress progress(1, "row", true, 0);
  EXPECT_EQ(progress.tick(0), "\r0 of 1 row\x1b[K");
  EXPECT_EQ(progress.tick(0.5), "");
  EXPECT_EQ(progress.tick(1), "\r0 of 1 row\x1b[K");
  EXPECT_EQ(progress.clear(), "\r\x1b[K");
  EXPECT_EQ(progress.clear(), "");
  EXPECT_EQ(progress.tick(1.2), "\r0 of 1 row\x1b[K");  // back after the other line
}

TEST(Progress, NothingIsSaidOfNothing) { EXPECT_EQ(Progress(0, "run", true, 0).tick(0), ""); }

TEST(Progress, DurationsAreInTheirOwnUnit) {
  EXPECT_EQ(duration_text(0.4), "0 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(duration_text(7500), "2 h 05 min");
  EXPECT_EQ(duration_text(-5), "0 s");
}

TEST(Progress, AMomentIsInUtc) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(utc_text(1'000'000'000), "2001-09-09T01:46:40Z");
}

}  // namespace
}  // namespace lf::campaign
