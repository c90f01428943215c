// Length of a classic CAN frame with an 11-bit identifier on the wire, worst case and exact, and the load of a bus.
//
// ISO 11898-1: SOF, identifier, RTR, IDE, r0, DLC, data and CRC are stuffed: after five equal bits one of the other kind follows, and counts in the next
// run. CRC delimiter, ACK slot and delimiter, EOF and three bits of interframe space are not. Worst case: Tindell, Burns, Wellings 1995, as corrected by
// Davis, Burns, Bril, Lukkien 2007: a stuff bit for each four bits after the first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/messages/can_frame.hpp"

namespace lf::canopen::bus_load {

inline constexpr std::uint32_t stuffed_overhead_bits = 34;  // SOF 1, identifier 11, RTR 1, IDE 1, r0 1, DLC 4, CRC 15
inline constexpr std::uint32_t plain_overhead_bits = 13;    // CRC delimiter 1, ACK 2, EOF 7, interframe space 3

constexpr std::uint32_t worst_case_bits(std::uint8_t data_bytes) {
  const std::uint32_t stuffed = stuffed_overhead_bits + 8u * data_bytes;
  return stuffed + plain_overhead_bits + (stuffed - 1) / 4;
}

// The bits from SOF to the end of the CRC, before stuffing.
class FrameBits {
 public:
  constexpr explicit FrameBits(const CanFrame& frame) {
    const std::uint8_t length = frame.length > 8 ? std::uint8_t{8} : frame.length;
    append(0, 1);
    append(frame.id & 0x7FFu, 11);
    append((frame.id & CanFrame::remote_flag) != 0 ? 1 : 0, 1);
    append(0, 2);
    append(length, 4);
    if ((frame.id & CanFrame::remote_flag) == 0) {
      for (std::uint8_t i = 0; i < length; ++i) append(frame.data[i], 8);
    }
    append(crc15(), 15);
  }

  constexpr std::uint32_t size() const { return size_; }

  constexpr std::uint32_t stuff_bits() const {
    std::uint32_t stuffed = 0;
    std::uint32_t run = 0;
    bool last = true;  // the idle bus is recessive
    for (std::uint32_t i = 0; i < size_; ++i) {
      const bool bit = bits_[i];
      run = bit == last ? run + 1 : 1;
      last = bit;
      if (run < 5) continue;
      ++stuffed;
      last = !bit;  // the stuff bit opens the next run
      run = 1;
    }
    return stuffed;
  }

 private:
  constexpr void append(std::uint32_t value, std::uint32_t count) {
    for (std::uint32_t i = count; i > 0; --i) bits_[size_++] = ((value >> (i - 1)) & 1u) != 0;
  }

  // x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1, from SOF to the end of the data.
  constexpr std::uint32_t crc15() const {
    std::uint32_t crc = 0;
    for (std::uint32_t i = 0; i < size_; ++i) {
      const bool invert = bits_[i] != ((crc & 0x4000u) != 0);
      crc = (crc << 1) & 0x7FFFu;
      if (invert) crc ^= 0x4599u;
    }
    return crc;
  }

  std::array<bool, 98> bits_{};
  std::uint32_t size_ = 0;
};

// Bits on the wire of this very frame, interframe space included. O(bits); about 0.2 us.
constexpr std::uint32_t exact_bits(const CanFrame& frame) {
  const FrameBits bits(frame);
  return bits.size() + bits.stuff_bits() + plain_overhead_bits;
}

// Worst-case share of the bus in 0..1 (over 1: impossible) of `nodes` drives with an 8-byte RPDO and TPDO each, SYNC, and the heartbeats of the
// nodes and the master.
constexpr double worst_case_load(std::uint32_t nodes, double sync_hz, double heartbeat_hz, double bitrate) {
  const double cycle = 2.0 * nodes * worst_case_bits(8) + worst_case_bits(0);
  return (sync_hz * cycle + heartbeat_hz * (nodes + 1) * worst_case_bits(1)) / bitrate;
}

}  // namespace lf::canopen::bus_load
