// What a kernel does only when it is in trouble; its everyday behaviour is tested on real CAN stacks (tests/vcan).
#include "hal/vehicle/socket_can.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <algorithm>

#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal {
namespace {

using test::FakeLinux;

SocketCan::Config config_of() {
  SocketCan::Config config;
  config.filters = core_filters();
  return config;
}

FakeLinux::Arriving arriving(std::uint32_t id, std::int64_t stamp) {
  FakeLinux::Arriving frame;
  frame.frame.can_id = id;
  frame.frame.len = 8;
  frame.stamp = stamp;
  return frame;
}

std::vector<CanFrame> frames_of(std::size_t count) {
  std::vector<CanFrame> frames(count);
  for (std::size_t i = 0; i < count; ++i) {
    frames[i].id = static_cast<std::uint32_t>(0x200 + i);
    frames[i].length = 8;
  }
  return frames;
}

class SocketCanTest : public testing::Test {
 protected:
  SocketCanTest() { EXPECT_EQ(can.open(), port_ok); }
  FakeLinux linux_;
  SocketCan can{config_of(), linux_};
  ReceivedFrame received;
};

TEST_F(SocketCanTest, AsksForExactlyWhatTheCoreWants) {
  ASSERT_EQ(linux_.filters.size(), 57u);
  for (const can_filter& filter : linux_.filters) EXPECT_EQ(filter.can_mask, CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK);
  const auto wanted = [&](std::uint32_t id) {
    return std::any_of(linux_.filters.begin(), linux_.filters.end(),
                       [&](const can_filter& f) { return (id & f.can_mask) == (f.can_id & f.can_mask); });
  };
  for (const std::uint32_t id : {0x181U, 0x186U, 0x581U, 0x701U, 0x081U, 0x080U, 0x000U, 0x77FU, 0x201U, 0x306U, 0x405U, 0x502U, 0x601U})
    EXPECT_TRUE(wanted(id)) << std::hex << id;
  for (const std::uint32_t id : {0x207U, 0x281U, 0x607U, 0x187U, 0x702U + 5, 0x181U | CAN_RTR_FLAG, 0x181U | CAN_EFF_FLAG}) {
    EXPECT_FALSE(wanted(id)) << std::hex << id;
  }
  EXPECT_EQ(linux_.error_mask, CAN_ERR_MASK);
}

TEST_F(SocketCanTest, PutsTheKernelsTimeOnTheMonotonicClock) {
  linux_.pass(5'000'000);
  linux_.arriving.push_back(arriving(0x181, linux_.realtime - 1'000'000));
  ASSERT_EQ(can.receive(received), port_ok);
  EXPECT_EQ(received.t.ns(), linux_.monotonic - 1'000'000);
}

TEST_F(SocketCanTest, AJumpOfTheWallClockSpoilsNoTime) {
  for (const std::int64_t jump : {std::int64_t{3'600'000'000'000}, std::int64_t{-3'600'000'000'000}}) {
    EXPECT_EQ(can.receive(received), port_empty);
    linux_.pass(4'000'000);
    linux_.arriving.push_back(arriving(0x181, linux_.realtime - 1'000'000));
    linux_.realtime += jump;
    ASSERT_EQ(can.receive(received), port_ok);
    EXPECT_EQ(received.t.ns(), linux_.monotonic) << jump;
  }
  EXPECT_EQ(can.stats().stamps_missed, 2u);
}

TEST_F(SocketCanTest, CountsWhatOverflowedTheQueue) {
  linux_.arriving.push_back(arriving(0x181, linux_.realtime));
  linux_.arriving.back().overflow = 7;
  linux_.arriving.push_back(arriving(0x181, linux_.realtime));
  linux_.arriving.back().overflow = 9;
  while (can.receive(received) == port_ok) {
  }
  EXPECT_EQ(can.stats().overflowed, 9u);
}

TEST_F(SocketCanTest, AFrameOfAnotherSizeIsNoFrame) {
  linux_.arriving.push_back(arriving(0x181, 0));
  linux_.arriving.back().bytes = 72;  // CAN FD
  EXPECT_EQ(can.receive(received), port_empty);
  EXPECT_EQ(can.stats().malformed, 1u);
}

TEST_F(SocketCanTest, WaitsInOrderForAFullControllerAndDropsWhatIsLate) {
  linux_.room = 10;
  EXPECT_EQ(can.send(frames_of(20)), port_ok);
  EXPECT_EQ(linux_.sent.size(), 10u);
  EXPECT_EQ(can.waiting(), 10u);
  linux_.pass(1'000'000);
  linux_.room = 4;
  EXPECT_EQ(can.flush(), port_ok);
  ASSERT_EQ(linux_.sent.size(), 14u);
  for (std::size_t i = 0; i < 14; ++i) EXPECT_EQ(linux_.sent[i].can_id, 0x200 + i);
  linux_.pass(4'000'000);
  linux_.room = 100;
  EXPECT_EQ(can.send(frames_of(1)), ENOBUFS);  // told once
  EXPECT_EQ(can.stats().expired, 6u);
  EXPECT_EQ(linux_.sent.back().can_id, 0x200u);
  EXPECT_EQ(can.send(frames_of(1)), port_ok);
}

// A queue of a thousand frames took set points for a tenth of a second before a quick stop.
TEST_F(SocketCanTest, PutsNothingBehindFramesThatTheKernelHasHeldForADeadline) {
  EXPECT_GT(linux_.send_buffer, 0) << "the kernel's own queue takes hundreds of frames";
  EXPECT_LE(linux_.send_buffer, 32 * 768);
  linux_.queued_bytes = 10 * 768;  // the bus takes nothing
  EXPECT_EQ(can.send(frames_of(10)), port_ok);
  EXPECT_EQ(linux_.sent.size(), 10u);
  linux_.pass(5'000'000);
  EXPECT_EQ(can.send(frames_of(10)), port_ok);
  EXPECT_EQ(linux_.sent.size(), 10u);
  EXPECT_EQ(can.stats().stuck, 1u);
  linux_.pass(5'000'000);
  EXPECT_EQ(can.flush(), ENOBUFS);
  EXPECT_EQ(can.stats().expired, 10u);
  linux_.queued_bytes = 0;
  EXPECT_EQ(can.send(frames_of(3)), port_ok);
  EXPECT_EQ(linux_.sent.size(), 13u);
}

TEST_F(SocketCanTest, RefusesMoreThanCanWait) {
  linux_.room = 0;
  EXPECT_EQ(can.send(frames_of(100)), port_ok);
  EXPECT_EQ(can.send(frames_of(100)), ENOBUFS);
  EXPECT_EQ(can.waiting(), 128u);
  EXPECT_EQ(can.stats().refused, 72u);
}

TEST_F(SocketCanTest, AnInterfaceThatIsDownIsToldAndNothingOldIsSentLater) {
  linux_.receive_error = ENETDOWN;
  linux_.send_error = ENETDOWN;
  EXPECT_EQ(can.receive(received), ENETDOWN);
  EXPECT_EQ(can.send(frames_of(3)), ENETDOWN);
  EXPECT_EQ(can.waiting(), 0u);
  linux_.send_error = 0;
  EXPECT_EQ(can.send(frames_of(1)), port_ok);
  EXPECT_EQ(linux_.sent.size(), 1u);
  EXPECT_EQ(can.stats().downs, 1u);
}

TEST_F(SocketCanTest, AnInterfaceThatGoesAwayIsFoundAgain) {
  linux_.receive_error = ENODEV;
  linux_.interface_there = false;
  EXPECT_EQ(can.receive(received), ENODEV);
  EXPECT_EQ(can.send(frames_of(2)), ENODEV);
  linux_.pass(150'000'000);
  EXPECT_EQ(can.receive(received), ENODEV);
  linux_.interface_there = true;
  linux_.pass(150'000'000);
  linux_.arriving.push_back(arriving(0x182, linux_.realtime));
  EXPECT_EQ(can.receive(received), port_ok);
  EXPECT_EQ(received.frame.id, 0x182u);
  EXPECT_EQ(can.stats().losses, 1u);
  EXPECT_EQ(can.stats().reopened, 1u);
  EXPECT_EQ(linux_.open_sockets, 1);
}

TEST_F(SocketCanTest, ErrorFramesAreHandedOnAndCountedByWhatTheySay) {
  FakeLinux::Arriving error = arriving(CAN_ERR_FLAG | CAN_ERR_BUSOFF | CAN_ERR_CRTL, linux_.realtime);
  error.frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
  linux_.arriving.push_back(error);
  ASSERT_EQ(can.receive(received), port_ok);
  EXPECT_NE(received.frame.id & CanFrame::error_flag, 0u);
  EXPECT_EQ(can.stats().errors.bus_off, 1u);
  EXPECT_EQ(can.stats().errors.passive, 1u);
  EXPECT_EQ(can.stats().received, 0u);
  EXPECT_EQ(describe_can_error(received.frame), "bus off, transmit error passive");
}

TEST(SocketCanOpen, SaysWhatIsMissing) {
  FakeLinux linux_;
  linux_.has_can = false;
  EXPECT_EQ(SocketCan(config_of(), linux_).open(), EAFNOSUPPORT);
  linux_.has_can = true;
  linux_.interface_there = false;
  EXPECT_EQ(SocketCan(config_of(), linux_).open(), ENODEV);
  EXPECT_EQ(linux_.open_sockets, 0);
  linux_.interface_there = true;
  linux_.interface_up = false;
  EXPECT_EQ(SocketCan(config_of(), linux_).open(), ENETDOWN);
}

}  // namespace
}  // namespace lf::hal
