// The bus as a whole: order of frames, heartbeats both ways, reboots, EMCY, refused frames, and a hundred thousand random ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "firmware/canopen/bus_load.hpp"
#include "firmware/canopen/codec.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen {
namespace {

using test::Bus;
using test::ScriptedNode;

// The controller's budget: all of the core is to fit a microcontroller's RAM. Ten drive set-ups, five of the network's and five of the axes', have a profile of
// 600 bytes each.
static_assert(sizeof(Network) <= 12 * 1024, "the network grew");

CanFrame frame_of(std::uint32_t id, std::vector<std::uint8_t> data) {
  CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), f.data.begin());
  return f;
}

class NetworkTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bus.boot()); }
  std::uint32_t refused(Refusal cause) { return bus.network.stats().refused[static_cast<std::size_t>(cause)]; }
  void receive(const CanFrame& f) { bus.network.on_frame(f, bus.now); }

  Bus bus{test::plain_config()};
};

TEST_F(NetworkTest, ACycleIsSyncThenRpdosThenTheRest) {
  for (int i = 0; i < 100; ++i) {
    bus.step();
    ASSERT_GE(bus.sent.size(), 7u);
    EXPECT_EQ(bus.sent[0].id, 0x080u);
    EXPECT_EQ(bus.sent[0].length, 0);
    for (std::uint32_t n = 1; n <= 6; ++n) EXPECT_EQ(bus.sent[n].id, 0x200 + n);
    EXPECT_LE(bus.sent.size(), 8u);
  }
}

TEST_F(NetworkTest, TheMastersHeartbeatComesEvery100MsAndSaysOperational) {
  std::vector<Time> times;
  for (int i = 0; i < 250; ++i) {
    const Time now = bus.now;
    bus.step();
    for (const CanFrame& f : bus.sent) {
      if (f.id != 0x77F) continue;
      EXPECT_EQ(f.length, 1);
      EXPECT_EQ(f.data[0], 5);
      times.push_back(now);
    }
  }
  ASSERT_EQ(times.size(), 10u);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_EQ(times[i] - times[i - 1], Duration::from_ms(100));
}

TEST_F(NetworkTest, TheMasterAnnouncesItselfOnceAndIsPreOperationalWhileBooting) {
  std::vector<std::uint8_t> states;
  for (const CanFrame& f : bus.log) {
    if (f.id == 0x77F) states.push_back(f.data[0]);
  }
  ASSERT_GE(states.size(), 3u);
  EXPECT_EQ(states[0], 0);
  EXPECT_EQ(states[1], 127);
  EXPECT_EQ(std::count(states.begin(), states.end(), 0), 1);
}

TEST_F(NetworkTest, ALostHeartbeatIsAFaultAfterItsTimeOut) {
  bus.step(30);
  bus.nodes[2].mute_heartbeat = true;
  bus.step(50);  // 200 ms
  EXPECT_TRUE(bus.network.operational());
  bus.step(55);
  EXPECT_FALSE(bus.network.operational());
  EXPECT_TRUE(bus.network.fault(2).heartbeat_lost);
  EXPECT_EQ(bus.network.axis(arm5e_joint::elbow).fault(), AxisFault::node_lost);
  bus.nodes[2].mute_heartbeat = false;
  bus.step(50);
  EXPECT_TRUE(bus.network.fault(2).heartbeat_lost) << "latched";
  bus.network.acknowledge(2);
  EXPECT_TRUE(bus.network.operational());
}

TEST_F(NetworkTest, ABootUpMessageInOperationIsAReboot) {
  bus.network.axis(arm5e_joint::jaw).request(AxisRequest::hold_enabled);
  ASSERT_TRUE(bus.run_until([&] { return bus.network.axis(arm5e_joint::jaw).enabled(); }, Duration::from_ms(500)));
  bus.nodes[4].reboot();
  bus.step(2);
  EXPECT_TRUE(bus.network.fault(4).rebooted);
  EXPECT_FALSE(bus.network.operational());
  EXPECT_EQ(bus.network.axis(arm5e_joint::jaw).fault(), AxisFault::node_lost);
  bus.network.acknowledge(4);
  bus.step(60);
  EXPECT_FALSE(bus.network.operational()) << "acknowledging does not configure it";
  ASSERT_TRUE(bus.boot());
  EXPECT_TRUE(bus.network.operational());
}

TEST_F(NetworkTest, ANodeThatLeavesOperationalByItselfIsAFault) {
  receive(frame_of(0x704, {127}));
  bus.step();
  EXPECT_TRUE(bus.network.fault(3).left_operational);
  EXPECT_FALSE(bus.network.operational());
}

TEST_F(NetworkTest, EmergenciesAreKeptInOrderWithCodeRegisterAndName) {
  const Time at = bus.now;
  receive(frame_of(0x083, {0x11, 0x86, 0x21, 1, 2, 3, 4, 5}));
  receive(frame_of(0x086, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  receive(frame_of(0x083, {0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(bus.network.any_fault());
  EXPECT_EQ(bus.network.fault(2).emcy_code, 0x8611);
  EXPECT_FALSE(bus.network.fault(2).emcy_active);
  EXPECT_EQ(bus.network.fault(2).error_register, 0);
  EXPECT_TRUE(bus.network.fault(5).emcy_active);

  auto first = bus.network.take_emcy();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->code, 0x8611);
  EXPECT_EQ(first->error_register, 0x21);
  EXPECT_EQ(first->node, 3);
  EXPECT_EQ(first->time, at);
  EXPECT_STREQ(emcy_name(first->code), "following error");
  EXPECT_EQ(bus.network.take_emcy()->code, 0x8130);
  EXPECT_EQ(bus.network.take_emcy()->code, 0);
  EXPECT_FALSE(bus.network.take_emcy());
  EXPECT_TRUE(bus.network.operational()) << "an EMCY alone is not a fault of the link";
}

TEST_F(NetworkTest, EmergenciesBeyondTheMemoryAreCounted) {
  for (std::uint8_t i = 0; i < 20; ++i) receive(frame_of(0x081, {i, 0x10, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bus.network.stats().emcys, 20u);
  EXPECT_EQ(bus.network.stats().emcys_forgotten, 4u);
  EXPECT_EQ(bus.network.take_emcy()->code, 0x1004);
}

TEST(Emcy, CodesHaveTheirOwnNameOrTheirClassName) {
  EXPECT_STREQ(emcy_name(0x8130), "heartbeat lost");
  EXPECT_STREQ(emcy_name(0x8250), "RPDO time-out");
  EXPECT_STREQ(emcy_name(0x8210), "PDO not processed: length");
  EXPECT_STREQ(emcy_name(0x81FE), "communication");
  EXPECT_STREQ(emcy_name(0x4310), "motor over-temperature");
  EXPECT_STREQ(emcy_name(0x43FE), "temperature");
  EXPECT_STREQ(emcy_name(0xFF07), "device specific");
  EXPECT_STREQ(emcy_name(0xE000), "unknown");
}

TEST_F(NetworkTest, EachRefusedFrameIsCountedByItsCause) {
  const std::vector<std::pair<Refusal, CanFrame>> cases{
      {Refusal::error_frame, frame_of(CanFrame::error_flag | 0x40, {0, 0, 0, 0, 0, 0, 0, 0})},
      {Refusal::not_classic, frame_of(CanFrame::extended_flag | 0x181, {0, 0, 0, 0, 0, 0, 0, 0})},
      {Refusal::not_classic, frame_of(CanFrame::remote_flag | 0x181, {})},
      {Refusal::not_classic, frame_of(0x801, {})},
      {Refusal::unknown_node, frame_of(0x189, {0, 0, 0, 0, 0, 0, 0, 0})},
      {Refusal::unknown_node, frame_of(0x70A, {5})},
      {Refusal::unknown_id, frame_of(0x100, {})},
      {Refusal::unknown_id, frame_of(0x7E5, {})},
      {Refusal::unknown_id, frame_of(0x180, {0, 0, 0, 0, 0, 0, 0, 0})},
      {Refusal::foreign_master, frame_of(0x000, {1, 0})},
      {Refusal::foreign_master, frame_of(0x080, {})},
      {Refusal::foreign_master, frame_of(0x77F, {5})},
      {Refusal::foreign_master, frame_of(0x201, {0, 0, 0, 0, 0, 0, 0, 0})},
      {Refusal::foreign_master, frame_of(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0})},
      {Refusal::pdo_too_short, frame_of(0x181, {0x27, 0, 0, 0, 0, 0, 0})},
      {Refusal::pdo_too_short, frame_of(0x186, {0, 0, 0, 0})},
      {Refusal::pdo_too_long, frame_of(0x186, {0, 0, 0, 0, 0, 0})},
      {Refusal::pdo_unmapped, frame_of(0x281, {0, 0})},
      {Refusal::pdo_unmapped, frame_of(0x482, {0, 0})},
      {Refusal::sdo_refused, frame_of(0x581, {0x43, 0, 0x10, 0, 0, 0, 0, 0})},
      {Refusal::bad_length, frame_of(0x581, {0x43, 0, 0x10, 0})},
      {Refusal::bad_length, frame_of(0x081, {0x10, 0x81, 1})},
      {Refusal::bad_length, frame_of(0x701, {5, 0})},
      {Refusal::heartbeat_state, frame_of(0x701, {6})},
  };
  const std::int32_t position = bus.network.axis(arm5e_joint::slew).actual_counts();
  std::uint32_t total = bus.network.stats().refused_total();
  for (const auto& [cause, frame] : cases) {
    const std::uint32_t before = refused(cause);
    receive(frame);
    EXPECT_EQ(refused(cause), before + 1) << name(cause) << " " << std::hex << frame.id;
    EXPECT_EQ(bus.network.stats().refused_total(), ++total);
  }
  CanFrame too_long = frame_of(0x181, {0, 0, 0, 0, 0, 0, 0, 0});
  too_long.length = 9;
  receive(too_long);
  EXPECT_EQ(refused(Refusal::bad_length), 4u);
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).actual_counts(), position);
  EXPECT_TRUE(bus.network.operational());
}

TEST_F(NetworkTest, ProcessDataOfANodeThatWasNotStartedIsRefused) {
  Bus fresh(test::plain_config());
  fresh.network.start_boot(fresh.now);
  fresh.step(5);
  fresh.network.on_frame(frame_of(0x181, {0x27, 0, 0, 0, 0, 0, 0, 0}), fresh.now);
  EXPECT_EQ(fresh.network.stats().refused[static_cast<std::size_t>(Refusal::pdo_before_start)], 1u);
  EXPECT_FALSE(fresh.network.axis(arm5e_joint::slew).seen());
}

TEST_F(NetworkTest, NothingIsSentBeforeTheBootIsAskedFor) {
  Bus fresh(test::plain_config());
  fresh.step(10);
  EXPECT_TRUE(fresh.log.empty());
}

TEST_F(NetworkTest, AFullOutboxIsCountedAndHarmless) {
  Outbox outbox;
  while (outbox.push_back(CanFrame{})) {
  }
  bus.network.tick(bus.now, outbox);
  EXPECT_EQ(outbox.size(), Outbox::capacity());
  EXPECT_GE(bus.network.stats().outbox_overflows, 7u);
}

TEST_F(NetworkTest, AClockThatRunsBackwardsIsCounted) {
  Outbox outbox;
  bus.network.tick(bus.now - Duration::from_ms(100), outbox);
  EXPECT_TRUE(outbox.empty());
  bus.network.on_frame(frame_of(0x701, {5}), bus.now - Duration::from_ms(100));
  EXPECT_EQ(bus.network.stats().time_backwards, 2u);
  bus.step(2);
  EXPECT_TRUE(bus.network.operational());
}

TEST_F(NetworkTest, ASecondTpdoInACycleIsTakenAndCounted) {
  bus.step();
  receive(frame_of(0x181, {0x40, 0, 9, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bus.network.stats().pdo_repeated, 1u);
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).actual_counts(), 9);
}

// The answer to one SYNC arrives after the next SYNC: what it says is newer than what is known, and what follows is newer still.
TEST_F(NetworkTest, ALateReportIsTakenUntilTheNextOneIsThere) {
  const Time sync = bus.now;
  Outbox outbox;
  bus.network.tick(sync, outbox);
  bus.network.on_frame(frame_of(0x181, {0x40, 0, 9, 0, 0, 0, 0, 0}), sync + Duration::from_us(200));
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).actual_counts(), 9);
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).actual_time(), sync);
  EXPECT_EQ(bus.network.stats().pdo_repeated, 0u) << "the SYNC before was not answered";
  bus.network.on_frame(frame_of(0x181, {0x40, 0, 10, 0, 0, 0, 0, 0}), sync + Duration::from_us(600));
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).actual_counts(), 10);
  EXPECT_EQ(bus.network.stats().pdo_repeated, 1u);
}

TEST_F(NetworkTest, TheLoadInOperationStaysUnderTheWorstCaseOfTheBus) {
  const std::uint64_t before = bus.network.stats().bits_on_bus;
  bus.step(250);  // 1 s
  const double load = static_cast<double>(bus.network.stats().bits_on_bus - before) / can_map::bitrate;
  // Five drives and the output node: 6 x (RPDO + TPDO) at most.
  EXPECT_LT(load, bus_load::worst_case_load(6, 250, 10, can_map::bitrate));
  EXPECT_GT(load, 0.25);
}

TEST_F(NetworkTest, StoppingAllAndDisablingAllReachEveryAxis) {
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) bus.network.axis(i).request(AxisRequest::hold_enabled);
  bus.step(40);
  bus.network.quick_stop_all();
  bus.step(4);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(bus.network.axis(i).state(), AxisState::stopped);
  bus.network.disable_all();
  bus.step(20);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_EQ(bus.network.axis(i).state(), AxisState::disabled);
}

TEST_F(NetworkTest, ShutDownStopsTheAxesAndTheOutputsBeforeTheNodes) {
  bus.network.axis(arm5e_joint::slew).request(AxisRequest::hold_enabled);
  bus.network.io().set_outputs(3);
  bus.step(40);
  ASSERT_EQ(bus.nodes[5].outputs, 3);
  bus.network.shut_down();
  bus.step(10);
  EXPECT_EQ(bus.nodes[0].drive_state_bits(), 0x40) << "without power";
  EXPECT_EQ(bus.nodes[5].outputs, 0);
  for (const ScriptedNode& node : bus.nodes) EXPECT_EQ(node.nmt(), 4);
  EXPECT_FALSE(bus.network.operational());
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).state(), AxisState::offline);
  EXPECT_TRUE(bus.boot());
}

// ---- random frames ----

CanFrame random_frame(std::mt19937& random) {
  static constexpr std::uint32_t functions[] = {0x000, 0x080, 0x180, 0x200, 0x280, 0x580, 0x600, 0x700};
  CanFrame f;
  const bool plausible = random() % 4 != 0;
  f.id = plausible ? functions[random() % 8] + random() % 8 : static_cast<std::uint32_t>(random());
  f.length = static_cast<std::uint8_t>(plausible && random() % 8 != 0 ? 8 : random() % 12);
  if (f.id >= 0x700 && f.id < 0x708) f.length = 1;
  for (std::uint8_t& byte : f.data) byte = static_cast<std::uint8_t>(random() % 3 == 0 ? random() % 8 : random());
  return f;
}

void expect_wellformed(const Outbox& outbox) {
  ASSERT_FALSE(outbox.empty());
  EXPECT_EQ(outbox[0].id, 0x080u);
  for (const CanFrame& f : outbox) {
    ASSERT_LE(f.length, 8);
    ASSERT_LE(f.id, 0x7FFu);
    const bool ours = f.id == 0 || f.id == 0x080 || f.id == 0x77F || (f.id > 0x200 && f.id <= 0x206) || (f.id > 0x600 && f.id <= 0x606);
    ASSERT_TRUE(ours) << std::hex << f.id;
    for (std::size_t i = f.length; i < 8; ++i) ASSERT_EQ(f.data[i], 0);
  }
}

TEST(RandomFrames, AHundredThousandNeverBreakAnInvariant) {
  for (const unsigned seed : {1u, 20'251'121u}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const NetworkConfig config = test::plain_config();
    Bus bus(config);
    bus.network.start_boot(bus.now);
    PerJoint<std::int64_t> last_target{};
    PerJoint<bool> was_enabled{};
    std::uint64_t frames = 0;
    while (frames < 50'000) {
      const bool storm = (frames / 5'000) % 2 == 1;  // quiet stretches let the bus boot and the axes be enabled
      const int burst = storm ? static_cast<int>(random() % 40) : 0;
      for (int i = 0; i < burst; ++i) bus.network.on_frame(random_frame(random), bus.now);
      frames += storm ? static_cast<std::uint64_t>(burst) : 10;
      if (random() % 200 == 0) bus.network.start_boot(bus.now);
      for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
        Axis& axis = bus.network.axis(i);
        if (random() % 20 == 0) axis.request(static_cast<AxisRequest>(random() % 5));
        axis.set_target_counts(static_cast<std::int32_t>(random()));
      }
      bus.network.io().set_outputs(static_cast<std::uint8_t>(random()));
      bus.network.io().trigger_camera(Duration::from_us(static_cast<std::int64_t>(random() % 70'000)));
      bus.step();
      Outbox sent;
      for (const CanFrame& f : bus.sent) ASSERT_TRUE(sent.push_back(f));
      expect_wellformed(sent);
      if (HasFatalFailure()) return;
      ASSERT_LE(sent.size(), 26u);
      for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
        const Axis& axis = bus.network.axis(i);
        const std::int64_t target = axis.target_counts();
        if (was_enabled[i] && axis.enabled()) {
          ASSERT_LE(std::abs(target - last_target[i]), 41) << "a jump of the target while enabled";
        }
        was_enabled[i] = axis.enabled() && std::any_of(sent.begin(), sent.end(), [&](const CanFrame& f) {
                           return f.id == 0x201 + i && get<std::uint16_t>(f, 0) == 0x0F && get<std::int32_t>(f, 2) == target;
                         });
        last_target[i] = target;
      }
      const CanFrame* io_rpdo = std::find_if(sent.begin(), sent.end(), [](const CanFrame& f) { return f.id == 0x206; });
      if (io_rpdo != sent.end() && (io_rpdo->data[0] & 1) != 0) {
        ASSERT_FALSE(bus.network.io().laser_inhibited());
      }
    }
    const NetworkStats& stats = bus.network.stats();
    EXPECT_GT(stats.refused_total(), 1000u);
    EXPECT_LE(stats.refused_total(), stats.frames_in);
    EXPECT_EQ(stats.outbox_overflows, 0u);
    ASSERT_TRUE(bus.boot()) << "a quiet bus boots again, whatever was on it";
  }
}

}  // namespace
}  // namespace lf::canopen
