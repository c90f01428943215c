#include "hal/vehicle/linux_calls.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

namespace lf::hal {

namespace {

int answer(long result) { return result < 0 ? -errno : static_cast<int>(result); }

std::int64_t clock_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

}  // namespace

int LinuxCalls::open(const char* path, int flags) { return answer(::open(path, flags | O_CLOEXEC)); }

int LinuxCalls::close(int fd) { return answer(::close(fd)); }

int LinuxCalls::ioctl(int fd, unsigned long request, void* argument) {
  int result = 0;
  do {
    result = answer(::ioctl(fd, request, argument));
  } while (result == -EINTR);
  return result;
}

void* LinuxCalls::map(int fd, std::size_t bytes, std::int64_t offset, int& error) {
  void* mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
  error = mapped == MAP_FAILED ? -errno : 0;
  return mapped == MAP_FAILED ? nullptr : mapped;
}

int LinuxCalls::unmap(void* address, std::size_t bytes) { return answer(munmap(address, bytes)); }

int LinuxCalls::socket(int family, int type, int protocol) { return answer(::socket(family, type | SOCK_CLOEXEC, protocol)); }

int LinuxCalls::bind(int fd, const sockaddr* address, std::size_t bytes) {
  return answer(::bind(fd, address, static_cast<socklen_t>(bytes)));
}

int LinuxCalls::set_option(int fd, int level, int name, const void* value, std::size_t bytes) {
  return answer(setsockopt(fd, level, name, value, static_cast<socklen_t>(bytes)));
}

int LinuxCalls::get_option(int fd, int level, int name, void* value, std::size_t bytes) {
  auto length = static_cast<socklen_t>(bytes);
  return answer(getsockopt(fd, level, name, value, &length));
}

int LinuxCalls::receive_many(int fd, mmsghdr* messages, unsigned count) {
  return answer(recvmmsg(fd, messages, count, MSG_DONTWAIT, nullptr));
}

int LinuxCalls::send_many(int fd, mmsghdr* messages, unsigned count) { return answer(sendmmsg(fd, messages, count, MSG_DONTWAIT)); }

int LinuxCalls::poll(int fd, short events, std::int64_t timeout_ns) {
  pollfd waiting{fd, events, 0};
  const timespec timeout{static_cast<time_t>(timeout_ns / 1'000'000'000), static_cast<long>(timeout_ns % 1'000'000'000)};
  const int result = ppoll(&waiting, 1, &timeout, nullptr);
  if (result < 0) return errno == EINTR ? 0 : -errno;
  return result == 0 ? 0 : waiting.revents;
}

std::int64_t LinuxCalls::monotonic_ns() { return clock_ns(CLOCK_MONOTONIC); }
std::int64_t LinuxCalls::realtime_ns() { return clock_ns(CLOCK_REALTIME); }

std::int64_t LinuxCalls::monotonic_step_ns() {
  timespec step{};
  clock_getres(CLOCK_MONOTONIC, &step);
  return step.tv_sec * std::int64_t{1'000'000'000} + step.tv_nsec;
}

bool LinuxCalls::wall_clock_synchronised() {
  timex nothing_set{};
  return adjtimex(&nothing_set) >= 0 && (nothing_set.status & STA_UNSYNC) == 0;
}

LinuxCalls& linux_calls() {
  static LinuxCalls calls;
  return calls;
}

}  // namespace lf::hal
