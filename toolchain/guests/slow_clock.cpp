// Preloaded into User Mode Linux's kernel: the guest's clock goes LANTERNFISH_SLOWDOWN times slower than this machine's, so that the machine is that much
// faster to the guest, and stands still that much shorter.
//
// The kernel knows time by clock_gettime and one timer alone (arch/um/os-Linux/time.c of Linux 6.1); its programs ask the kernel.
#include <dlfcn.h>
#include <sys/time.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t ns_of(const timespec& t) { return t.tv_sec * second_ns + t.tv_nsec; }
timespec timespec_of(std::int64_t ns) { return {ns / second_ns, ns % second_ns}; }

template <class Function>
Function next(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

struct Machine {
  decltype(&clock_gettime) get = next(&clock_gettime, "clock_gettime");
  decltype(&timer_settime) set_timer = next(&timer_settime, "timer_settime");
  decltype(&timer_gettime) get_timer = next(&timer_gettime, "timer_gettime");
  std::int64_t slowdown = 1;
  timespec monotonic{}, wall{};  // when the guest began

  Machine() {
    const char* asked = std::getenv("LANTERNFISH_SLOWDOWN");
    if (asked != nullptr && std::atoi(asked) > 0) slowdown = std::atoi(asked);
    get(CLOCK_MONOTONIC, &monotonic);
    get(CLOCK_REALTIME, &wall);
  }
};

Machine& machine() {
  static Machine one;
  return one;
}

itimerspec scaled(const itimerspec& t, std::int64_t times, std::int64_t by) {
  return {timespec_of(ns_of(t.it_interval) * times / by), timespec_of(ns_of(t.it_value) * times / by)};
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* t) noexcept {
  const Machine& m = machine();
  const int status = m.get(clock, t);
  if (status != 0 || (clock != CLOCK_MONOTONIC && clock != CLOCK_REALTIME)) return status;
  const std::int64_t begin = ns_of(clock == CLOCK_MONOTONIC ? m.monotonic : m.wall);
  *t = timespec_of(begin + (ns_of(*t) - begin) / m.slowdown);
  return 0;
}

int gettimeofday(timeval* t, void*) noexcept {
  timespec now{};
  const int status = clock_gettime(CLOCK_REALTIME, &now);
  *t = {now.tv_sec, now.tv_nsec / 1000};
  return status;
}

// The guest's kernel sets its timer by durations, not by instants.
int timer_settime(timer_t timer, int flags, const itimerspec* value, itimerspec* old) noexcept {
  const Machine& m = machine();
  const itimerspec slow = scaled(*value, m.slowdown, 1);
  const int status = m.set_timer(timer, flags, &slow, old);
  if (status == 0 && old != nullptr) *old = scaled(*old, 1, m.slowdown);
  return status;
}

int timer_gettime(timer_t timer, itimerspec* value) noexcept {
  const Machine& m = machine();
  const int status = m.get_timer(timer, value);
  // What is running does not become zero: that would be a timer that is not set.
  const bool runs = status == 0 && ns_of(value->it_value) != 0;
  if (status == 0) *value = scaled(*value, 1, m.slowdown);
  if (runs && ns_of(value->it_value) == 0) value->it_value.tv_nsec = 1;
  return status;
}

}  // extern "C"
