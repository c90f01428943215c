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

void TickClock::start() { next_ = monotonic_now() + period_; }

Time TickClock::wait() {
  sleep_until(next_);
  const Time now = monotonic_now();
  const std::int64_t passed = now < next_ ? 0 : (now - next_).ns() / period_.ns();
  missed_ += static_cast<std::uint64_t>(passed);
  lateness_.add(now - next_);
  const Time tick = next_ + period_ * passed;
  next_ = tick + period_;
  return tick;
}

}  // namespace lf::hal
