// The kernel's answer to RTM_GETLINK, byte by byte as include/uapi/linux/{netlink,rtnetlink,if_link,can/netlink}.h lay it out. The numbers stand here, not the
// headers' names, so that a reader that takes a wrong field is found.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace lf::test {

struct Link {
  std::uint16_t type = 280;   // ARPHRD_CAN
  std::uint32_t flags = 0x1;  // IFF_UP
  std::uint32_t queue = 10;
  std::string kind = "can";
  std::uint32_t bit_rate = 1'000'000;
  std::uint32_t sample_point = 875;  // thousandths of a bit
  std::uint32_t restart_ms = 0;
  std::uint32_t state = 0;  // error active
};

using Bytes = std::vector<char>;

template <class Number>
void put(Bytes& out, Number number) {
  const auto* raw = reinterpret_cast<const char*>(&number);
  out.insert(out.end(), raw, raw + sizeof number);
}

inline void put_attribute(Bytes& out, std::uint16_t type, const Bytes& value) {
  put(out, static_cast<std::uint16_t>(4 + value.size()));
  put(out, type);
  out.insert(out.end(), value.begin(), value.end());
  while (out.size() % 4 != 0) out.push_back(0);
}

template <class Number>
void put_number(Bytes& out, std::uint16_t type, Number number) {
  Bytes value;
  put(value, number);
  put_attribute(out, type, value);
}

inline Bytes with_header(std::uint16_t type, const Bytes& body) {
  Bytes message;
  put(message, static_cast<std::uint32_t>(16 + body.size()));
  put(message, type);
  put(message, std::uint16_t{0});
  put(message, std::uint32_t{1});
  put(message, std::uint32_t{4711});
  message.insert(message.end(), body.begin(), body.end());
  return message;
}

inline Bytes link_message(const Link& link) {
  Bytes controller;
  Bytes timing;
  for (const std::uint32_t number : {link.bit_rate, link.sample_point, 125U, 3U, 3U, 1U, 1U, 10U}) put(timing, number);
  put_attribute(controller, 1, timing);
  put_number(controller, 4, link.state);
  put_number(controller, 6, link.restart_ms);
  Bytes info;
  Bytes kind(link.kind.begin(), link.kind.end());
  kind.push_back(0);
  put_attribute(info, 1, kind);
  if (link.kind == "can") put_attribute(info, 2 | 0x8000, controller);  // NLA_F_NESTED
  Bytes body;
  put(body, std::uint8_t{0});
  put(body, std::uint8_t{0});
  put(body, link.type);
  put(body, std::int32_t{3});
  put(body, link.flags);
  put(body, std::uint32_t{0});
  put_attribute(body, 3, {'c', 'a', 'n', '0', 0});
  put_number(body, 13, link.queue);
  put_attribute(body, 18, info);
  return with_header(16, body);
}

inline Bytes error_message(std::int32_t error) {
  Bytes body;
  put(body, -error);
  body.resize(20);
  return with_header(2, body);
}

}  // namespace lf::test
