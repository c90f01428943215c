#include "host_sim/devices/bus/can_bus.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "host_sim/devices/bus/can_bits.hpp"

namespace lf::devices {
namespace {

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data = {}) {
  CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), f.data.begin());
  return f;
}

std::string binary(std::uint32_t value, int width) {
  std::string s;
  for (int i = width - 1; i >= 0; --i) s += ((value >> i) & 1u) != 0 ? '1' : '0';
  return s;
}

// The standard's own words on strings: polynomial division, then stuffing.
std::uint32_t bits_by_the_book(const CanFrame& f) {
  std::string s = binary(f.id & 0x7FF, 12);  // the first is the start of frame
  s += binary(0, 3);
  s += binary(f.length, 4);
  for (int i = 0; i < f.length; ++i) s += binary(f.data[static_cast<std::size_t>(i)], 8);
  const std::string generator = "1100010110011001";  // x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
  std::string rest = s;
  rest.append(15, '0');
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (rest[i] == '0') continue;
    for (std::size_t k = 0; k < generator.size(); ++k) rest[i + k] = rest[i + k] == generator[k] ? '0' : '1';
  }
  s += rest.substr(s.size());
  std::string stuffed;
  for (const char bit : s) {
    stuffed += bit;
    const std::size_t n = stuffed.size();
    if (n >= 5 && stuffed.find_first_not_of(bit, n - 5) == std::string::npos) stuffed += bit == '0' ? '1' : '0';
  }
  return static_cast<std::uint32_t>(stuffed.size()) + 10;
}

TEST(CanBits, an_all_dominant_frame_takes_the_bits_counted_by_hand) {
  // 34 zeros from start of frame to CRC; a stuff bit after 5, 10, ... 30 of them; 10 bits of tail.
  EXPECT_EQ(frame_bits(frame(0)), 34u + 6u + 10u);
}

TEST(CanBits, bits_agree_with_the_standard_done_on_strings) {
  std::mt19937 random(20);
  SCOPED_TRACE("seed 20");
  for (int i = 0; i < 3000; ++i) {
    CanFrame f = frame(random() & 0x7FF);
    f.length = static_cast<std::uint8_t>(random() % 9);
    for (int k = 0; k < f.length; ++k) f.data[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(i % 3 == 0 ? 0 : random());
    ASSERT_EQ(frame_bits(f), bits_by_the_book(f)) << std::hex << f.id;
    ASSERT_LE(frame_bits(f) + interframe_bits, worst_case_bits(f.length));
  }
}

TEST(CanBits, the_worst_case_of_five_axes_at_250_hz_is_35_5_percent) {
  EXPECT_EQ(worst_case_bits(8), 135u);
  EXPECT_EQ(worst_case_bits(0), 55u);
  const double per_second = 250.0 * (10 * worst_case_bits(8) + worst_case_bits(0)) + 6 * 10 * worst_case_bits(1);
  EXPECT_NEAR(per_second / 1e6 * 100, 35.5, 0.05);
}

TEST(CanBus, the_lowest_identifier_that_waits_goes_next) {
  CanBus bus;
  bus.send(1, frame(0x300), Time{});
  bus.send(2, frame(0x181), Time::from_ns(1000));  // while 0x300 is on the wire
  bus.send(3, frame(0x081), Time::from_ns(2000));
  bus.send(4, frame(0x7FF), Time{});
  BusRecord r;
  std::vector<std::uint32_t> order;
  while (bus.next(Time::from_s(1), r)) order.push_back(r.frame.id);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x300, 0x081, 0x181, 0x7FF}));
}

// ISO 11898-1, bit by bit: SOF 1, identifier 11, RTR, IDE, r0 3, DLC 4, CRC 15, delimiter 1, ACK 2, EOF 7, interframe 3 = 47.
TEST(CanBits, a_frame_lies_between_its_length_without_stuff_bits_and_the_worst_case) {
  EXPECT_EQ(unstuffed_bits(frame(0x123)), 47u);
  EXPECT_EQ(unstuffed_bits(frame(0x123, {1, 2, 3})), 71u);
  EXPECT_EQ(unstuffed_bits(frame(0x123 | CanFrame::extended_flag)), 67u) << "SRR, r1 and 18 more bits of the identifier";
  CanFrame remote = frame(0x123 | CanFrame::remote_flag, {0, 0});
  EXPECT_EQ(unstuffed_bits(remote), 47u) << "a remote frame has a length and no data";
  for (std::uint32_t id = 0; id < 0x800; id += 7) {
    const CanFrame f = frame(id, {static_cast<std::uint8_t>(id), 0, 0xFF, static_cast<std::uint8_t>(id >> 3)});
    EXPECT_LE(unstuffed_bits(f), frame_bits(f) + interframe_bits) << id;
    EXPECT_LE(frame_bits(f) + interframe_bits, worst_case_bits(f)) << id;
    EXPECT_EQ(worst_case_bits(f), worst_case_bits(f.length)) << id;
  }
}

TEST(CanBus, tells_its_load_with_without_and_with_the_most_stuff_bits) {
  CanBus bus;
  // The same frame, whose content needs some stuff bits, back to back: the bus is full.
  const CanFrame f = frame(0x100, {0, 0, 1});
  for (int i = 0; i < 50; ++i) bus.send(1, f, Time{});
  BusRecord r;
  while (bus.next(Time::from_s(1), r)) {
  }
  const double sent = bits_by_the_book(f) + 3;
  ASSERT_GT(sent, 71);
  EXPECT_NEAR(bus.stats().load_percent, 100, 1e-9);
  EXPECT_NEAR(bus.stats().load_unstuffed_percent, 100 * 71 / sent, 1e-9);
  EXPECT_NEAR(bus.stats().load_worst_case_percent, 100 * (71 + 57 / 4) / sent, 1e-9);
}

TEST(CanBus, a_data_frame_wins_over_a_remote_one_and_both_over_an_extended_one) {
  const std::uint32_t base = 0x123;
  EXPECT_LT(arbitration_key(frame(base)), arbitration_key(frame(base | CanFrame::remote_flag)));
  EXPECT_LT(arbitration_key(frame(base | CanFrame::remote_flag)), arbitration_key(frame((base << 18) | CanFrame::extended_flag)));
  EXPECT_LT(arbitration_key(frame((base << 18) | CanFrame::extended_flag)), arbitration_key(frame(base + 1)));
}

TEST(CanBus, frames_follow_each_other_at_their_bits_plus_three) {
  CanBus bus;
  const CanFrame first = frame(0x100, {1, 2, 3}), second = frame(0x200, {4});
  bus.send(1, first, Time::from_ns(5000));
  bus.send(1, second, Time::from_ns(5000));
  BusRecord r;
  ASSERT_TRUE(bus.next(Time::from_s(1), r));
  EXPECT_EQ(r.delivered.ns(), 5000 + 1000 * bits_by_the_book(first));
  const std::int64_t start = r.delivered.ns() + 3000;
  ASSERT_TRUE(bus.next(Time::from_s(1), r));
  EXPECT_EQ(r.delivered.ns(), start + 1000 * bits_by_the_book(second));
  EXPECT_EQ(bus.stats().bits, bits_by_the_book(first) + bits_by_the_book(second) + 6);
  EXPECT_NEAR(bus.stats().load_percent, 100.0, 1e-9);
}

TEST(CanBus, nothing_is_delivered_before_its_last_bit) {
  CanBus bus;
  const CanFrame f = frame(0x100, {1, 2, 3});
  bus.send(1, f, Time{});
  BusRecord r;
  EXPECT_FALSE(bus.next(Time::from_ns(1000 * frame_bits(f) - 1), r));
  EXPECT_TRUE(bus.next(Time::from_ns(1000 * frame_bits(f)), r));
}

TEST(CanBus, a_dropped_identifier_takes_its_time_and_reaches_nobody) {
  CanBus bus;
  bus.drop(0x100, true);
  bus.send(1, frame(0x100), Time{});
  bus.send(1, frame(0x101), Time{});
  BusRecord r;
  ASSERT_TRUE(bus.next(Time::from_s(1), r));
  EXPECT_EQ(r.frame.id, 0x101u);
  EXPECT_EQ(r.delivered.ns(), 1000 * (frame_bits(frame(0x100)) + 3 + frame_bits(frame(0x101))));
  EXPECT_EQ(bus.stats().lost, 1u);
}

TEST(CanBus, destroyed_frames_are_sent_again_and_none_is_lost) {
  CanBus bus;
  bus.set_error_frames(true);
  BusRecord r;
  int delivered = 0;
  for (int i = 0; i < 320; ++i) {
    bus.send(1, frame(0x100, {static_cast<std::uint8_t>(i)}), Time::from_ns(i * 1'000'000));
    while (bus.next(Time::from_ns((i + 1) * 1'000'000), r)) ASSERT_EQ(r.frame.data[0], static_cast<std::uint8_t>(delivered++));
  }
  EXPECT_EQ(delivered, 320);
  EXPECT_EQ(bus.stats().errors, 320u / 15);  // every sixteenth attempt
}

TEST(CanBus, a_controller_off_the_bus_loses_what_waits_and_sends_nothing) {
  CanBus bus;
  bus.send(1, frame(0x100), Time{});
  bus.set_bus_off(1, true);
  EXPECT_FALSE(bus.send(1, frame(0x101), Time{}));
  BusRecord r;
  EXPECT_FALSE(bus.next(Time::from_s(1), r));
  EXPECT_EQ(bus.stats().lost, 2u);
  bus.set_bus_off(1, false);
  EXPECT_TRUE(bus.send(1, frame(0x102), Time{}));
  EXPECT_TRUE(bus.next(Time::from_s(1), r));
}

TEST(CanBus, a_full_queue_refuses_and_counts) {
  CanBus bus;
  for (std::size_t i = 0; i < CanBus::queue_capacity; ++i) ASSERT_TRUE(bus.send(9, frame(0x100), Time{}));
  EXPECT_FALSE(bus.send(9, frame(0x100), Time{}));
  EXPECT_TRUE(bus.send(8, frame(0x100), Time{}));
  EXPECT_EQ(bus.stats().lost, 1u);
}

}  // namespace
}  // namespace lf::devices
