#include "hal/vehicle/can_restart.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace lf::hal {

namespace {

// RTM_NEWLINK with IFLA_LINKINFO { IFLA_INFO_KIND "can", IFLA_INFO_DATA { IFLA_CAN_RESTART 1 } }.
class Request {
 public:
  explicit Request(unsigned interface) {
    header_.nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg));
    header_.nlmsg_type = RTM_NEWLINK;
    header_.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    ifinfomsg info{};
    info.ifi_family = AF_UNSPEC;
    info.ifi_index = static_cast<int>(interface);
    std::memcpy(body_.data() + NLMSG_HDRLEN, &info, sizeof info);
  }

  // Returns where the attribute begins, for `end` of a nest.
  std::size_t add(unsigned short type, const void* value, std::size_t bytes) {
    const std::size_t at = NLMSG_ALIGN(header_.nlmsg_len);
    const rtattr attribute{static_cast<unsigned short>(RTA_LENGTH(bytes)), type};
    std::memcpy(body_.data() + at, &attribute, sizeof attribute);
    if (bytes > 0) std::memcpy(body_.data() + at + RTA_LENGTH(0), value, bytes);
    header_.nlmsg_len = static_cast<std::uint32_t>(at + RTA_SPACE(bytes));
    return at;
  }
  void end(std::size_t at) {
    const auto length = static_cast<unsigned short>(header_.nlmsg_len - at);
    std::memcpy(body_.data() + at, &length, sizeof length);
  }

  bool send(int fd) {
    std::memcpy(body_.data(), &header_, sizeof header_);
    return ::send(fd, body_.data(), header_.nlmsg_len, 0) == static_cast<ssize_t>(header_.nlmsg_len);
  }

 private:
  nlmsghdr header_{};
  std::array<char, 256> body_{};
};

int read_answer(int fd) {
  std::array<char, 1024> buffer{};
  const ssize_t bytes = recv(fd, buffer.data(), buffer.size(), 0);
  if (bytes < 0) return errno;
  if (static_cast<std::size_t>(bytes) < NLMSG_LENGTH(sizeof(nlmsgerr))) return EPROTO;
  nlmsghdr header{};
  std::memcpy(&header, buffer.data(), sizeof header);
  if (header.nlmsg_type != NLMSG_ERROR) return EPROTO;
  nlmsgerr error{};
  std::memcpy(&error, buffer.data() + NLMSG_HDRLEN, sizeof error);
  return -error.error;
}

}  // namespace

int restart_can(const std::string& interface) {
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) return ENODEV;
  const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (fd < 0) return errno;
  const timeval second{1, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &second, sizeof second);
  Request request(index);
  const std::uint32_t restart = 1;
  const std::size_t link = request.add(IFLA_LINKINFO, nullptr, 0);
  request.add(IFLA_INFO_KIND, "can", 3);
  const std::size_t data = request.add(IFLA_INFO_DATA, nullptr, 0);
  request.add(IFLA_CAN_RESTART, &restart, sizeof restart);
  request.end(data);
  request.end(link);
  const int result = request.send(fd) ? read_answer(fd) : errno;
  close(fd);
  return result;
}

}  // namespace lf::hal
