// SocketCan on a real controller's driver: kvaser_pci's two SJA1000 as can0 and can1 on one bus. What a virtual interface cannot show: a transmit queue
// that a controller empties, and the restart of a controller. Run as root of the guest of run_in_qemu.sh.
#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "hal/vehicle/can_restart.hpp"
#include "hal/vehicle/socket_can.hpp"
#include "tests/vcan/raw_peer.hpp"

namespace lf::hal {
namespace {

using test::RawPeer;
using test::shell;

class CanCardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* guest = std::getenv("LANTERNFISH_GUEST");
    if (guest == nullptr || std::string(guest) != "qemu") GTEST_SKIP() << "no CAN cards here: run it through ctest -L qemu";
    ASSERT_TRUE(shell("ip link set can0 txqueuelen 32"));
  }

  static SocketCan::Config config() {
    SocketCan::Config c;
    c.interface = "can0";
    return c;
  }
};

std::vector<CanFrame> orders(unsigned count) {
  std::vector<CanFrame> frames(count);
  for (unsigned i = 0; i < count; ++i) {
    frames[i].id = 0x201;
    frames[i].length = 8;
    frames[i].data[0] = static_cast<std::uint8_t>(i);
  }
  return frames;
}

TEST_F(CanCardTest, AShortTransmitQueueLosesNothingAndKeepsTheOrder) {
  ASSERT_TRUE(shell("ip link set can0 txqueuelen 4"));
  RawPeer peer("can1");
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  ASSERT_EQ(can.send(orders(26)), port_ok);
  for (int turn = 0; turn < 100 && can.waiting() > 0; ++turn) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    ASSERT_EQ(can.flush(), port_ok);
  }
  for (unsigned i = 0; i < 26; ++i) {
    const std::optional<can_frame> heard = peer.receive();
    ASSERT_TRUE(heard) << i;
    EXPECT_EQ(heard->data[0], i);
  }
  EXPECT_EQ(can.stats().sent, 26u);
  EXPECT_EQ(can.stats().expired + can.stats().refused, 0u);
}

TEST_F(CanCardTest, TheSameSocketWorksAfterTheControllerWasDownAndUp) {
  RawPeer peer("can1");
  SocketCan can(config());
  ASSERT_EQ(can.open(), port_ok);
  ASSERT_TRUE(shell("ip link set can0 down"));
  EXPECT_EQ(can.send(orders(1)), ENETDOWN);
  EXPECT_EQ(can.stats().downs, 1u);
  ASSERT_TRUE(shell("ip link set can0 up"));
  EXPECT_EQ(can.send(orders(1)), port_ok);
  EXPECT_TRUE(peer.receive());
}

TEST_F(CanCardTest, OnlyAControllerThatIsBusOffIsRestarted) {
  EXPECT_EQ(restart_can("can0"), EBUSY);
  EXPECT_EQ(restart_can("lfnone0"), ENODEV);
  ASSERT_TRUE(shell("ip link add dev lftest0 type vcan"));
  EXPECT_EQ(restart_can("lftest0"), EOPNOTSUPP);
}

}  // namespace
}  // namespace lf::hal
