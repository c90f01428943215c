#include "host_sim/devices/bus/can_bits.hpp"

#include <algorithm>

namespace lf::devices {
namespace {

constexpr std::uint32_t crc_bits = 15;
constexpr std::uint32_t unstuffed_tail_bits = 10;  // CRC delimiter, ACK slot and delimiter, end of frame

// Start of frame, identifier, control bits, length and CRC: what is stuffed besides the data.
std::uint32_t stuffed_header_bits(const CanFrame& frame) { return (frame.id & CanFrame::extended_flag) != 0 ? 54 : 34; }

// Counts stuff bits and runs the frame's CRC-15 while bits are sent.
class Wire {
 public:
  void send(std::uint32_t value, std::uint32_t width) {
    for (std::uint32_t i = width; i-- > 0;) {
      const std::uint32_t bit = (value >> i) & 1u;
      crc_ = ((crc_ << 1) ^ ((((crc_ >> 14) ^ bit) & 1u) * 0x4599u)) & 0x7FFFu;
      count(bit);
    }
  }

  void send_crc() {
    for (std::uint32_t i = crc_bits; i-- > 0;) count((crc_ >> i) & 1u);
  }

  std::uint32_t bits() const { return bits_; }

 private:
  // After five equal bits the sender adds one of the other level, which counts for the next run.
  void count(std::uint32_t bit) {
    ++bits_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ == 5) {
      ++bits_;
      last_ = 1 - bit;
      run_ = 1;
    }
  }

  std::uint32_t crc_ = 0;
  std::uint32_t bits_ = 0;
  std::uint32_t run_ = 0;
  std::uint32_t last_ = 2;  // no level yet
};

}  // namespace

std::uint32_t frame_bits(const CanFrame& frame) {
  const bool remote = (frame.id & CanFrame::remote_flag) != 0;
  const std::uint32_t length = std::min<std::uint32_t>(frame.length, 8);
  Wire wire;
  wire.send(0, 1);  // start of frame
  if ((frame.id & CanFrame::extended_flag) != 0) {
    wire.send((frame.id >> 18) & 0x7FFu, 11);
    wire.send(3, 2);  // SRR, IDE
    wire.send(frame.id & 0x3FFFFu, 18);
    wire.send(remote ? 4 : 0, 3);  // RTR, r1, r0
  } else {
    wire.send(frame.id & 0x7FFu, 11);
    wire.send(remote ? 4 : 0, 3);  // RTR, IDE, r0
  }
  wire.send(length, 4);
  if (!remote) {
    for (std::uint32_t i = 0; i < length; ++i) wire.send(frame.data[i], 8);
  }
  wire.send_crc();
  return wire.bits() + unstuffed_tail_bits;
}

std::uint32_t unstuffed_bits(const CanFrame& frame) {
  const bool remote = (frame.id & CanFrame::remote_flag) != 0;
  return stuffed_header_bits(frame) + (remote ? 0 : 8 * std::min<std::uint32_t>(frame.length, 8)) + unstuffed_tail_bits + interframe_bits;
}

std::uint32_t worst_case_bits(const CanFrame& frame) {
  const std::uint32_t bits = unstuffed_bits(frame);
  return bits + (bits - unstuffed_tail_bits - interframe_bits - 1) / 4;
}

std::uint32_t arbitration_key(const CanFrame& frame) {
  const std::uint32_t remote = (frame.id & CanFrame::remote_flag) != 0 ? 1u : 0u;
  if ((frame.id & CanFrame::extended_flag) == 0) return ((frame.id & 0x7FFu) << 21) | (remote << 20);
  const std::uint32_t base = (frame.id >> 18) & 0x7FFu;
  return (base << 21) | (3u << 19) | ((frame.id & 0x3FFFFu) << 1) | remote;
}

}  // namespace lf::devices
