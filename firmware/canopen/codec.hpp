// Little-endian fields of CAN data, and frames.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "shared/messages/can_frame.hpp"

namespace lf::canopen {

// Writes `value` at byte `offset`; offset + sizeof(T) <= 8.
template <std::integral T>
constexpr void put(CanFrame& frame, std::size_t offset, T value) {
  const auto bits = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value));
  for (std::size_t i = 0; i < sizeof(T); ++i) frame.data[offset + i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

// Reads the T at byte `offset`; offset + sizeof(T) <= 8.
template <std::integral T>
constexpr T get(const CanFrame& frame, std::size_t offset) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) bits |= static_cast<std::uint64_t>(frame.data[offset + i]) << (8 * i);
  return static_cast<T>(static_cast<std::make_unsigned_t<T>>(bits));
}

constexpr CanFrame empty_frame(std::uint32_t id, std::uint8_t length) {
  CanFrame frame;
  frame.id = id;
  frame.length = length;
  return frame;
}

}  // namespace lf::canopen
