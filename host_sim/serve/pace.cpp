#include "host_sim/serve/pace.hpp"

#include <algorithm>
#include <cstdio>

namespace lf::serve {

namespace {

double ms(Duration d) { return 1e3 * d.s(); }

}  // namespace

Time Pace::simulated_at(Time clock) const {
  const Duration since = clock - origin_;
  return Time{} + std::clamp(since, simulated_, simulated_ + step);
}

Time Pace::begin(Time now) {
  const Duration late = std::max(now - due(), Duration{});
  if (late > backlog) {
    const Duration lost = late - backlog;
    origin_ = origin_ + lost;
    stats_.lost = stats_.lost + lost;
    second_lost_ = second_lost_ + lost;
  }
  simulated_ = simulated_ + step;
  ++stats_.steps;
  ++second_steps_;
  if (late > step) ++stats_.late_1_ms;
  if (late > tolerated) {
    ++stats_.late_4_ms;
    ++second_late_;
  }
  stats_.worst = std::max(stats_.worst, late);
  second_worst_ = std::max(second_worst_, late);
  return simulated();
}

std::optional<std::string> Pace::second_report(Time now) {
  if (now < second_end_) return std::nullopt;
  std::optional<std::string> report;
  ++stats_.seconds;
  if (second_late_ > 0 || second_lost_ > Duration{}) {
    ++stats_.seconds_not_held;
    char text[160];
    std::snprintf(text, sizeof text, "at %.0f s not in real time: %llu of %llu steps over 4 ms late, up to %.1f ms; %.1f ms lost",
                  simulated_.s(), static_cast<unsigned long long>(second_late_), static_cast<unsigned long long>(second_steps_),
                  ms(second_worst_), ms(second_lost_));
    report = text;
  }
  second_late_ = second_steps_ = 0;
  second_worst_ = second_lost_ = {};
  while (second_end_ <= now) second_end_ = second_end_ + Duration::from_ms(1000);
  return report;
}

}  // namespace lf::serve
