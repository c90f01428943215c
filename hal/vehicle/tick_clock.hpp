// The control thread's beat: absolute sleeps on CLOCK_MONOTONIC, on a grid that does not drift and that no jump of the wall clock moves.
#pragma once

#include <cstdint>

#include "hal/vehicle/latency_histogram.hpp"
#include "hal/vehicle/tick_grid.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

// CLOCK_MONOTONIC.
Time monotonic_now();
// Processor time of the calling thread. Kernels that account by the timer's ticks (User Mode Linux) have it in steps of those.
Time thread_time_now();
// Sleeps until `t` on CLOCK_MONOTONIC; returns at once when it is past. Signals do not shorten it.
void sleep_until(Time t);

// For tests on machines that do not keep time: from now on both of the above go `factor` times slower than the clock, and none reads more than `longest_step`
// after the one before it, on any thread: while the machine stands still, time does. Nor does time go on by more than `longest_step` past the end of a thread's
// sleep, or past its hold_time_for_me(), before the thread had its turn. Duration(): as the clock goes. Before threads are started.
void slow_time_down(int factor, Duration longest_step = {});
// The calling thread is due at `due`, and again whenever it calls this or sleep_until(), up to its end: it must, or time stands still for all.
void hold_time_for_me(Time due);

class TickClock {
 public:
  explicit TickClock(Duration period) : grid_(period) {}

  // The first tick is a period from now.
  void start();
  // Blocks until the next tick and returns its time on the grid. What a late thread leaves out: TickGrid::wake().
  Time wait();
  Time next() const { return grid_.next(); }

  std::uint64_t missed() const { return grid_.left_out(); }
  const LatencyHistogram& lateness() const { return lateness_; }  // of waking up

 private:
  TickGrid grid_;
  LatencyHistogram lateness_;
};

}  // namespace lf::hal
