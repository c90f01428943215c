#include "hal/vehicle/tick_clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <limits>
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
std::mutex stepping;   // guards what follows
Time last_read;        // on the machine's clock, of what `stood_still` does not hold yet
Duration stood_still;  // of the machine's time, left out of the test's
Time last_told;        // the machine's time less what was left out, as it was told last

// When each thread that said so is due, on the test's clock.
struct Due {
  bool waited_for = false;
  Time at;
};
std::array<Due, 64> dues;

// The calling thread's place among them; what asks for one beyond the last is not waited for.
class DuePlace {
 public:
  ~DuePlace() { leave(); }
  bool kept() const { return due_ != nullptr; }
  void set(Time t) {
    const std::lock_guard<std::mutex> lock(stepping);
    if (due_ == nullptr) {
      const auto free = std::find_if(dues.begin(), dues.end(), [](const Due& due) { return !due.waited_for; });
      if (free == dues.end()) return;
      due_ = &*free;
    }
    *due_ = {true, t};
  }
  void leave() {
    const std::lock_guard<std::mutex> lock(stepping);
    if (due_ != nullptr) due_->waited_for = false;
    due_ = nullptr;
  }

 private:
  Due* due_ = nullptr;
};
thread_local DuePlace my_due;

void sleep_on_machine(Time t) {
  const timespec until{static_cast<time_t>(t.ns() / ns_per_s), static_cast<long>(t.ns() % ns_per_s)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

// How far the machine's time less what was left out may go: a thread that is due gets its turn first.
Time latest_allowed() {
  Time latest = Time::from_ns(std::numeric_limits<std::int64_t>::max());
  for (const Due& due : dues) {
    if (due.waited_for) latest = std::min(latest, Time::from_ns(due.at.ns() * slower) + longest_step);
  }
  return std::max(latest, last_told);
}

// The machine's time less what was left out. A step too long is a machine that stood still, and a thread long due one that got no processor.
Time clock_without_stops() {
  if (longest_step == Duration()) return read(CLOCK_MONOTONIC);
  const std::lock_guard<std::mutex> lock(stepping);
  const Time now = read(CLOCK_MONOTONIC);
  stood_still = stood_still + std::max(Duration(), now - last_read - longest_step);
  stood_still = stood_still + std::max(Duration(), now - stood_still - latest_allowed());
  last_read = now;
  last_told = now - stood_still;
  return last_told;
}

}  // namespace

void slow_time_down(int factor, Duration step) {
  slower = factor;
  longest_step = Duration::from_ns(step.ns() * factor);
  last_read = last_told = read(CLOCK_MONOTONIC);
  stood_still = Duration();
}

void hold_time_for_me(Time due) {
  if (longest_step != Duration()) my_due.set(due);
}

Time monotonic_now() { return Time::from_ns(clock_without_stops().ns() / slower); }
Time thread_time_now() { return read(CLOCK_THREAD_CPUTIME_ID); }

void sleep_until(Time t) {
  if (longest_step == Duration()) return sleep_on_machine(Time::from_ns(t.ns() * slower));
  const bool kept = my_due.kept();
  my_due.set(t);
  // In halves of the longest step: read so often, no sleep is taken for a stop.
  for (Time now = monotonic_now(); now < t; now = monotonic_now())
    sleep_on_machine(read(CLOCK_MONOTONIC) + std::min(longest_step / 2, (t - now) * slower));
  if (!kept) my_due.leave();
}

void TickClock::start() { grid_.start(monotonic_now()); }

Time TickClock::wait() {
  hold_time_for_me(grid_.next());
  sleep_until(grid_.next());
  const Time now = monotonic_now();
  lateness_.add(now - grid_.next());
  return grid_.wake(now);
}

}  // namespace lf::hal
