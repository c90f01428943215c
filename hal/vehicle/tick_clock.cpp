#include "hal/vehicle/tick_clock.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <mutex>

namespace lf::hal {

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;

Time read(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Time::from_ns(now.tv_sec * ns_per_s + now.tv_nsec);
}

std::int64_t slower = 1;
Duration longest_step;
std::mutex stepping;
Time last_read;        // on the machine's clock, of what `stood_still` does not hold yet
Duration stood_still;  // of the machine's time, left out of the test's

void sleep_on_machine(Time t) {
  const timespec until{static_cast<time_t>(t.ns() / ns_per_s), static_cast<long>(t.ns() % ns_per_s)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

// The machine's time less what was left out. A step too long is a machine, or a thread, that stood still.
Time clock_without_stops() {
  if (longest_step == Duration()) return read(CLOCK_MONOTONIC);
  const std::lock_guard<std::mutex> lock(stepping);
  const Time now = read(CLOCK_MONOTONIC);
  stood_still = stood_still + std::max(Duration(), now - last_read - longest_step);
  last_read = now;
  return now - stood_still;
}

}  // namespace

void slow_time_down(int factor, Duration step) {
  slower = factor;
  longest_step = Duration::from_ns(step.ns() * factor);
  last_read = read(CLOCK_MONOTONIC);
  stood_still = Duration();
}

Time monotonic_now() { return Time::from_ns(clock_without_stops().ns() / slower); }
Time thread_time_now() { return read(CLOCK_THREAD_CPUTIME_ID); }

void sleep_until(Time t) {
  if (longest_step == Duration()) return sleep_on_machine(Time::from_ns(t.ns() * slower));
  // In halves of the longest step: read so often, no sleep is taken for a stop.
  for (Time now = monotonic_now(); now < t; now = monotonic_now())
    sleep_on_machine(read(CLOCK_MONOTONIC) + std::min(longest_step / 2, (t - now) * slower));
}

void TickClock::start() { grid_.start(monotonic_now()); }

Time TickClock::wait() {
  sleep_until(grid_.next());
  const Time now = monotonic_now();
  lateness_.add(now - grid_.next());
  return grid_.wake(now);
}

}  // namespace lf::hal
