// Booting drives that differ from the standard as their profiles say: other objects, absent ones, refused options, ratings, and no zero.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "firmware/canopen/sdo_abort.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/boot_bench.hpp"

namespace lf::canopen {
namespace {

using test::Bus;
using test::elbow;
using test::full_config;
using test::ScriptedNode;
using Trick = ScriptedNode::Trick;

TEST(Boot, ANumberGoesToTheObjectThatTheProfileNames) {
  NetworkConfig config = full_config();
  ASSERT_TRUE(config.drives[elbow].profile.absences.push_back({BootValue::max_torque, Substitute::other_object, 0x30B0, 2}));
  Bus bus(config);
  bus.nodes[elbow].remove_object(0x6072, 0);
  bus.nodes[elbow].set_object(0x30B0, 2, 0, 2);
  ASSERT_TRUE(bus.boot());
  EXPECT_EQ(bus.nodes[elbow].object(0x30B0, 2), config.drives[elbow].max_torque_permille);
}

TEST(Boot, AnAbsentObjectIsPassedOverOnlyWhereTheProfileHasASubstitute) {
  for (const bool has_one : {true, false}) {
    NetworkConfig config = full_config();
    // The other entry is of an object that the drive has.
    ASSERT_TRUE(config.drives[elbow].profile.absences.push_back({BootValue::following_window, Substitute::master_times_following}));
    if (has_one) (void)config.drives[elbow].profile.absences.push_back({BootValue::max_speed, Substitute::master_limits_speed});
    Bus bus(config);
    bus.nodes[elbow].remove_object(0x607F, 0);
    EXPECT_EQ(bus.boot(), has_one);
    const NodeBoot report = bus.network.boot().nodes[elbow];
    if (!has_one) {
      ASSERT_NE(bus.network.boot().failed(), nullptr);
      EXPECT_EQ(report.index, 0x607F);
      continue;
    }
    EXPECT_EQ(bus.network.boot().failed(), nullptr);
    ASSERT_EQ(report.substitutions.size(), 1u);
    EXPECT_EQ(report.substitutions[0].index, 0x607F);
    EXPECT_EQ(report.substitutions[0].by, Substitute::master_limits_speed);
  }
}

// 605A and 6007 take few values on many drives.
TEST(Boot, ARefusedOptionCodeIsTriedOnceMoreWithTheProfilesSecondChoice) {
  struct Case {
    std::uint16_t index;
    std::int16_t quick_stop, abort;
    bool boots;
  };
  for (const Case& c : {Case{0x605A, 2, 0, true}, Case{0x6007, 0, 1, true}, Case{0x605A, 0, 1, false}, Case{0x6007, 2, 0, false}}) {
    NetworkConfig config = full_config();
    config.drives[elbow].profile.quick_stop_fallback = c.quick_stop;
    config.drives[elbow].profile.abort_fallback = c.abort;
    Bus bus(config);
    // The reading before the first writing is one of the two.
    bus.nodes[elbow].trick = Trick{.what = Trick::What::refuse_write, .index = c.index, .code = sdo_abort::bad_value, .times = 2};
    ASSERT_EQ(bus.boot(), c.boots) << c.index;
    if (!c.boots) {
      EXPECT_EQ(bus.network.boot().failed()->failure, BootFailure::sdo_aborted);
      continue;
    }
    const auto taken = static_cast<std::uint32_t>(c.quick_stop + c.abort);
    EXPECT_EQ(bus.nodes[elbow].object(c.index, 0), taken);
    if (c.quick_stop != 0) {
      EXPECT_EQ(bus.network.boot().nodes[elbow].quick_stop_option, c.quick_stop);
    }
  }
}

// The scripted drive says 12,000 mN m.
TEST(Boot, ARatingThatIsNotTheStatedOneEndsTheBoot) {
  for (const auto& [stated_unm, boots] : {std::pair{12'900'000U, true}, std::pair{11'100'000U, true}, std::pair{12'000U, false}}) {
    NetworkConfig config = full_config();
    config.drives[elbow].profile.rated_torque_unm = stated_unm;
    Bus bus(config);
    ASSERT_EQ(bus.boot(), boots) << stated_unm;
    if (boots) continue;
    EXPECT_EQ(bus.network.boot().failed()->failure, BootFailure::wrong_rating);
    EXPECT_EQ(bus.network.boot().failed()->expected, 12U);
    EXPECT_EQ(bus.network.boot().failed()->read, 12'000U);
  }
}

// The slew has an absolute encoder, and its drive says 7320: home again. Resets and boots do not bring the zero back.
TEST(LostPosition, TakesThePowerUntilTheJointIsCommissionedAgain) {
  for (const std::uint16_t code : {std::uint16_t{0x7320}, std::uint16_t{0x8611}}) {
    SCOPED_TRACE(code);
    const bool lost = code == 0x7320;
    NetworkConfig config = full_config();
    ASSERT_TRUE(config.drives[0].profile.position_lost.push_back(0x7320));
    Bus bus(config);
    ASSERT_TRUE(bus.boot());
    Axis& slew = bus.network.axis(arm5e_joint::slew);
    slew.request(AxisRequest::hold_enabled);
    ASSERT_TRUE(bus.run_until([&] { return slew.enabled(); }, Duration::from_ms(500)));
    bus.nodes[0].send_emcy(code, 0x20);
    bus.step(20);
    EXPECT_EQ(slew.fault() == AxisFault::drive_fault, lost);
    EXPECT_EQ(slew.zero_lost(), lost);
    slew.request(AxisRequest::reset_fault);
    bus.step(50);
    ASSERT_TRUE(bus.boot());
    EXPECT_EQ(slew.homed(), !lost);
    EXPECT_EQ(bus.network.may_have_power(), !lost);
    slew.request(AxisRequest::hold_enabled);
    bus.step(50);
    EXPECT_EQ(slew.powered(), !lost);
  }
}

// The scripted drive is rated at 12 N m, by its 6076 or because the machine's file says so.
TEST(Boot, TheTorqueCapIsTheSameTorqueWhateverTheDrivesOwnRatingIs) {
  struct Case {
    std::uint32_t described_unm;
    std::uint32_t cap_permille;  // of 12 N m, where 600 thousandths of the description are asked for
  };
  for (const bool stated : {false, true}) {
    for (const Case& c : {Case{12'000'000, 600}, Case{6'000'000, 300}, Case{18'000'000, 900}, Case{36'000'000, 1000}, Case{0, 600}}) {
      NetworkConfig config = full_config();
      DriveSetup& drive = config.drives[elbow];
      drive.max_torque_permille = 600;
      drive.described_torque_unm = c.described_unm;
      drive.profile.rated_torque_unm = stated ? 12'000'000 : 0;
      drive.profile.rated_torque_unit_unm = stated ? 0 : 1000;
      Bus bus(config);
      ASSERT_TRUE(bus.boot()) << c.described_unm;
      EXPECT_EQ(bus.nodes[elbow].object(0x6072, 0), c.cap_permille) << c.described_unm;
    }
  }
}

TEST(Boot, ARatingFarFromTheDescriptionsIsAnotherMotor) {
  for (const auto& [described_unm, boots] :
       {std::pair{4'000'000U, true}, std::pair{36'000'000U, true}, std::pair{3'900'000U, false}, std::pair{37'000'000U, false}}) {
    NetworkConfig config = full_config();
    config.drives[elbow].described_torque_unm = described_unm;
    Bus bus(config);
    ASSERT_EQ(bus.boot(), boots) << described_unm;
    if (boots) continue;
    EXPECT_EQ(bus.network.boot().failed()->failure, BootFailure::other_motor);
    EXPECT_EQ(bus.network.boot().failed()->expected, described_unm / 1000);
    EXPECT_EQ(bus.network.boot().failed()->read, 12'000U);
  }
}

TEST(Boot, AJointWithoutAZeroTakesNoPower) {
  NetworkConfig config = full_config();
  config.drives[0].zero_known = false;
  Bus bus(config);
  ASSERT_TRUE(bus.boot());
  EXPECT_FALSE(bus.network.may_have_power());
  bus.network.axis(arm5e_joint::slew).request(AxisRequest::hold_enabled);
  bus.network.axis(arm5e_joint::slew).request(AxisRequest::home);
  bus.step(50);
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).requested(), AxisRequest::disable);
  EXPECT_EQ(bus.network.axis(arm5e_joint::slew).stats().power_refused, 2U);
  EXPECT_FALSE(bus.network.axis(arm5e_joint::slew).powered());
  Bus known(full_config());
  EXPECT_TRUE(known.network.may_have_power());
}

}  // namespace
}  // namespace lf::canopen
