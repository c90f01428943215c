// How long a classic CAN frame is on the wire, bit by bit (ISO 11898-1).
#pragma once

#include <cstdint>

#include "shared/messages/can_frame.hpp"

namespace lf::devices {

inline constexpr std::uint32_t interframe_bits = 3;

// Bits from start of frame to the end of frame's seventh bit, stuff bits of this very content included, interframe space not.
std::uint32_t frame_bits(const CanFrame& frame);

// The most that any content of this length takes on an 11-bit identifier, interframe space included: 47 + 8 n + floor((33 + 8 n) / 4).
constexpr std::uint32_t worst_case_bits(std::uint32_t data_bytes) { return 47 + 8 * data_bytes + (33 + 8 * data_bytes) / 4; }

// Of a frame without any stuff bit, interframe space included; and with the most that a frame of its kind and length could need.
std::uint32_t unstuffed_bits(const CanFrame& frame);
std::uint32_t worst_case_bits(const CanFrame& frame);

// Smaller wins the arbitration: dominant bits in the order they are sent.
std::uint32_t arbitration_key(const CanFrame& frame);

}  // namespace lf::devices
