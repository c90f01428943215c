// The system calls that SocketCAN and V4L2 need, behind one seam, so that tests can stand in for a kernel that has neither.
//
// Every call answers with its result, or with minus errno. None is retried here but for EINTR.
#pragma once

#include <cstddef>
#include <cstdint>

struct mmsghdr;
struct sockaddr;

namespace lf::hal {

class LinuxCalls {
 public:
  virtual ~LinuxCalls() = default;
  virtual int open(const char* path, int flags);
  virtual int close(int fd);
  virtual int ioctl(int fd, unsigned long request, void* argument);
  // Null on failure, with minus errno in `error`.
  virtual void* map(int fd, std::size_t bytes, std::int64_t offset, int& error);
  virtual int unmap(void* address, std::size_t bytes);
  virtual int socket(int family, int type, int protocol);
  virtual int bind(int fd, const sockaddr* address, std::size_t bytes);
  virtual int set_option(int fd, int level, int name, const void* value, std::size_t bytes);
  virtual int get_option(int fd, int level, int name, void* value, std::size_t bytes);
  virtual int receive_many(int fd, mmsghdr* messages, unsigned count);  // never waits
  virtual int send_many(int fd, mmsghdr* messages, unsigned count);     // never waits
  // Waits until `fd` has one of poll(2)'s `events` or `timeout_ns` have passed; the events that came, 0 after the time.
  virtual int poll(int fd, short events, std::int64_t timeout_ns);
  virtual std::int64_t monotonic_ns();
  virtual std::int64_t realtime_ns();        // only to translate the kernel's stamps
  virtual std::int64_t monotonic_step_ns();  // the finest that CLOCK_MONOTONIC and its timers tell apart
  virtual bool wall_clock_synchronised();    // as whoever keeps it says (NTP, PTP)
};

LinuxCalls& linux_calls();  // the kernel's own

}  // namespace lf::hal
