#include "host_sim/devices/io_node.hpp"

#include <gtest/gtest.h>

#include "shared/can/can_map.hpp"
#include "tests/unit/devices/canopen/client.hpp"

namespace lf::devices::test {
namespace {

class IoNodeTest : public testing::Test {
 protected:
  IoNodeTest() : io(IoConfig{}, Duration::from_ms(5)), client(io.node()) {
    io.power_on(client.now);
    run_ms(10);
    EXPECT_EQ(client.map(0x1400, 0x206, 1, {0x62000108, 0x21000108, 0x21000210}), 0u);
    EXPECT_EQ(client.map(0x1800, 0x40000186, 1, {0x60000108, 0x21010108, 0x21010208, 0x21010310}), 0u);
    client.nmt(1);
  }
  void run_ms(int ms) {
    for (int i = 0; i < ms; ++i) {
      client.now = client.now + Duration::from_ms(1);
      io.tick(client.now);
      for (const CanFrame& f : client.take()) sent.push_back(f);
    }
  }
  void ask(std::uint8_t outputs, std::uint8_t trigger, std::uint16_t exposure_us) {
    client.send(0x206, {outputs, trigger, static_cast<std::uint8_t>(exposure_us & 0xFF), static_cast<std::uint8_t>(exposure_us >> 8)});
  }
  IoNode io;
  Client client;
  std::vector<CanFrame> sent;
};

TEST_F(IoNodeTest, outputs_switch_at_the_sync_and_are_told_at_the_next) {
  ask(can_map::output_laser | can_map::output_lamps, 0, 0);
  EXPECT_FALSE(io.laser_on());
  std::vector<CanFrame> answer = client.sync();
  EXPECT_TRUE(io.laser_on());
  EXPECT_TRUE(io.lamps_on());
  ASSERT_EQ(answer.size(), 1u);
  EXPECT_EQ(answer[0].length, 5);
  EXPECT_EQ(answer[0].data[0], can_map::input_estop_closed | can_map::input_interlock_closed);
  EXPECT_EQ(answer[0].data[1], 0);
  EXPECT_EQ(client.sync()[0].data[1], 3);
}

TEST_F(IoNodeTest, a_changed_counter_is_one_exposure_at_that_sync) {
  ask(can_map::output_laser, 7, 2000);
  EXPECT_FALSE(io.take_exposure().has_value());
  client.now = client.now + Duration::from_us(67);
  client.sync();
  const std::optional<Exposure> e = io.take_exposure();
  ASSERT_TRUE(e.has_value());
  EXPECT_EQ(e->start, client.now);
  EXPECT_EQ(e->duration, Duration::from_us(2000));
  EXPECT_EQ(e->counter, 7);
  EXPECT_TRUE(e->laser);
  EXPECT_FALSE(e->lamps);
  ask(can_map::output_laser, 7, 2000);
  const CanFrame told = client.sync()[0];
  EXPECT_FALSE(io.take_exposure().has_value()) << "the same counter is no new exposure";
  EXPECT_EQ(told.data[2], 7);
  EXPECT_EQ(told.data[3] | (told.data[4] << 8), 2000);
}

TEST_F(IoNodeTest, an_exposure_of_nothing_is_none) {
  ask(0, 1, 0);
  client.sync();
  EXPECT_FALSE(io.take_exposure().has_value());
}

TEST_F(IoNodeTest, the_open_interlock_keeps_the_laser_off_and_shows_it) {
  ask(can_map::output_laser | can_map::output_lamps, 0, 0);
  client.sync();
  io.set_interlock_closed(false);
  EXPECT_FALSE(io.laser_on());
  EXPECT_TRUE(io.lamps_on());
  run_ms(1);
  const CanFrame told = client.sync()[0];
  EXPECT_EQ(told.data[0] & can_map::input_interlock_closed, 0);
  EXPECT_EQ(told.data[1], can_map::output_lamps);
  ask(can_map::output_laser, 1, 500);
  client.sync();
  EXPECT_FALSE(io.laser_on());
  ASSERT_TRUE(io.take_exposure().has_value());
}

TEST_F(IoNodeTest, a_stopped_node_shows_its_error_values) {
  EXPECT_EQ(client.write(0x6207, 1, can_map::output_lamps, 1), 0u);
  ask(can_map::output_laser, 0, 0);
  client.sync();
  EXPECT_TRUE(io.laser_on());
  client.nmt(2);
  EXPECT_FALSE(io.laser_on());
  EXPECT_TRUE(io.lamps_on());
  client.nmt(128);
  EXPECT_FALSE(io.lamps_on());
}

TEST_F(IoNodeTest, the_open_emergency_stop_is_told) {
  io.set_estop_closed(false);
  run_ms(1);
  EXPECT_EQ(client.sync()[0].data[0], can_map::input_interlock_closed);
}

TEST_F(IoNodeTest, everything_is_off_outside_operational_and_stays_off_after_it) {
  for (const int command : {2, 128, 129, 130}) {
    client.nmt(1);
    ask(can_map::output_laser | can_map::output_lamps, 0, 0);
    client.sync();
    ASSERT_TRUE(io.laser_on()) << command;
    client.nmt(static_cast<std::uint8_t>(command));
    EXPECT_FALSE(io.laser_on()) << command;
    EXPECT_FALSE(io.lamps_on()) << command;
    if (command >= 129) break;
    client.nmt(1);
    client.sync();
    EXPECT_FALSE(io.laser_on()) << "who starts the node asks again";
  }
}

TEST_F(IoNodeTest, a_lost_master_switches_the_laser_off) {
  client.write(0x1016, 1, (0x7F << 16) | 300, 4);
  client.send(0x77F, {5});
  ask(can_map::output_laser, 0, 0);
  client.sync();
  run_ms(299);
  EXPECT_TRUE(io.laser_on());
  run_ms(3);
  EXPECT_FALSE(io.laser_on());
  EXPECT_EQ(emergency(sent, 6), 0x8130);
}

}  // namespace
}  // namespace lf::devices::test
