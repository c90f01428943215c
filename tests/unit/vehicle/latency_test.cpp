#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/latency_histogram.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "hal/vehicle/tick_grid.hpp"
#include "hal/vehicle/timing_probe.hpp"

namespace lf::hal {
namespace {

TEST(LatencyHistogram, PercentilesAreWithinABucketOfTheSortedSamples) {
  constexpr unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::lognormal_distribution<double> us(4, 1.5);
  LatencyHistogram histogram;
  std::vector<double> samples;
  for (int i = 0; i < 20'000; ++i) {
    samples.push_back(std::floor(us(random) * 1000) / 1000);
    histogram.add(Duration::from_ns(std::llround(samples.back() * 1000)));
  }
  std::sort(samples.begin(), samples.end());
  for (const double p : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = samples[static_cast<std::size_t>(std::ceil(p * 20'000)) - 1];
    EXPECT_GE(histogram.percentile_us(p), std::min(exact, 1.0)) << p;
    if (exact > 1) {
      EXPECT_GE(histogram.percentile_us(p), exact * 0.9999) << p;
      EXPECT_LE(histogram.percentile_us(p), exact * 1.07) << p;
    }
  }
  EXPECT_DOUBLE_EQ(histogram.max_us(), samples.back());
  EXPECT_EQ(histogram.count(), 20'000u);
}

TEST(LatencyHistogram, EveryBucketEndsWhereTheNextBegins) {
  for (std::size_t i = 0; i + 1 < LatencyHistogram::bucket_count; ++i) {
    LatencyHistogram histogram;
    const double edge_ns = LatencyHistogram::upper_edge_us(i) * 1000;
    if (edge_ns != std::floor(edge_ns)) continue;
    histogram.add(Duration::from_ns(static_cast<std::int64_t>(edge_ns)));
    EXPECT_EQ(histogram.bucket(i), 0u) << i;
    EXPECT_EQ(histogram.bucket(i + 1), 1u) << i;
  }
}

TEST(LatencyHistogram, TakesWhatIsTooShortAndTooLong) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile_us(0.5), 0);
  histogram.add(Duration::from_ns(-5));
  histogram.add(Duration::from_ns(0));
  histogram.add(Duration::from_s(100));
  EXPECT_EQ(histogram.count(), 3u);
  EXPECT_DOUBLE_EQ(histogram.percentile_us(1), 1e8);
}

// Wakes the grid's thread late by every hundredth of a period up to four, then in time. What is sent follows the waking at once.
TEST(TickGrid, TicksAreNeverCloserThanHalfAPeriod) {
  constexpr Duration period = Duration::from_ms(4);
  for (int late = 0; late <= 400; ++late) {
    SCOPED_TRACE(late);
    TickGrid grid(period);
    const Time origin = Time::from_s(1);
    grid.start(origin);
    Time sent = origin;
    for (int turn = 0; turn < 5; ++turn) {
      const Time now = grid.next() + (turn == 1 ? period * late / 100 : Duration{});
      const Time tick = grid.wake(now);
      EXPECT_EQ((tick - origin).ns() % period.ns(), 0);
      EXPECT_LE(tick, now);
      EXPECT_LT(now - tick, period);
      EXPECT_GE(now - sent, period / 2);
      sent = now;
    }
    // Of the grid's instants from the first to the last, five became ticks.
    const std::int64_t instants = (grid.next() - origin).ns() / period.ns() - 1;
    EXPECT_EQ(grid.left_out(), static_cast<std::uint64_t>(instants - 5));
  }
}

TEST(TickGrid, ATickThatIsALittleLateIsFollowedByTheNextOne) {
  TickGrid grid(Duration::from_ms(4));
  grid.start(Time{});
  EXPECT_EQ(grid.wake(Time{} + Duration::from_ms(6)), Time{} + Duration::from_ms(4));
  EXPECT_EQ(grid.next(), Time{} + Duration::from_ms(8));
  EXPECT_EQ(grid.left_out(), 0u);
  EXPECT_EQ(grid.wake(Time{} + Duration::from_us(10'001)), Time{} + Duration::from_ms(8));
  EXPECT_EQ(grid.next(), Time{} + Duration::from_ms(16));
  EXPECT_EQ(grid.left_out(), 1u);
}

TEST(TickClock, KeepsItsGridAndCountsWhatItMissed) {
  TickClock clock(Duration::from_ms(2));
  clock.start();
  const Time first = clock.wait();
  const Time second = clock.wait();
  EXPECT_EQ((second - first).ns() % 2'000'000, 0);
  const std::uint64_t before = clock.missed();
  sleep_until(second + Duration::from_ms(9));
  const Time late = clock.wait();
  EXPECT_GE(clock.missed() - before, 3u);
  EXPECT_EQ((late - first).ns() % 2'000'000, 0);
  EXPECT_GT(clock.wait(), late);
  EXPECT_EQ(clock.lateness().count(), 4u);
}

// A shared machine stands still for as long as it likes. What is tested on it is not told of that time.
TEST(SlowTime, StandsStillWithTheMachine) {
  constexpr int factor = 2;
  slow_time_down(factor, Duration::from_ms(10));
  const Time before = monotonic_now();
  const auto begun = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const Time after = monotonic_now();
  EXPECT_LE(after - before, Duration::from_ms(10));
  // A sleep is as long as it was asked to be, by the slow clock.
  sleep_until(after + Duration::from_ms(100));
  const auto took = std::chrono::steady_clock::now() - begun;
  EXPECT_GE(monotonic_now() - after, Duration::from_ms(100));
  EXPECT_GE(took, std::chrono::milliseconds(200 + factor * 100));
  slow_time_down(1);
}

// Nor of the time in which another of its threads got no processor.
TEST(SlowTime, WaitsForAThreadThatIsDue) {
  slow_time_down(1, Duration::from_ms(10));
  std::atomic<bool> had_its_turn{false};
  const Time due = monotonic_now() + Duration::from_ms(50);
  std::thread late([&] {
    hold_time_for_me(due);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_LE(monotonic_now(), due + Duration::from_ms(10));
    had_its_turn = true;
  });
  sleep_until(due + Duration::from_ms(20));
  EXPECT_TRUE(had_its_turn);
  late.join();
  // At its end it is no longer waited for.
  const Time after = monotonic_now();
  sleep_until(after + Duration::from_ms(100));
  EXPECT_GE(monotonic_now(), after + Duration::from_ms(100));
  slow_time_down(1);
}

TEST(TimingProbe, TellsWorkFromWaiting) {
  TimingProbe probe;
  probe.begin();
  sleep_until(monotonic_now() + Duration::from_ms(40));
  probe.end();
  EXPECT_GE(probe.took().max_us(), 40'000);
  EXPECT_LT(probe.worked().max_us(), 20'000);

  probe.begin();
  for (const Time end = thread_time_now() + Duration::from_ms(30); thread_time_now() < end;) {
  }
  probe.end();
  EXPECT_GE(probe.worked().max_us(), 30'000);
  EXPECT_EQ(probe.took().count(), 2u);
  EXPECT_EQ(probe.worked().count(), 2u);
}

}  // namespace
}  // namespace lf::hal
