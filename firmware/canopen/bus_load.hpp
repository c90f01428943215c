// Length of a classic CAN frame with an 11-bit identifier on the wire, worst case and exact, and the load of a bus.
//
// ISO 11898-1: SOF, identifier, RTR, IDE, r0, DLC, data and CRC are stuffed: after five equal bits one of the other kind follows, and counts in the next
// run. CRC delimiter, ACK slot and delimiter, EOF and three bits of interframe space are not. Worst case: Tindell, Burns, Wellings 1995, as corrected by
// Davis, Burns, Bril, Lukkien 2007: a stuff bit for each four bits after the first.
#pragma once

#include <array>
#include <cstdint>

#include "shared/messages/can_frame.hpp"

namespace lf::canopen::bus_load {

inline constexpr std::uint32_t stuffed_overhead_bits = 34;  // SOF 1, identifier 11, RTR 1, IDE 1, r0 1, DLC 4, CRC 15
inline constexpr std::uint32_t plain_overhead_bits = 13;    // CRC delimiter 1, ACK 2, EOF 7, interframe space 3

constexpr std::uint32_t worst_case_bits(std::uint8_t data_bytes) {
  const std::uint32_t stuffed = stuffed_overhead_bits + 8u * data_bytes;
  return stuffed + plain_overhead_bits + (stuffed - 1) / 4;
}

// Remainders by x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1 for the four bits that leave the register.
constexpr std::array<std::uint16_t, 16> make_crc15_table() {
  std::array<std::uint16_t, 16> table{};
  for (std::uint32_t nibble = 0; nibble < 16; ++nibble) {
    std::uint32_t crc = nibble << 11;
    for (int bit = 0; bit < 4; ++bit) crc = (crc << 1) ^ ((crc & 0x4000u) != 0 ? 0x4599u : 0u);
    table[nibble] = static_cast<std::uint16_t>(crc & 0x7FFFu);
  }
  return table;
}
inline constexpr std::array<std::uint16_t, 16> crc15_table = make_crc15_table();

// A stuffer's state is the last bit and how many of its kind stand in a row, 1 to 4: 4 x bit + row - 1. An entry is the state four bits later, and 8 x
// the stuff bits among them.
constexpr std::array<std::array<std::uint8_t, 16>, 8> make_stuffing_table() {
  std::array<std::array<std::uint8_t, 16>, 8> table{};
  for (std::uint32_t state = 0; state < 8; ++state) {
    for (std::uint32_t nibble = 0; nibble < 16; ++nibble) {
      std::uint32_t last = state / 4, row = state % 4 + 1, stuffed = 0;
      for (int i = 3; i >= 0; --i) {
        const std::uint32_t bit = (nibble >> i) & 1u;
        row = bit == last ? row + 1 : 1;
        last = bit;
        if (row < 5) continue;
        ++stuffed;
        last = 1 - bit;  // the stuff bit opens the next row
        row = 1;
      }
      table[state][nibble] = static_cast<std::uint8_t>(8 * stuffed + 4 * last + row - 1);
    }
  }
  return table;
}
inline constexpr std::array<std::array<std::uint8_t, 16>, 8> stuffing_table = make_stuffing_table();

// CRC and stuff bits of a frame, four bits at a time. Every frame of a control tick is measured; bit by bit that was three fifths of the tick.
class FrameWalk {
 public:
  constexpr void take(std::uint32_t nibble) { take(nibble, nibble); }
  constexpr void take(std::uint32_t checked, std::uint32_t stuffed) {
    crc_ = ((crc_ << 4) & 0x7FFFu) ^ crc15_table[(crc_ >> 11) ^ checked];
    const std::uint32_t entry = stuffing_table[state_][stuffed];
    state_ = entry & 7u;
    stuff_bits_ += entry >> 3;
  }
  constexpr std::uint32_t crc() const { return crc_; }
  constexpr std::uint32_t stuff_bits() const { return stuff_bits_; }

 private:
  std::uint32_t crc_ = 0;
  std::uint32_t state_ = 4;  // the idle bus is recessive
  std::uint32_t stuff_bits_ = 0;
};

// Bits on the wire of this very frame, interframe space included. O(length); 30 nibbles for 8 bytes.
constexpr std::uint32_t exact_bits(const CanFrame& frame) {
  const bool remote = (frame.id & CanFrame::remote_flag) != 0;
  const std::uint32_t length = frame.length > 8 ? 8u : frame.length;
  const std::uint32_t sent = remote ? 0u : length;
  // SOF, identifier, RTR, IDE, r0 and DLC are 19 bits. The 20th before them is nothing to the CRC, and a recessive one to the stuffer.
  const std::uint32_t header = (frame.id & 0x7FFu) << 7 | (remote ? 0x40u : 0u) | length;
  FrameWalk walk;
  walk.take(header >> 16, header >> 16 | 8u);
  for (int shift = 12; shift >= 0; shift -= 4) walk.take((header >> shift) & 0xFu);
  for (std::uint32_t i = 0; i < sent; ++i) {
    walk.take(frame.data[i] >> 4);
    walk.take(frame.data[i] & 0xFu);
  }
  // A 16th bit unlike the CRC's last completes no row.
  const std::uint32_t crc = walk.crc() << 1 | ((walk.crc() & 1u) ^ 1u);
  for (int shift = 12; shift >= 0; shift -= 4) walk.take((crc >> shift) & 0xFu);
  return stuffed_overhead_bits + 8 * sent + walk.stuff_bits() + plain_overhead_bits;
}

// Worst-case share of the bus in 0..1 (over 1: impossible) of `nodes` drives with an 8-byte RPDO and TPDO each, SYNC, and the heartbeats of the
// nodes and the master.
constexpr double worst_case_load(std::uint32_t nodes, double sync_hz, double heartbeat_hz, double bitrate) {
  const double cycle = 2.0 * nodes * worst_case_bits(8) + worst_case_bits(0);
  return (sync_hz * cycle + heartbeat_hz * (nodes + 1) * worst_case_bits(1)) / bitrate;
}

}  // namespace lf::canopen::bus_load
