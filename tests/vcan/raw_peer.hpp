// A plain CAN socket and the commands of iproute2: the other end of the bus in tests, with nothing of the project in it.
#pragma once

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

namespace lf::test {

// True when the shell's command succeeds; its words go to the test's own output.
inline bool shell(const std::string& command) { return std::system(command.c_str()) == 0; }

class RawPeer {
 public:
  explicit RawPeer(const std::string& interface) : fd_(::socket(PF_CAN, SOCK_RAW, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (fd_ < 0 || ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no raw CAN socket on " + interface + ": " + std::strerror(errno));
  }
  ~RawPeer() { ::close(fd_); }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;

  bool send(std::uint32_t id, std::initializer_list<std::uint8_t> data = {}) {
    can_frame frame{};
    frame.can_id = id;
    for (const std::uint8_t byte : data) frame.data[frame.len++] = byte;
    return ::write(fd_, &frame, sizeof frame) == sizeof frame;
  }

  // The next frame, waited for at most `limit_ms`.
  std::optional<can_frame> receive(int limit_ms = 500) {
    pollfd ready{fd_, POLLIN, 0};
    can_frame frame{};
    if (::poll(&ready, 1, limit_ms) <= 0 || ::read(fd_, &frame, sizeof frame) != sizeof frame) return std::nullopt;
    return frame;
  }

 private:
  int fd_;
};

}  // namespace lf::test
