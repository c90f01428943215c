// Runs a command, and meanwhile measures by how much sleeps of 1 ms are too long: a machine that does not keep time shows it here.
//
// Usage: watch_time FILE COMMAND [ARGUMENT]...
//
// FILE has the longest overshoot until now and the sum of all over 0.2 ms, in milliseconds. It is kept up to date, so it is there when everything was
// killed. The measuring process comes first on its processor (SCHED_FIFO 90, where that is permitted): the last one allowed, or LANTERNFISH_GUEST_CPU.
// Exit status: the command's; 128 + n when a signal ended it.
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t sleep_ns = 1'000'000;
constexpr std::int64_t note_ns = 200'000;         // a longest one that grew by less is not worth a write
constexpr std::int64_t note_sum_ns = 20'000'000;  // nor is such a sum

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

volatile sig_atomic_t child = 0;  // for the signal handler

void hand_on(int signal) {
  if (child > 0) kill(child, signal);
}

void come_first() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    int cpu = CPU_SETSIZE - 1;
    while (cpu > 0 && !CPU_ISSET(cpu, &allowed)) --cpu;
    const char* asked = std::getenv("LANTERNFISH_GUEST_CPU");
    if (asked != nullptr) cpu = std::clamp(std::atoi(asked), 0, CPU_SETSIZE - 1);
    CPU_ZERO(&allowed);
    CPU_SET(cpu, &allowed);
    (void)sched_setaffinity(0, sizeof allowed, &allowed);
  }
  const sched_param priority{.sched_priority = 90};
  (void)sched_setscheduler(0, SCHED_FIFO, &priority);
  (void)mlockall(MCL_CURRENT | MCL_FUTURE);
}

// False: it cannot be written.
bool note(int file, std::int64_t worst_ns, std::int64_t sum_ns) {
  std::array<char, 64> text{};
  const int length =
      std::snprintf(text.data(), text.size(), "%12.3f %12.3f\n", 1e-6 * static_cast<double>(worst_ns), 1e-6 * static_cast<double>(sum_ns));
  if (pwrite(file, text.data(), static_cast<std::size_t>(length), 0) != length) return false;
  // From a guest to the machine's file, which outlives it; not to the disk.
  (void)sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s FILE COMMAND [ARGUMENT]...\n", argv[0]);
    return 2;
  }
  const int file = open(argv[1], O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0 || !note(file, 0, 0)) {
    std::perror(argv[1]);
    return 2;
  }
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const pid_t started = fork();
  if (started < 0) {
    std::perror("fork");
    return 2;
  }
  if (started == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    execvp(argv[2], argv + 2);
    std::perror(argv[2]);
    _exit(127);
  }
  child = started;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) std::signal(signal, hand_on);
  come_first();

  std::int64_t worst_ns = 0, sum_ns = 0, noted_sum_ns = 0;
  std::int64_t before = now_ns();
  for (unsigned turn = 0;; ++turn) {
    const timespec pause{0, sleep_ns};
    const bool slept = clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr) == 0;
    const std::int64_t over_ns = now_ns() - before - sleep_ns;
    if (slept && over_ns > note_ns) sum_ns += over_ns;
    if (slept && (over_ns > worst_ns + note_ns || sum_ns > noted_sum_ns + note_sum_ns)) {
      worst_ns = std::max(worst_ns, over_ns);
      noted_sum_ns = sum_ns;
      (void)note(file, worst_ns, sum_ns);
    }
    int status = 0;
    if (turn % 16 == 0 && waitpid(started, &status, WNOHANG) == started)
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    before = now_ns();  // writing is not counted
  }
}
