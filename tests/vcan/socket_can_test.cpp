// SocketCan against the kernel's own CAN stack: what passes, what is counted, and what happens when the queue is full or the interface goes.
// Run as root of a network of its own (lanternfish_guest_test): it makes and removes interfaces.
#include "hal/vehicle/socket_can.hpp"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <set>
#include <thread>

#include "hal/heap_guard/heap_guard.hpp"
#include "tests/vcan/raw_peer.hpp"

namespace lf::hal {
namespace {

using test::RawPeer;
using test::shell;

constexpr const char* bus = "lftest0";

Time monotonic_now() { return Time::from_ns(linux_calls().monotonic_ns()); }

class SocketCanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (add_interface()) return;
    ASSERT_EQ(std::getenv("LANTERNFISH_GUEST"), nullptr) << "a guest without vcan";
    GTEST_SKIP() << "no vcan here: run it through ctest -L vcan";
  }
  void TearDown() override { (void)shell("ip link del " + std::string(bus) + " 2>/dev/null"); }

  static bool add_interface() { return shell("ip link add dev lftest0 type vcan && ip link set lftest0 up"); }

  static SocketCan::Config config(std::vector<CanFilter> filters = {}) {
    SocketCan::Config c;
    c.interface = bus;
    c.filters = std::move(filters);
    return c;
  }

  // All that comes until the bus is quiet.
  static std::vector<ReceivedFrame> drain(SocketCan& can) {
    std::vector<ReceivedFrame> all;
    while (can.wait_readable(monotonic_now() + Duration::from_ms(30))) {
      for (ReceivedFrame one; can.receive(one) == port_ok;) all.push_back(one);
    }
    return all;
  }

  // The first answer but "nothing to take", within half a second.
  static PortStatus answer(SocketCan& can) {
    ReceivedFrame ignored;
    const Time until = monotonic_now() + Duration::from_ms(500);
    while (monotonic_now() < until) {
      if (const PortStatus status = can.receive(ignored); status != port_empty) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return port_empty;
  }
};

CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> data = {}) {
  CanFrame f;
  f.id = id;
  for (const std::uint8_t byte : data) f.data[f.length++] = byte;
  return f;
}

TEST_F(SocketCanTest, CarriesEveryKindOfFrameUnchangedAndInOrder) {
  SocketCan one(config()), other(config());
  ASSERT_EQ(one.open(), port_ok);
  ASSERT_EQ(other.open(), port_ok);
  const std::vector<CanFrame> sent{frame(0x000), frame(0x7FF, {1, 2, 3, 4, 5, 6, 7, 8}), frame(CanFrame::extended_flag | 0x1ABCDEF, {0xFF}),
                                   frame(CanFrame::remote_flag | 0x701), frame(0x080)};
  ASSERT_EQ(one.send(sent), port_ok);
  const std::vector<ReceivedFrame> received = drain(other);
  ASSERT_EQ(received.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(received[i].frame, sent[i]) << i;
  EXPECT_TRUE(drain(one).empty()) << "a sender must not hear itself";
  EXPECT_EQ(one.stats().sent, sent.size());
  EXPECT_EQ(other.stats().received, sent.size());
}

TEST_F(SocketCanTest, TheCoresFiltersLetThroughItsNodesAnswersAndWhatAMasterSends) {
  SocketCan can(config(core_filters()));
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  std::set<std::uint32_t> expected{0x000, 0x080, 0x77F};
  for (std::uint32_t node = 1; node <= 6; ++node) {
    expected.insert({0x080 + node, 0x180 + node, 0x580 + node, 0x700 + node});
    expected.insert({0x200 + node, 0x300 + node, 0x400 + node, 0x500 + node, 0x600 + node});  // a second master's
  }
  std::set<std::uint32_t> heard;
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    ASSERT_TRUE(peer.send(id));
    ASSERT_TRUE(peer.send(id | CAN_EFF_FLAG));
    ASSERT_TRUE(peer.send(id | CAN_RTR_FLAG));
    for (ReceivedFrame one; can.receive(one) == port_ok;) heard.insert(one.frame.id);
  }
  EXPECT_EQ(heard, expected);
}

TEST_F(SocketCanTest, AFramesTimeIsWhenTheKernelGotItNotWhenItWasTaken) {
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  const Time before = monotonic_now();
  ASSERT_TRUE(peer.send(0x181, {1}));
  const Time after = monotonic_now();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ReceivedFrame received;
  ASSERT_EQ(can.receive(received), port_ok);
  // The kernel stamps wall-clock time; the two clocks are read one after the other when it is translated.
  const Duration reading = Duration::from_us(300);
  EXPECT_GE(received.t, before - reading);
  EXPECT_LE(received.t, after + reading);
  EXPECT_EQ(can.stats().stamps_missed, 0u);
}

TEST_F(SocketCanTest, AJumpOfTheWallClockSpoilsNoFramesTime) {
  const char* guest = std::getenv("LANTERNFISH_GUEST");
  if (guest == nullptr || std::string(guest) == "kernel") GTEST_SKIP() << "would set this machine's clock";
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  for (const int jump_s : {3600, -7200, 1}) {
    const Time before = monotonic_now();
    ASSERT_TRUE(peer.send(0x181, {1}));
    ASSERT_TRUE(can.wait_readable(before + Duration::from_ms(500))) << "the kernel may pass it on a little later";
    timespec wall{};
    ASSERT_EQ(clock_gettime(CLOCK_REALTIME, &wall), 0);
    wall.tv_sec += jump_s;
    ASSERT_EQ(clock_settime(CLOCK_REALTIME, &wall), 0);
    ReceivedFrame received;
    ASSERT_EQ(can.receive(received), port_ok);
    EXPECT_GE(received.t, before - Duration::from_ms(1)) << jump_s;
    EXPECT_LE(received.t, monotonic_now()) << jump_s;
    ASSERT_EQ(can.receive(received), port_empty);
  }
  EXPECT_EQ(can.stats().stamps_missed, 3u);
}

TEST_F(SocketCanTest, CountsEveryFrameThatOverflowedItsQueue) {
  SocketCan::Config small = config();
  small.receive_buffer_bytes = 4096;
  SocketCan can(small);
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  constexpr unsigned count = 300;  // over 1000 at once, the kernel itself would lose some before the socket (netdev_max_backlog)
  for (unsigned i = 0; i < count; ++i) ASSERT_TRUE(peer.send(0x181, {static_cast<std::uint8_t>(i)}));
  const std::size_t kept = drain(can).size();
  ASSERT_LT(kept, count);
  ASSERT_TRUE(peer.send(0x182));  // what was lost is told with the next frame
  EXPECT_EQ(drain(can).size(), 1u);
  EXPECT_EQ(can.stats().received, kept + 1);
  EXPECT_EQ(can.stats().overflowed, count - kept);
}

TEST_F(SocketCanTest, WhatAFullControllerDoesNotTakeWaitsInOrder) {
  // A bus of 1 Mbit/s takes some 8000 frames (of 16 bytes here) a second; behind it a queue of ten.
  ASSERT_TRUE(shell("tc qdisc add dev lftest0 root tbf rate 1024kbit burst 32 limit 160"));
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  std::vector<CanFrame> orders;
  for (std::uint8_t i = 0; i < 26; ++i) orders.push_back(frame(0x201, {i}));
  EXPECT_EQ(can.send(orders), port_ok);
  EXPECT_GT(can.waiting(), 0u);
  EXPECT_GE(can.stats().full, 1u);
  for (int turn = 0; turn < 30 && can.waiting() > 0; ++turn) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    EXPECT_EQ(can.flush(), port_ok);
  }
  for (std::uint8_t i = 0; i < 26; ++i) {
    const std::optional<can_frame> heard = peer.receive();
    ASSERT_TRUE(heard) << int{i};
    EXPECT_EQ(heard->data[0], i);
  }
  EXPECT_EQ(can.stats().sent, 26u);
  EXPECT_EQ(can.stats().expired, 0u);
}

TEST_F(SocketCanTest, WhatCannotBeSentByItsDeadlineIsDroppedAndCounted) {
  ASSERT_TRUE(shell("tc qdisc add dev lftest0 root tbf rate 8kbit burst 16 limit 32"));  // a frame in 16 ms
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  std::vector<CanFrame> orders(10, frame(0x201));
  EXPECT_EQ(can.send(orders), port_ok);
  const std::uint64_t taken = can.stats().sent;
  ASSERT_LT(taken, 10u);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(can.flush(), ENOBUFS);
  EXPECT_EQ(can.waiting(), 0u);
  EXPECT_EQ(can.stats().expired, 10u - taken);
  EXPECT_EQ(can.flush(), port_ok) << "a drop is told once";
  // Queue room is bounded, too.
  orders.assign(300, frame(0x201));
  EXPECT_EQ(can.send(orders), ENOBUFS);
  EXPECT_EQ(can.stats().sent - taken + can.waiting() + can.stats().refused, 300u);
}

TEST_F(SocketCanTest, TellsOfAnInterfaceThatWentDownAndWorksAgainWhenItIsUp) {
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  ASSERT_TRUE(shell("ip link set lftest0 down"));
  EXPECT_EQ(answer(can), ENETDOWN);
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENETDOWN);
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENETDOWN);
  EXPECT_EQ(can.stats().downs, 1u);
  EXPECT_EQ(can.stats().refused, 2u);

  ASSERT_TRUE(shell("ip link set lftest0 up"));
  RawPeer peer(bus);
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), port_ok);
  ASSERT_TRUE(peer.receive());
  ASSERT_TRUE(peer.send(0x181));
  EXPECT_EQ(drain(can).size(), 1u);
  EXPECT_EQ(can.stats().losses, 0u);
}

TEST_F(SocketCanTest, CountsTheInterfaceDownOnceWhoeverMeetsItFirst) {
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  for (std::uint32_t times = 1; times <= 2; ++times) {
    ASSERT_TRUE(shell("ip link set lftest0 down"));
    EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENETDOWN);
    ReceivedFrame ignored;
    (void)can.receive(ignored);
    EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENETDOWN);
    EXPECT_EQ(can.stats().downs, times);
    ASSERT_TRUE(shell("ip link set lftest0 up"));
    EXPECT_EQ(can.send(std::vector{frame(0x80)}), port_ok);
  }
}

TEST_F(SocketCanTest, OpensAnInterfaceThatIsStillDown) {
  ASSERT_TRUE(shell("ip link set lftest0 down"));
  SocketCan can(config());
  EXPECT_EQ(can.open(), ENETDOWN);
  EXPECT_TRUE(can.is_open());
  ASSERT_TRUE(shell("ip link set lftest0 up"));
  RawPeer peer(bus);
  ASSERT_TRUE(peer.send(0x181));
  EXPECT_EQ(drain(can).size(), 1u);
}

TEST_F(SocketCanTest, FindsAnInterfaceThatWasRemovedAndMadeAnew) {
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  ASSERT_TRUE(shell("ip link del lftest0"));
  // Removing takes it down first.
  PortStatus status = answer(can);
  if (status == ENETDOWN) status = answer(can);
  EXPECT_EQ(status, ENODEV);
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENODEV);
  ReceivedFrame ignored;
  EXPECT_EQ(can.receive(ignored), ENODEV);
  EXPECT_EQ(can.stats().losses, 1u);

  ASSERT_TRUE(add_interface());
  RawPeer peer(bus);
  const Time until = monotonic_now() + Duration::from_ms(500);
  while (!can.is_open() && monotonic_now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
    (void)can.receive(ignored);
  }
  ASSERT_TRUE(can.is_open());
  ASSERT_TRUE(peer.send(0x181));
  EXPECT_EQ(drain(can).size(), 1u);
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), port_ok);
  EXPECT_EQ(can.stats().reopened, 1u);
}

TEST_F(SocketCanTest, ASenderAloneNoticesThatItsInterfaceWasRemoved) {
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  ASSERT_TRUE(shell("ip link del lftest0"));
  EXPECT_EQ(can.send(std::vector{frame(0x80)}), ENODEV);
  EXPECT_FALSE(can.is_open());
}

TEST_F(SocketCanTest, ErrorFramesAreHandedOnAndCountedByWhatTheySay) {
  SocketCan can(config(core_filters()));
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  ASSERT_TRUE(peer.send(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(peer.send(CAN_ERR_FLAG | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_RX_PASSIVE, 0, 0, 0, 0, 0, 130}));
  ASSERT_TRUE(peer.send(CAN_ERR_FLAG | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(peer.send(CAN_ERR_FLAG | CAN_ERR_ACK, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(peer.send(CAN_ERR_FLAG | CAN_ERR_RESTARTED, {0, 0, 0, 0, 0, 0, 0, 0}));
  const std::vector<ReceivedFrame> received = drain(can);
  ASSERT_EQ(received.size(), 5u);
  for (const ReceivedFrame& one : received) EXPECT_TRUE((one.frame.id & CanFrame::error_flag) != 0);
  EXPECT_EQ(can.stats().received, 0u) << "no data frames";
  const CanErrorCounts& errors = can.stats().errors;
  EXPECT_EQ(errors.frames, 5u);
  EXPECT_EQ(errors.bus_off, 1u);
  EXPECT_EQ(errors.passive, 1u);
  EXPECT_EQ(errors.overrun, 1u);
  EXPECT_EQ(errors.no_acknowledge, 1u);
  EXPECT_EQ(errors.restarted, 1u);
}

TEST_F(SocketCanTest, AnInterfaceThatIsNotThereIsRefusedWithWhatToDo) {
  SocketCan::Config missing;
  missing.interface = "lfnone0";
  EXPECT_EQ(SocketCan(missing).open(), ENODEV);
  EXPECT_NE(SocketCan::explain(ENODEV, "lfnone0").find("ip link"), std::string::npos);
  missing.interface = std::string(40, 'x');
  EXPECT_EQ(SocketCan(missing).open(), ENODEV);
  missing.interface = "";
  EXPECT_EQ(SocketCan(missing).open(), ENODEV);
}

TEST_F(SocketCanTest, AControlTurnMakesNoHeapCall) {
  SocketCan can(config(core_filters()));
  ASSERT_EQ(can.open(), port_ok);
  RawPeer peer(bus);
  const std::vector<CanFrame> orders(26, frame(0x201, {1, 2, 3, 4}));
  const std::uint64_t before = HeapGuard::calls();
  for (int turn = 0; turn < 100; ++turn) {
    for (std::uint32_t node = 1; node <= 6; ++node) ASSERT_TRUE(peer.send(0x180 + node, {1, 2, 3, 4, 5, 6, 7, 8}));
    CoreSection counted;
    for (ReceivedFrame one; can.receive(one) == port_ok;) {
    }
    (void)can.send(orders);
  }
  EXPECT_EQ(can.stats().received, 600u);
  EXPECT_EQ(HeapGuard::calls() - before, 0u);
}

}  // namespace
}  // namespace lf::hal
