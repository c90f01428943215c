#include "hal/vehicle/doctor/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace lf::hal::doctor {

namespace {

constexpr std::int64_t answer_ns = 1'000'000'000;

// Calls visit(type, value) for each attribute; what is cut is left out.
template <class Visit>
void each_attribute(std::span<const char> bytes, const Visit& visit) {
  while (bytes.size() >= sizeof(rtattr)) {
    rtattr attribute{};
    std::memcpy(&attribute, bytes.data(), sizeof attribute);
    if (attribute.rta_len < RTA_LENGTH(0) || attribute.rta_len > bytes.size()) return;
    visit(attribute.rta_type & NLA_TYPE_MASK, bytes.subspan(RTA_LENGTH(0), attribute.rta_len - RTA_LENGTH(0)));
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(attribute.rta_len), bytes.size()));
  }
}

template <class Value>
std::optional<Value> value_of(std::span<const char> bytes) {
  if (bytes.size() < sizeof(Value)) return std::nullopt;
  Value value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

void read_controller(std::span<const char> data, CanLink& link) {
  each_attribute(data, [&](int type, std::span<const char> value) {
    if (type == IFLA_CAN_BITTIMING) {
      const auto timing = value_of<can_bittiming>(value);
      if (!timing || timing->bitrate == 0) return;  // one that nobody has set
      link.bit_rate = timing->bitrate;
      link.sample_point = 1e-3 * timing->sample_point;
    }
    if (type == IFLA_CAN_RESTART_MS) link.restart_ms = value_of<std::uint32_t>(value);
    if (type == IFLA_CAN_STATE) link.state = value_of<std::uint32_t>(value);
  });
}

void read_kind(std::span<const char> info, CanLink& link) {
  std::span<const char> data;
  each_attribute(info, [&](int type, std::span<const char> value) {
    if (type == IFLA_INFO_KIND) link.kind = std::string(value.data(), strnlen(value.data(), value.size()));
    if (type == IFLA_INFO_DATA) data = value;
  });
  if (link.kind == "can") read_controller(data, link);
}

int ask(int fd, const std::string& interface, LinuxCalls& calls) {
  struct {
    nlmsghdr header;
    ifinfomsg info;
    rtattr attribute;
    std::array<char, IF_NAMESIZE> name;
  } request{};
  interface.copy(request.name.data(), request.name.size() - 1);
  request.attribute = {static_cast<unsigned short>(RTA_LENGTH(request.name.size())), IFLA_IFNAME};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  iovec vector{&request, sizeof request};
  mmsghdr message{};
  message.msg_hdr.msg_iov = &vector;
  message.msg_hdr.msg_iovlen = 1;
  const int sent = calls.send_many(fd, &message, 1);
  return sent == 1 ? 0 : sent < 0 ? -sent : EIO;
}

}  // namespace

CanLink parse_can_link(std::span<const char> message) {
  CanLink link;
  const auto header = value_of<nlmsghdr>(message);
  if (!header || header->nlmsg_len > message.size() || header->nlmsg_len < NLMSG_HDRLEN) return {.error = EPROTO};
  const std::span<const char> body = message.subspan(NLMSG_HDRLEN, header->nlmsg_len - NLMSG_HDRLEN);
  if (header->nlmsg_type == NLMSG_ERROR) {
    const auto error = value_of<int>(body);
    return {.error = error && *error != 0 ? -*error : EPROTO};
  }
  const auto info = value_of<ifinfomsg>(body);
  if (header->nlmsg_type != RTM_NEWLINK || !info) return {.error = EPROTO};
  link.is_can = info->ifi_type == ARPHRD_CAN;
  link.up = (info->ifi_flags & IFF_UP) != 0;
  each_attribute(body.subspan(NLMSG_ALIGN(sizeof(ifinfomsg))), [&](int type, std::span<const char> value) {
    if (type == IFLA_TXQLEN) link.queue = value_of<std::uint32_t>(value).value_or(0);
    if (type == IFLA_LINKINFO) read_kind(value, link);
  });
  return link;
}

CanLink read_can_link(const std::string& interface, LinuxCalls& calls) {
  const int fd = calls.socket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
  if (fd < 0) return {.error = -fd};
  std::array<char, 16384> answer{};
  iovec vector{answer.data(), answer.size()};
  mmsghdr message{};
  message.msg_hdr.msg_iov = &vector;
  message.msg_hdr.msg_iovlen = 1;
  int error = ask(fd, interface, calls);
  if (error == 0) error = calls.poll(fd, POLLIN, answer_ns) > 0 ? 0 : ETIMEDOUT;
  if (error == 0) {
    const int got = calls.receive_many(fd, &message, 1);
    error = got == 1 ? 0 : got < 0 ? -got : EIO;
  }
  calls.close(fd);
  if (error != 0) return {.error = error};
  return parse_can_link({answer.data(), std::min<std::size_t>(message.msg_len, answer.size())});
}

}  // namespace lf::hal::doctor
