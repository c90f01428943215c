// A CAN interface as the kernel describes it (rtnetlink, RTM_GETLINK): what `ip -details link show` prints.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "hal/vehicle/linux_calls.hpp"

namespace lf::hal::doctor {

struct CanLink {
  int error = 0;  // errno: ENODEV for an interface that there is not
  bool is_can = false;
  bool up = false;
  std::string kind{};       // "can", "vcan"; empty where the driver says none, as slcan's
  std::uint32_t queue = 0;  // frames
  // Of a controller that has and says them.
  std::optional<std::uint32_t> bit_rate{};
  double sample_point = 0;
  std::optional<std::uint32_t> restart_ms{};  // 0: it stays off the bus until it is told
  std::optional<std::uint32_t> state{};       // can_state of linux/can/netlink.h
};

// From one answer of the kernel's. A message that is cut or of another kind has EPROTO as error.
CanLink parse_can_link(std::span<const char> message);

CanLink read_can_link(const std::string& interface, LinuxCalls& calls);

}  // namespace lf::hal::doctor
