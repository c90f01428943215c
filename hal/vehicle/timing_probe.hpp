// Times the core's work by this machine's clocks: how long it took, and the processor time in it.
#pragma once

#include "hal/vehicle/latency_histogram.hpp"
#include "hal/vehicle/tick_clock.hpp"

namespace lf::hal {

class TimingProbe {
 public:
  void begin() {
    began_ = monotonic_now();
    thread_began_ = thread_time_now();
  }
  void end() {
    worked_.add(thread_time_now() - thread_began_);
    took_.add(monotonic_now() - began_);
  }
  const LatencyHistogram& took() const { return took_; }
  const LatencyHistogram& worked() const { return worked_; }

 private:
  Time began_, thread_began_;
  LatencyHistogram took_, worked_;
};

}  // namespace lf::hal
