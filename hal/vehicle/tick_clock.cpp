#include "hal/vehicle/tick_clock.hpp"

#include <cerrno>
#include <ctime>

namespace lf::hal {

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;

Time read(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Time::from_ns(now.tv_sec * ns_per_s + now.tv_nsec);
}

std::int64_t slower = 1;

}  // namespace

void slow_time_down(int factor) { slower = factor; }

Time monotonic_now() { return Time::from_ns(read(CLOCK_MONOTONIC).ns() / slower); }
Time thread_time_now() { return read(CLOCK_THREAD_CPUTIME_ID); }

void sleep_until(Time t) {
  const std::int64_t ns = t.ns() * slower;
  const timespec until{static_cast<time_t>(ns / ns_per_s), static_cast<long>(ns % ns_per_s)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

void TickClock::start() { grid_.start(monotonic_now()); }

Time TickClock::wait() {
  sleep_until(grid_.next());
  const Time now = monotonic_now();
  lateness_.add(now - grid_.next());
  return grid_.wake(now);
}

}  // namespace lf::hal
