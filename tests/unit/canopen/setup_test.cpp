// What is refused before anything is sent.
#include "firmware/canopen/setup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::canopen {
namespace {

TEST(Setup, ThePlainConfigurationIsAccepted) {
  std::size_t offender = 99;
  EXPECT_EQ(check(test::plain_config(), offender), ConfigError::none);
}

TEST(Setup, EachImpossibleNumberIsNamedWithItsNode) {
  struct Case {
    std::function<void(NetworkConfig&)> spoil;
    ConfigError error;
    std::size_t offender;
  };
  const Case cases[] = {
      {[](NetworkConfig& c) { c.drives[2].node = 0; }, ConfigError::node_id, 2},
      {[](NetworkConfig& c) { c.drives[2].node = 127; }, ConfigError::node_id, 2},
      {[](NetworkConfig& c) { c.io.node = 200; }, ConfigError::node_id, arm5e_joint::count},
      {[](NetworkConfig& c) { c.drives[3].node = 1; }, ConfigError::node_twice, 3},
      {[](NetworkConfig& c) { c.drives[1].min_counts = c.drives[1].max_counts; }, ConfigError::position_limits, 1},
      {[](NetworkConfig& c) { c.drives[0].max_speed_counts_s = 0; }, ConfigError::speed, 0},
      {[](NetworkConfig& c) { c.drives[0].max_torque_permille = 0; }, ConfigError::torque, 0},
      {[](NetworkConfig& c) { c.drives[4].following_window_counts = 0; }, ConfigError::following, 4},
      {[](NetworkConfig& c) { c.drives[4].homing_method = -4; }, ConfigError::homing, 4},
      {[](NetworkConfig& c) { c.drives[1].profile.scale.speed.num = 0; }, ConfigError::profile, 1},
      {[](NetworkConfig& c) { c.drives[1].profile.scale.sign = 0; }, ConfigError::profile, 1},
      {[](NetworkConfig& c) { c.drives[1].profile.scale.speed.num = 1'000'000'000; }, ConfigError::profile, 1},
      {[](NetworkConfig& c) { c.drives[1].profile.scale.position.num = 1'000'000; }, ConfigError::positions, 1},
      {[](NetworkConfig& c) { c.drives[1].encoder_zero_counts = INT32_MAX; }, ConfigError::positions, 1},
      {[](NetworkConfig& c) { c.sync_period = Duration::from_ns(4'000'001); }, ConfigError::sync_period, arm5e_joint::count},
      {[](NetworkConfig& c) { c.sync_period = Duration::from_ms(200); }, ConfigError::sync_period, arm5e_joint::count},
      {[](NetworkConfig& c) { c.sync_period = Duration{}; }, ConfigError::sync_period, arm5e_joint::count},
      {[](NetworkConfig& c) { c.sdo_timeout = Duration{}; }, ConfigError::timeout, arm5e_joint::count},
  };
  for (const Case& c : cases) {
    NetworkConfig config = test::plain_config();
    c.spoil(config);
    std::size_t offender = 99;
    EXPECT_EQ(check(config, offender), c.error) << name(c.error);
    EXPECT_EQ(offender, c.offender) << name(c.error);

    Network network(config);
    network.start_boot(Time{});
    Outbox outbox;
    network.tick(Time::from_ns(1), outbox);
    EXPECT_TRUE(outbox.empty());
    const BootReport report = network.boot();
    EXPECT_EQ(report.state, BootState::failed);
    ASSERT_NE(report.failed(), nullptr);
    EXPECT_EQ(report.failed()->failure, BootFailure::configuration);
  }
}

TEST(Setup, HomingInPlaceNeedsNoSpeed) {
  NetworkConfig config = test::plain_config();
  config.drives[0].homing_method = 37;
  config.drives[1].homing_method = 35;
  std::size_t offender = 99;
  EXPECT_EQ(check(config, offender), ConfigError::none);
}

TEST(Setup, InterpolationPeriodIsValueTimesPowerOfTen) {
  for (const std::int64_t us : {1000, 2000, 2500, 4000, 5000, 10'000, 12'500, 250, 255'000}) {
    std::uint8_t value = 0;
    std::int8_t exponent = 0;
    ASSERT_TRUE(interpolation_period(Duration::from_us(us), value, exponent)) << us;
    EXPECT_NEAR(value * std::pow(10.0, exponent), static_cast<double>(us) * 1e-6, 1e-15);
  }
  // Many drives take no exponent but -3.
  for (const std::int64_t ms : {1, 4, 10, 20, 100, 255}) {
    std::uint8_t in_ms = 0;
    std::int8_t power = 0;
    ASSERT_TRUE(interpolation_period(Duration::from_ms(ms), in_ms, power));
    EXPECT_EQ(in_ms, ms);
    EXPECT_EQ(power, -3);
  }
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
  EXPECT_FALSE(interpolation_period(Duration::from_us(257), value, exponent));
  EXPECT_FALSE(interpolation_period(Duration::from_ns(3'333'333), value, exponent));
  EXPECT_FALSE(interpolation_period(Duration::from_ms(-4), value, exponent));
}

}  // namespace
}  // namespace lf::canopen
