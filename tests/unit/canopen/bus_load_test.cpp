// Frame lengths against a slow second implementation on strings, and the load against the published figures.
#include "firmware/canopen/bus_load.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "firmware/canopen/codec.hpp"

namespace lf::canopen {
namespace {

std::string binary(std::uint32_t value, int bits) {
  std::string text;
  for (int i = bits - 1; i >= 0; --i) text += ((value >> i) & 1) != 0 ? '1' : '0';
  return text;
}

// Remainder of the bits times x^15 by long division.
std::string crc_by_division(std::string bits) {
  const std::string divisor = "1100010110011001";
  const std::size_t n = bits.size();
  bits += std::string(15, '0');
  for (std::size_t i = 0; i < n; ++i) {
    if (bits[i] == '0') continue;
    for (std::size_t k = 0; k < divisor.size(); ++k) bits[i + k] = bits[i + k] == divisor[k] ? '0' : '1';
  }
  return bits.substr(n);
}

std::size_t slow_length(const CanFrame& frame) {
  const bool remote = (frame.id & CanFrame::remote_flag) != 0;
  std::string bits(1, '0');
  bits.append(binary(frame.id & 0x7FF, 11)).append(1, remote ? '1' : '0').append(2, '0').append(binary(frame.length, 4));
  for (int i = 0; i < (remote ? 0 : frame.length); ++i) bits += binary(frame.data[static_cast<std::size_t>(i)], 8);
  bits += crc_by_division(bits);
  std::string stuffed;
  for (const char bit : bits) {
    stuffed += bit;
    const std::size_t n = stuffed.size();
    if (n >= 5 && stuffed.substr(n - 5) == std::string(5, bit)) {
      // A stuff bit starts a run of its own, so runs before it are cut by it being the other kind.
      stuffed += bit == '0' ? '1' : '0';
    }
  }
  return stuffed.size() + 13;
}

TEST(BusLoad, FrameLengthsAreThoseOfAnIndependentBitStuffer) {
  const unsigned seed = 20251121;
  std::mt19937 random(seed);
  SCOPED_TRACE(seed);
  for (int n = 0; n < 20'000; ++n) {
    CanFrame frame = empty_frame(random() & 0x7FF, static_cast<std::uint8_t>(random() % 9));
    const bool monotone = random() % 3 == 0;
    for (std::uint8_t i = 0; i < frame.length; ++i)
      frame.data[i] = monotone ? (random() % 2 == 0 ? 0x00 : 0xFF) : static_cast<std::uint8_t>(random());
    ASSERT_EQ(bus_load::exact_bits(frame), slow_length(frame)) << "frame " << n;
    ASSERT_LE(bus_load::exact_bits(frame), bus_load::worst_case_bits(frame.length));
    ASSERT_GE(bus_load::exact_bits(frame), 47u + 8u * frame.length);
    frame.id |= CanFrame::remote_flag;
    ASSERT_EQ(bus_load::exact_bits(frame), slow_length(frame)) << "frame " << n << ", remote";
  }
}

TEST(BusLoad, WorstCaseOfFiveNodesIsTheFieldsFigures) {
  const auto percent = [](double hz) { return 100 * bus_load::worst_case_load(5, hz, 10, 1e6); };
  EXPECT_NEAR(percent(200), 28.5, 0.05);
  EXPECT_NEAR(percent(250), 35.5, 0.05);
  EXPECT_NEAR(percent(400), 56.6, 0.05);
  EXPECT_NEAR(percent(500), 70.6, 0.05);
  EXPECT_GT(percent(1000), 100);
  EXPECT_EQ(bus_load::worst_case_bits(8), 135u);  // Davis et al. 2007
  EXPECT_EQ(bus_load::worst_case_bits(0), 55u);
}

TEST(Codec, FieldsAreLittleEndianAndSigned) {
  CanFrame frame;
  put<std::int32_t>(frame, 2, -2);
  put<std::uint16_t>(frame, 0, 0x1234);
  put<std::int8_t>(frame, 7, -128);
  const std::array<std::uint8_t, 8> expected{0x34, 0x12, 0xFE, 0xFF, 0xFF, 0xFF, 0x00, 0x80};
  EXPECT_EQ(frame.data, expected);
  EXPECT_EQ(get<std::int32_t>(frame, 2), -2);
  EXPECT_EQ(get<std::uint16_t>(frame, 0), 0x1234);
  EXPECT_EQ(get<std::int8_t>(frame, 7), -128);
  EXPECT_EQ(get<std::int16_t>(frame, 2), -2);
}

}  // namespace
}  // namespace lf::canopen
