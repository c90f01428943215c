// Real time, a millisecond a step: when the next step is due, how late it began, and what to say when the machine does not keep up.
//
// A step that begins late is caught up. More than `backlog` behind, the world stands still for the rest: that time is lost, and counted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/messages/time.hpp"

namespace lf::serve {

struct PaceStats {
  std::uint64_t steps = 0;
  std::uint64_t late_1_ms = 0;  // steps that began over 1 ms late
  std::uint64_t late_4_ms = 0;  // over a SYNC period
  Duration worst;               // lateness
  Duration lost;                // time that the world stood still
  std::uint64_t seconds = 0;
  std::uint64_t seconds_not_held = 0;  // with a step over a SYNC period late, or time lost

  bool held() const { return late_4_ms == 0 && lost == Duration{}; }
};

class Pace {
 public:
  static constexpr Duration step = Duration::from_ms(1);
  static constexpr Duration tolerated = Duration::from_ms(4);  // the drives' set points come once a SYNC period
  static constexpr Duration backlog = Duration::from_ms(100);  // a heartbeat

  explicit Pace(Time start) : origin_(start), second_end_(start + Duration::from_ms(1000)) {}

  // When the next step is due, on the clock, and as simulated time.
  Time due() const { return origin_ + simulated_ + step; }
  Time simulated() const { return Time{} + simulated_; }
  // Simulated time of an instant on the clock; not before the last step, nor after the next.
  Time simulated_at(Time clock) const;
  // An instant of simulated time on the clock.
  Time clock_at(Time simulated) const { return origin_ + (simulated - Time{}); }

  // A step begins at `now`; returns the simulated time that it leads to.
  Time begin(Time now);
  // Once a second, when real time was not held in it: what to say. Call after each step.
  std::optional<std::string> second_report(Time now);

  const PaceStats& stats() const { return stats_; }

 private:
  Time origin_;  // the clock's instant of simulated time 0, moved by what is lost
  Duration simulated_;
  Time second_end_;
  PaceStats stats_;
  Duration second_worst_, second_lost_;
  std::uint64_t second_late_ = 0, second_steps_ = 0;
};

}  // namespace lf::serve
