// Which instants of a grid become ticks when the thread wakes up late. Reads no clock.
#pragma once

#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf::hal {

class TickGrid {
 public:
  explicit TickGrid(Duration period) : period_(period) {}

  // The first tick is a period after `now`.
  void start(Time now) { next_ = now + period_; }
  Time next() const { return next_; }

  // The thread woke up at `now` for the tick next(). Returns the last instant of the grid that is past. Those before it are left out and counted: what they
  // would have sent is stale. The following one is left out too when it is less than half a period away: two SYNCs in a burst reach a drive within one of
  // its interpolation periods, and it takes the second set-point for a jump.
  Time wake(Time now) {
    const std::int64_t passed = now < next_ ? 0 : (now - next_).ns() / period_.ns();
    const Time tick = next_ + period_ * passed;
    const std::int64_t too_close = tick + period_ - now < period_ / 2 ? 1 : 0;
    left_out_ += static_cast<std::uint64_t>(passed + too_close);
    next_ = tick + period_ * (1 + too_close);
    return tick;
  }

  std::uint64_t left_out() const { return left_out_; }

 private:
  Duration period_;
  Time next_;
  std::uint64_t left_out_ = 0;
};

}  // namespace lf::hal
