// The control thread's beat: absolute sleeps on CLOCK_MONOTONIC, on a grid that does not drift and that no jump of the wall clock moves.
#pragma once

#include <cstdint>

#include "hal/vehicle/latency_histogram.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

// CLOCK_MONOTONIC.
Time monotonic_now();
// Processor time of the calling thread. Kernels that account by the timer's ticks (User Mode Linux) have it in steps of those.
Time thread_time_now();
// Sleeps until `t` on CLOCK_MONOTONIC; returns at once when it is past. Signals do not shorten it.
void sleep_until(Time t);

// For tests on machines that do not keep time: from now on both of the above go `factor` times slower than the clock. Before threads are started.
void slow_time_down(int factor);

class TickClock {
 public:
  explicit TickClock(Duration period) : period_(period) {}

  // The first tick is a period from now.
  void start();
  // Blocks until the next tick and returns its time on the grid. After a stall the ticks that have passed altogether are left out and counted: what they
  // would have sent is stale.
  Time wait();
  Time next() const { return next_; }

  std::uint64_t missed() const { return missed_; }
  const LatencyHistogram& lateness() const { return lateness_; }  // of waking up

 private:
  Duration period_;
  Time next_;
  std::uint64_t missed_ = 0;
  LatencyHistogram lateness_;
};

}  // namespace lf::hal
