// A classic CAN frame, laid out so that SocketCAN's identifier flags carry over unchanged.
#pragma once

#include <array>
#include <cstdint>

namespace lf {

struct CanFrame {
  static constexpr std::uint32_t extended_flag = 0x80000000u;  // 29-bit identifier
  static constexpr std::uint32_t remote_flag = 0x40000000u;    // remote transmission request
  static constexpr std::uint32_t error_flag = 0x20000000u;     // error frame made by the controller, not a node

  std::uint32_t id = 0;                // identifier and flags
  std::uint8_t length = 0;             // data bytes, 0..8
  std::array<std::uint8_t, 8> data{};  // little-endian fields, as CANopen has them; bytes past `length` are 0

  bool operator==(const CanFrame&) const = default;
};

}  // namespace lf
