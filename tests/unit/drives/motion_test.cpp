// Each drive that boots moves its joint in its own units, stops when it must, and says what went wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/arm/motor.hpp"
#include "tests/unit/drives/drive_bench.hpp"

namespace lf::test {
namespace {

using canopen::AxisFault;
using canopen::AxisRequest;
using canopen::AxisState;

const char* const flying[] = {
    "lanternfish", "epos4", "epos4_configured", "elmo_gold", "elmo_gold_configured", "ipos", "c5e", "ingenia", "lmdrive", "eyou", "copley"};

bool enable(DriveBench& bench) {
  bench.elbow().request(AxisRequest::hold_enabled);
  return bench.run_until([&] { return bench.elbow().enabled(); }, Duration::from_s(4));
}

// Moves the elbow at a constant speed; false when a fault latches.
bool move_by(DriveBench& bench, std::int32_t counts, double counts_s) {
  const std::int32_t start = bench.elbow().target_counts();
  double target = start;
  while (target != start + counts) {
    target += std::clamp(start + counts - target, -counts_s * 0.004, counts_s * 0.004);
    (void)bench.elbow().set_target_counts(static_cast<std::int32_t>(std::lround(target)));
    bench.run(Duration::from_ms(4));
    if (bench.elbow().fault() != AxisFault::none) return false;
  }
  // The end of the speed is a step: a drive goes past it within its acceleration, and comes back as its loop does, by a factor of e in 50 ms.
  bench.run(Duration::from_s(1));
  return bench.elbow().fault() == AxisFault::none;
}

// 0.4 s towards a target 3000 counts away, in which no drive gets there. Returns the target.
std::int32_t set_off(DriveBench& bench) {
  const std::int32_t far = bench.elbow().actual_counts() + 3000;
  for (int i = 0; i < 100; ++i) {
    (void)bench.elbow().set_target_counts(far);
    bench.run(Duration::from_ms(4));
  }
  return far;
}

// Booted, enabled, and on its way.
bool under_way(DriveBench& bench) {
  if (!bench.boot() || !enable(bench)) return false;
  (void)set_off(bench);
  return true;
}

// Remembers whether the elbow's drive sends an emergency message with this code.
void watch_emcy(DriveBench& bench, int code, Time& seen) {
  bench.devices.set_tap([&bench, &seen, code](const devices::BusRecord& record) {
    const CanFrame& frame = record.frame;
    if (frame.id == 0x083 && (frame.data[0] | frame.data[1] << 8) == code && seen == Time{}) seen = bench.now;
  });
}

class FlyingDrive : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, FlyingDrive, testing::ValuesIn(flying), [](const auto& make) { return std::string(make.param); });

TEST_P(FlyingDrive, MovesTheJointWhereTheArmsCountsSay) {
  for (const bool reversed : {false, true}) {
    SCOPED_TRACE(reversed);
    Make make{"", GetParam()};
    make.reversed = reversed;
    DriveBench bench(make);
    ASSERT_TRUE(bench.boot()) << bench.sentence();
    EXPECT_NEAR(bench.elbow().actual_counts(), bench.joint_counts(), 1);
    ASSERT_TRUE(enable(bench)) << canopen::name(bench.elbow().fault());
    EXPECT_NEAR(bench.elbow().actual_counts(), bench.joint_counts(), 1);
    const double start = bench.joint_counts();
    ASSERT_TRUE(move_by(bench, 1500, 1500)) << canopen::name(bench.elbow().fault());
    EXPECT_NEAR(bench.joint_counts() - start, 1500, 4);
    EXPECT_NEAR(bench.elbow().actual_counts(), bench.joint_counts(), 1);
  }
}

TEST_P(FlyingDrive, ReportsTorqueInThousandthsOfItsRating) {
  Make make{"", GetParam()};
  DriveBench bench(make, [](canopen::NetworkConfig&, devices::DevicesConfig& devices) { devices.drives[2].friction = {}; });
  ASSERT_TRUE(bench.boot()) << bench.sentence();
  EXPECT_NEAR(bench.elbow().rated_torque_unm() * 1e-6, bench.devices_config.drives[2].rated_torque_nm, 1e-3);
  ASSERT_TRUE(enable(bench));
  // Half of the rated torque, drawn at the joint: the encoder's direction is the joint's.
  const devices::DriveConfig& drive = bench.devices_config.drives[2];
  bench.load_nm = 0.5 * drive.rated_torque_nm * motor_ratio(drive.actuator, bench.joints[2].position_rad, drive.counts_per_rev);
  bench.run(Duration::from_ms(100));
  EXPECT_NEAR(bench.elbow().torque_permille(), 500, 30);
}

TEST_P(FlyingDrive, AFaultStopsItAndIsResetAndTheDriveMovesAgain) {
  DriveBench bench({"", GetParam()}, [](canopen::NetworkConfig&, devices::DevicesConfig& devices) {
    devices.faults.push_back({4.0, devices::DeviceFaultKind::overcurrent, 3, 0.5, 0});
  });
  ASSERT_TRUE(bench.boot()) << bench.sentence();
  ASSERT_TRUE(enable(bench));
  ASSERT_LT(bench.now.s(), 4.0);
  EXPECT_TRUE(bench.run_until([&] { return bench.elbow().fault() == AxisFault::drive_fault; }, Duration::from_s(5)));
  EXPECT_EQ(bench.network.fault(2).emcy_code, 0x2310);
  bench.run(Duration::from_s(1));
  bench.elbow().request(AxisRequest::reset_fault);
  ASSERT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::disabled; }, Duration::from_s(2)));
  EXPECT_TRUE(enable(bench));
  EXPECT_TRUE(move_by(bench, 200, 1000));
}

TEST_P(FlyingDrive, StopsWhenTheMasterIsGone) {
  DriveBench bench({"", GetParam()});
  ASSERT_TRUE(under_way(bench)) << bench.sentence();
  Time complained;
  watch_emcy(bench, 0x8130, complained);
  const Time gone = bench.now;
  bench.master_alive = false;
  // The master's heartbeat, or its guard request, is missed after 300 ms; then comes the ramp.
  bench.run(Duration::from_ms(1200));
  const double stopped = bench.joint_counts();
  bench.run(Duration::from_ms(500));
  EXPECT_NEAR(bench.joint_counts(), stopped, 0.5);
  // The last heartbeat, of one every 100 ms, was up to that old.
  EXPECT_GE((complained - gone).s(), 0.19) << "EMCY 8130";
  EXPECT_LE((complained - gone).s(), 0.31) << "EMCY 8130";
  // The node said so, and is no longer operational: a new master has to boot it anew.
  bench.master_alive = true;
  bench.run(Duration::from_ms(400));
  EXPECT_EQ(bench.elbow().fault(), AxisFault::node_lost) << canopen::name(bench.elbow().fault());
  EXPECT_TRUE(bench.boot()) << bench.sentence();
}

TEST_P(FlyingDrive, QuickStopHoldsOrLetsGoAsTheDriveTookIt) {
  DriveBench bench({"", GetParam()});
  ASSERT_TRUE(bench.boot()) << bench.sentence();
  ASSERT_TRUE(enable(bench));
  bench.elbow().request(AxisRequest::quick_stop);
  EXPECT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::stopped; }, Duration::from_s(2)));
  bench.elbow().request(AxisRequest::disable);
  EXPECT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::disabled; }, Duration::from_s(3)));
  EXPECT_TRUE(enable(bench));
}

// What a maker's documents leave open, the other way round.
TEST(UnconfirmedDrive, AnElmoThatRefusesQuickStop6TakesTheProfilesSecondChoice) {
  for (const bool refuses : {false, true}) {
    Make make{"", "elmo_gold"};
    make.switches.refuses_quick_stop_6 = refuses;
    DriveBench bench(make, [](canopen::NetworkConfig& config, devices::DevicesConfig&) { config.drives[2].quick_stop_option = 6; });
    ASSERT_TRUE(bench.boot()) << bench.sentence();
    EXPECT_EQ(bench.network.boot().nodes[2].quick_stop_option, refuses ? 5 : 6);
    ASSERT_TRUE(enable(bench));
    bench.elbow().request(AxisRequest::quick_stop);
    EXPECT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::stopped; }, Duration::from_s(2)));
    EXPECT_TRUE(enable(bench));
  }
}

TEST(UnconfirmedDrive, InhibitTimesThatHoldBackSynchronousPdosAreWrittenAway) {
  for (const char* name : {"epos4", "ipos", "c5e", "ingenia"}) {
    Make make{"", name};
    make.switches.inhibits_synchronous = true;
    DriveBench bench(make);
    ASSERT_TRUE(bench.boot()) << bench.sentence();
    ASSERT_TRUE(enable(bench)) << name;
    EXPECT_TRUE(move_by(bench, 500, 1000)) << name;
  }
}

TEST(UnconfirmedDrive, ADriveThatFaultsWithoutSyncSaysSoAndGoesNoFartherThanItsRamp) {
  for (const char* name : {"ipos", "ingenia", "lmdrive", "eyou"}) {
    double gone_counts[2] = {};
    for (const bool faults : {false, true}) {
      Make make{"", name};
      make.switches.faults_without_sync = faults;
      DriveBench bench(make);
      ASSERT_TRUE(under_way(bench)) << bench.sentence();
      Time complained;
      watch_emcy(bench, 0x8250, complained);
      const double before = bench.joint_counts();
      bench.master_alive = false;
      bench.run(Duration::from_ms(60));  // shorter than the deadlines of its process data and of the heartbeat
      EXPECT_EQ(complained != Time{}, faults) << name << " and its EMCY 8250";
      gone_counts[faults] = bench.joint_counts() - before;
      bench.master_alive = true;
      bench.run(Duration::from_ms(100));
      // The master latches its own stale data in both.
      EXPECT_EQ(bench.elbow().fault(), AxisFault::stale) << name << ": " << canopen::name(bench.elbow().fault());
    }
    // Without the fault it holds the last target; with it, it goes down its ramp from the speed of the joint.
    EXPECT_LT(gone_counts[true], 1.15 * gone_counts[false]) << name;
  }
}

TEST(UnconfirmedDrive, AnLmdriveWithSpeedsInRpmMovesTheSame) {
  for (const bool rpm : {false, true}) {
    Make make{"", "lmdrive"};
    make.switches.speeds_in_rpm = rpm;
    DriveBench bench(make);
    ASSERT_TRUE(bench.boot()) << bench.sentence();
    ASSERT_TRUE(enable(bench));
    const double start = bench.joint_counts();
    EXPECT_TRUE(move_by(bench, 1000, 1000));
    EXPECT_NEAR(bench.joint_counts() - start, 1000, 4);
  }
}

// Its 6085 is in the unit of the switch: the ramp that was asked for where its profile is right, a shorter one where the drive counts in turns a minute.
TEST(UnconfirmedDrive, AnLmdriveStopsWithinItsRampInEitherUnit) {
  double gone_counts[2] = {};
  for (const bool rpm : {false, true}) {
    Make make{"", "lmdrive"};
    make.switches.speeds_in_rpm = rpm;
    DriveBench bench(make);
    ASSERT_TRUE(under_way(bench)) << bench.sentence();
    const double before = bench.joint_counts();
    bench.elbow().request(AxisRequest::quick_stop);
    EXPECT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::stopped; }, Duration::from_s(2)));
    bench.run(Duration::from_ms(500));
    gone_counts[rpm] = std::abs(bench.joint_counts() - before);
  }
  EXPECT_LE(gone_counts[true], gone_counts[false] + 5);
}

// The master's heartbeat goes on: another device may send it.
TEST(Deadline, ADriveWhoseOrdersAreLostStopsByItself) {
  DriveBench bench({"", "lanternfish"});
  ASSERT_TRUE(under_way(bench)) << bench.sentence();
  Time complained;
  watch_emcy(bench, 0x8250, complained);
  const Time gone = bench.now;
  bench.orders_arrive = false;
  EXPECT_TRUE(bench.run_until([&] { return bench.devices.drives()[2].released; }, Duration::from_ms(1000)));
  EXPECT_NE(complained, Time{});
  EXPECT_NEAR((complained - gone).s(), 0.1, 0.005);
  const double stands = bench.joint_counts();
  bench.run(Duration::from_ms(200));
  EXPECT_NEAR(bench.joint_counts(), stands, 0.5);
}

// Where the object does nothing, the drive stays where it was last told to be.
TEST(UnconfirmedDrive, ADeadlineThatDoesNothingLeavesADriveWithAForeignHeartbeatUnderPower) {
  for (const char* name : {"ingenia", "lmdrive"}) {
    for (const bool ignores : {false, true}) {
      Make make{"", name};
      make.switches.ignores_deadline = ignores;
      DriveBench bench(make);
      ASSERT_TRUE(under_way(bench)) << bench.sentence();
      const std::int32_t target = bench.elbow().target_counts();
      bench.orders_arrive = false;
      bench.run(Duration::from_ms(1500));
      EXPECT_EQ(bench.devices.drives()[2].released, !ignores) << name;
      const double short_of = std::abs(target - bench.joint_counts());
      EXPECT_EQ(short_of < 15, ignores) << name << " " << short_of;
      EXPECT_EQ(short_of > 50, !ignores) << name << " " << short_of;
    }
  }
}

// A profile that says so reads it right.
TEST(UnconfirmedDrive, ATorqueOfAnotherBasisIsReadByItsProfile) {
  for (const char* name : {"ingenia", "lmdrive", "eyou"}) {
    for (const bool told : {false, true}) {
      Make make{"", name};
      make.switches.torque_basis = 2;
      DriveBench bench(make, [told](canopen::NetworkConfig& config, devices::DevicesConfig& devices) {
        devices.drives[2].friction = {};
        if (told) config.drives[2].profile.scale.torque = {1, 2};
      });
      ASSERT_TRUE(bench.boot()) << bench.sentence();
      ASSERT_TRUE(enable(bench));
      const devices::DriveConfig& drive = bench.devices_config.drives[2];
      bench.load_nm = 0.5 * drive.rated_torque_nm * motor_ratio(drive.actuator, bench.joints[2].position_rad, drive.counts_per_rev);
      bench.run(Duration::from_ms(100));
      EXPECT_NEAR(bench.elbow().torque_permille(), told ? 500 : 250, 30) << name;
    }
  }
}

// Which values of 605A and 6007 a make takes is known of EPOS4 and Elmo alone: one that takes a single value stops by it, or is refused before it has power.
TEST_P(FlyingDrive, WithASingleOptionCodeStopsOrIsRefusedByName) {
  const devices::DriveHabit* habit = devices::find_habit(GetParam());
  if (habit == nullptr) return;  // the simulator's own takes every value
  for (const std::uint16_t object : {0x605A, 0x6007}) {
    int flown = 0;
    for (unsigned value = 0; value < 8; ++value) {
      SCOPED_TRACE(std::to_string(object) + " takes " + std::to_string(value));
      devices::DriveHabit changed = *habit;
      (object == 0x605A ? changed.quick_stop_values : changed.abort_values) = 1U << value;
      DriveBench bench({"", GetParam()},
                       [&](canopen::NetworkConfig&, devices::DevicesConfig& devices) { devices.drives[2].habit = &changed; });
      if (!bench.boot()) {
        EXPECT_THAT(bench.sentence(), testing::HasSubstr(object == 0x605A ? "605A" : "6007"));
        EXPECT_FALSE(bench.powered_before_done);
        continue;
      }
      ++flown;
      ASSERT_TRUE(enable(bench));
      (void)set_off(bench);
      const double began = bench.joint_counts();
      if (object == 0x605A) {
        bench.elbow().request(AxisRequest::quick_stop);
        EXPECT_TRUE(bench.run_until([&] { return bench.elbow().state() == AxisState::stopped; }, Duration::from_s(2)));
      } else {
        bench.master_alive = false;  // missed after 300 ms, or by a deadline or a lost SYNC before
      }
      bench.run(Duration::from_ms(object == 0x605A ? 500 : 1200));
      const double stands = bench.joint_counts();
      bench.run(Duration::from_ms(300));
      EXPECT_NEAR(bench.joint_counts(), stands, 0.5);
      EXPECT_LT(std::abs(stands - began), 1500) << "half of the way that was before it";
      if (object != 0x605A) continue;
      bench.elbow().request(AxisRequest::remove_power);
      bench.run(Duration::from_ms(200));
      EXPECT_EQ(bench.devices.power(2), devices::DrivePower::off);
    }
    EXPECT_GE(flown, 1) << object;
  }
}

// Without a word of ours the object has the maker's 1, and a drive that is told 5 goes on for that long.
TEST(ElmoGold, BridgesAsManyLostSyncsAsItsObjectSays) {
  double complained_s[2] = {};
  for (const bool told : {false, true}) {
    DriveBench bench({"", "elmo_gold"}, [&](canopen::NetworkConfig& config, devices::DevicesConfig&) {
      if (!told) config.drives[2].profile.objects.clear();
    });
    ASSERT_TRUE(under_way(bench)) << bench.sentence();
    Time complained;
    watch_emcy(bench, 0x8250, complained);
    const Time gone = bench.now;
    bench.master_alive = false;
    bench.run(Duration::from_ms(150));
    ASSERT_NE(complained, Time{}) << told;
    complained_s[told] = (complained - gone).s();
  }
  EXPECT_NEAR(complained_s[true] - complained_s[false], 4 * 0.004, 0.002);
}

TEST(UnconfirmedDrive, AnEyouThatIgnoresALostMasterStandsAtItsLastTarget) {
  Make make{"", "eyou"};
  make.switches.ignores_lost_master = true;
  DriveBench bench(make);
  ASSERT_TRUE(under_way(bench)) << bench.sentence();
  const std::int32_t target = bench.elbow().target_counts();
  bench.master_alive = false;
  bench.run(Duration::from_ms(1000));
  const double stopped = bench.joint_counts();
  bench.run(Duration::from_ms(500));
  EXPECT_NEAR(bench.joint_counts(), stopped, 0.5);
  EXPECT_NEAR(stopped, target, 15);
  EXPECT_FALSE(bench.devices.drives()[2].released);
}

// EPOS4's 8130 is a fault with 6007's reaction. Where it were none, the drive would stand, and keep its power.
TEST(UnconfirmedDrive, AnEpos4ThatHoldsWithoutItsMasterStandsUnderPower) {
  for (const bool holds : {false, true}) {
    Make make{"", "epos4"};
    make.switches.holds_without_master = holds;
    DriveBench bench(make);
    ASSERT_TRUE(under_way(bench)) << bench.sentence();
    const double before = bench.joint_counts();
    bench.master_alive = false;
    bench.run(Duration::from_ms(1200));
    const double stopped = bench.joint_counts();
    EXPECT_GT(std::abs(stopped - before), 50) << "a ramp, not a halt";
    bench.run(Duration::from_ms(500));
    EXPECT_NEAR(bench.joint_counts(), stopped, 0.5);
    EXPECT_EQ(bench.devices.power(2) != devices::DrivePower::off, holds);
  }
}

// Methods by the makers' numbers: a hard stop found by current, and "here is home".
TEST(DriveHoming, EachDriveFindsItsZeroInItsOwnUnits) {
  struct Case {
    const char* make;
    std::int8_t method;
  };
  for (const Case& c : {Case{"lanternfish", -1}, Case{"epos4", -4}, Case{"epos4", 37}, Case{"elmo_gold", 35}, Case{"ipos", 35},
                        Case{"c5e", 35}, Case{"ingenia", 35}, Case{"lmdrive", 35}, Case{"copley", 35}}) {
    SCOPED_TRACE(std::string(c.make) + " " + std::to_string(c.method));
    DriveBench bench({"", c.make}, [&](canopen::NetworkConfig& config, devices::DevicesConfig& devices) {
      canopen::DriveSetup& drive = config.drives[2];
      drive.homing_method = c.method;
      drive.home_offset_counts = 250;
      if (c.method < 0) {
        drive.homing_speed_counts_s = 1500;
        drive.homing_accel_counts_s2 = 5000;
      }
      devices.drives[2].absolute_encoder = false;
    });
    ASSERT_TRUE(bench.boot()) << bench.sentence();
    EXPECT_FALSE(bench.elbow().homed());
    bench.elbow().request(AxisRequest::home);
    ASSERT_TRUE(bench.run_until([&] { return bench.elbow().homed(); }, Duration::from_s(30))) << canopen::name(bench.elbow().fault());
    EXPECT_NEAR(bench.elbow().actual_counts(), 250, 2);
  }
}

}  // namespace
}  // namespace lf::test
