// A kernel of the test's making whose CAN interface is one end of a socket pair: frames written into one end come out of the other.
#pragma once

#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include "hal/vehicle/linux_calls.hpp"
#include "hal/vehicle/tick_clock.hpp"

namespace lf::test {

// How many times slower than the machine's the test's clock goes.
inline int slowdown() {
  const char* set = std::getenv("LANTERNFISH_SLOWDOWN");
  return set != nullptr ? std::max(1, std::atoi(set)) : 2;
}

class PairLinux : public hal::LinuxCalls {
 public:
  // Owns `fd`.
  explicit PairLinux(int fd) : fd_(fd) {}
  ~PairLinux() override { ::close(fd_); }
  PairLinux(const PairLinux&) = delete;
  PairLinux& operator=(const PairLinux&) = delete;

  int close(int fd) override { return fd == fd_ ? 0 : LinuxCalls::close(fd); }
  int socket(int, int, int) override { return fd_; }
  int bind(int, const sockaddr*, std::size_t) override { return 0; }
  int set_option(int, int, int, const void*, std::size_t) override { return 0; }
  // What a socket of this kind has in its queue waits for the reader's turn, not for a bus.
  int get_option(int, int, int, void*, std::size_t) override { return -ENOPROTOOPT; }
  int ioctl(int fd, unsigned long request, void* argument) override {
    if (fd != fd_) return LinuxCalls::ioctl(fd, request, argument);
    auto* interface = static_cast<ifreq*>(argument);
    if (request == SIOCGIFINDEX) interface->ifr_ifindex = 1;
    if (request == SIOCGIFFLAGS) interface->ifr_flags = IFF_UP;
    return 0;
  }
  int receive_many(int fd, mmsghdr* messages, unsigned count) override {
    const int received = LinuxCalls::receive_many(fd, messages, count);
    // The other end is closed: no bus is silent in this way.
    return received > 0 && messages[0].msg_len == 0 ? -ENETDOWN : received;
  }
  int poll(int fd, short events, std::int64_t timeout_ns) override { return LinuxCalls::poll(fd, events, timeout_ns * slowdown()); }
  std::int64_t monotonic_ns() override { return hal::monotonic_now().ns(); }
  std::int64_t realtime_ns() override { return hal::monotonic_now().ns() + std::int64_t{1'700'000'000} * 1'000'000'000; }

 private:
  int fd_;
};

}  // namespace lf::test
