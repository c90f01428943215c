#include "hal/vehicle/realtime.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace lf::hal {

namespace {

constexpr std::size_t stack_bytes = std::size_t{2} << 20;
constexpr std::size_t touched_bytes = std::size_t{256} << 10;
constexpr std::size_t page = 4096;

}  // namespace

std::vector<std::string> lock_process_memory(const RealtimeConfig& config) {
  std::vector<std::string> lost;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_ARENA_MAX, 2);  // each arena is 64 MB of addresses
  if (config.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    lost.push_back(std::string("memory is not locked (") + std::strerror(errno) +
                   "): pages may come late; give CAP_IPC_LOCK or LimitMEMLOCK=infinity");
  }
  return lost;
}

std::vector<std::string> become_realtime(const RealtimeConfig& config) {
  std::vector<std::string> lost;
  if (config.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(config.cpu), &set);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0)
      lost.push_back("the control thread is not tied to CPU " + std::to_string(config.cpu) + " (" + std::strerror(error) + ")");
  }
  if (config.priority > 0) {
    const sched_param parameter{config.priority};
    if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter); error != 0) {
      lost.push_back(std::string("the control thread is not SCHED_FIFO (") + std::strerror(error) +
                     "): other programs can delay it; give CAP_SYS_NICE or LimitRTPRIO=" + std::to_string(config.priority));
    }
  }
  return lost;
}

void prefault_stack() {
  volatile std::byte stack[touched_bytes];
  for (std::size_t i = 0; i < touched_bytes; i += page) stack[i] = static_cast<std::byte>(i);
  (void)stack[0];
}

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

void name_thread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace lf::hal
