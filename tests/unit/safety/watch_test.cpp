// The watch over the joints' places, on a booted bus of scripted nodes: the places themselves are the test's.
#include "firmware/safety/watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/canopen/scripted_node.hpp"

namespace lf::safety {
namespace {

class WatchTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bus.boot()); }

  static Limits limits() {
    Limits limits;
    arm5e_joint::fill(limits.joints, JointLimit{-1, 1, 100, 100});
    limits.workspace_min_m = {-9, -9, -9};
    limits.workspace_max_m = {9, 9, 9};
    limits.stale_position_s = 0.012;
    return limits;
  }

  // Joint-limit faults that begin while the slew stands at `rad` for some cycles.
  int faults_at(double rad) {
    int began = 0;
    for (int i = 0; i < 10; ++i) {
      bus.step();
      watch.observe(bus.network, {rad, 0, 0, 0, 0}, bus.now);
      EXPECT_TRUE(watch.joints().valid);
      FaultArbiter reports;
      watch.check(bus.network, Vec3::Zero(), Vigilance::joints, bus.now, reports);
      for (const FaultReport& report : reports.reports()) began += report.fault == Fault::joint_limit && report.code == 0;
    }
    return began;
  }

  canopen::test::Bus bus{canopen::test::plain_config()};
  Watch watch{test::arm5e, limits()};
};

TEST_F(WatchTest, NamesAJointBeyondItsLimitOnce) {
  EXPECT_EQ(faults_at(1.009), 0) << "noise";
  EXPECT_FALSE(watch.outside(0));
  EXPECT_EQ(faults_at(1.02), 1);
  EXPECT_TRUE(watch.any_outside());
  EXPECT_EQ(faults_at(1.2), 0) << "the same, still";
  EXPECT_EQ(faults_at(0.5), 0);
  EXPECT_EQ(faults_at(-1.02), 1);
}

TEST_F(WatchTest, BearsAJointThatComesBackAndNoneThatGoesOn) {
  bus.step();
  watch.observe(bus.network, {1.2, 0, 0, 0, 0}, bus.now);
  watch.tolerate_excursion(true);
  EXPECT_EQ(faults_at(1.2), 0);
  EXPECT_EQ(faults_at(1.207), 0) << "noise";
  EXPECT_EQ(faults_at(1.1), 0);
  EXPECT_TRUE(watch.outside(0)) << "borne, but not forgotten";
  EXPECT_EQ(faults_at(1.12), 1) << "it has been at 1.1";
  EXPECT_EQ(faults_at(0.9), 0);
  EXPECT_EQ(faults_at(1.02), 1) << "it has been inside";
}

TEST_F(WatchTest, BearsNothingOnceTheLimitsAreTheLimitsAgain) {
  bus.step();
  watch.observe(bus.network, {-1.05, 0, 0, 0, 0}, bus.now);
  watch.tolerate_excursion(true);
  EXPECT_EQ(faults_at(-1.05), 0);
  watch.tolerate_excursion(false);
  EXPECT_EQ(faults_at(-1.05), 1);
}

// ---- every limit trips ----

class EachLimit : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bus.boot()); }

  static Limits loose() {
    Limits limits;
    arm5e_joint::fill(limits.joints, JointLimit{-1, 1, 100, 1e5});
    limits.workspace_min_m = {-1, -1, -1};
    limits.workspace_max_m = {1, 1, 1};
    limits.stale_position_s = 0.012;
    return limits;
  }

  // How often `fault` begins within some cycles under these limits. Joint 2 turns at `speed_rad_s`, from 0.
  int begins(const Limits& limits, Fault fault, double speed_rad_s = 0, const Vec3& tool_m = Vec3::Zero(), int cycles = 100) {
    Watch watch{test::arm5e, limits, transmissions};
    int began = 0;
    double rad = 0;
    for (int i = 0; i < cycles; ++i) {
      bus.step();
      rad += speed_rad_s * 0.004;
      watch.observe(bus.network, {0, 0, rad, 0, 0}, bus.now);
      FaultArbiter reports;
      watch.check(bus.network, tool_m, watched, bus.now, reports);
      for (const FaultReport& report : reports.reports()) began += report.fault == fault;
    }
    return began;
  }

  Watch::Transmissions transmissions;
  Vigilance watched = Vigilance::joints;
  canopen::test::Bus bus{canopen::test::plain_config()};
};

TEST_F(EachLimit, OfSpeed) {
  Limits limits = loose();
  EXPECT_EQ(begins(limits, Fault::overspeed, 0.5), 0);
  limits.joints[2].max_speed_rad_s = 0.35;
  EXPECT_EQ(begins(limits, Fault::overspeed, 0.5), 1);
}

// A drive that waits for the others under power ran away unseen: powering up waited for one in fault.
TEST_F(EachLimit, OfSpeedHoldsWhileOtherDrivesAreStillBeingEnabled) {
  watched = Vigilance::nodes;
  Limits limits = loose();
  limits.joints[2].max_speed_rad_s = 0.35;
  EXPECT_EQ(begins(limits, Fault::overspeed, 0.5), 0) << "it has no power: somebody moves it";
  bus.network.axis(arm5e_joint::elbow).request(canopen::AxisRequest::hold_enabled);
  for (int i = 0; i < 50; ++i) bus.step();
  ASSERT_TRUE(bus.network.axis(arm5e_joint::elbow).enabled());
  EXPECT_EQ(begins(limits, Fault::overspeed, 0.5), 1);
  EXPECT_EQ(begins(limits, Fault::following_error), 0);
}

TEST_F(EachLimit, OfTheFollowingWindowHoldsWhileOtherDrivesAreStillBeingEnabled) {
  watched = Vigilance::nodes;
  bus.network.axis(arm5e_joint::elbow).request(canopen::AxisRequest::hold_enabled);
  for (int i = 0; i < 50; ++i) bus.step();
  bus.nodes[2].jammed = true;
  bus.nodes[2].actual_counts += 100'000;
  EXPECT_EQ(begins(loose(), Fault::following_error), 1);
}

TEST_F(EachLimit, OfTorque) {
  Limits limits = loose();
  bus.nodes[2].torque_permille = 500;
  EXPECT_EQ(begins(limits, Fault::overload), 0);
  // The motor's torque, through the screw at angle 0: half of the rated one.
  const double joint_nm =
      0.5e-6 * bus.network.axis(arm5e_joint::elbow).rated_torque_unm() * arm::Transmission(test::arm5e.joint(arm5e_joint::elbow)).ratio(0);
  limits.joints[2].max_torque_nm = 0.95 * joint_nm;
  EXPECT_EQ(begins(limits, Fault::overload), 1);
  // A reading may be wrong by a hundredth of the rated torque: what may be within the limit is no overload.
  limits.joints[2].max_torque_nm = 0.985 * joint_nm;
  EXPECT_EQ(begins(limits, Fault::overload), 0);
  // At rest, through a screw that rubs, the same reading is surely less torque, and may be any more.
  limits.joints[2].max_torque_nm = 0.75 * joint_nm;
  transmissions[2].friction = {0, 0, 0.7, 0};
  EXPECT_EQ(begins(limits, Fault::overload), 0);
  limits.joints[2].max_torque_nm = 0.65 * joint_nm;
  EXPECT_EQ(begins(limits, Fault::overload), 1);
}

TEST_F(EachLimit, OfPosition) {
  Limits limits = loose();
  EXPECT_EQ(begins(limits, Fault::joint_limit, 0.5), 0);
  limits.joints[2].max_rad = 0.05;
  EXPECT_EQ(begins(limits, Fault::joint_limit, 0.5), 1);
  limits = loose();
  limits.joints[2].min_rad = -0.05;
  EXPECT_EQ(begins(limits, Fault::joint_limit, -0.5), 1);
}

TEST_F(EachLimit, OfTheWorkspaceOnEverySide) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 tool_m = Vec3::Zero();
      tool_m[axis] = side * 0.9;
      EXPECT_EQ(begins(loose(), Fault::workspace, 0, tool_m), 0);
      tool_m[axis] = side * 1.01;
      EXPECT_EQ(begins(loose(), Fault::workspace, 0, tool_m), 1);
    }
  }
}

// Two cycles without process data are borne at three cycles' limit, and a fault at one cycle's: a mission may tighten it.
TEST_F(EachLimit, OfAPositionsAge) {
  const auto with_a_gap = [this](double stale_s) {
    Limits limits = loose();
    limits.stale_position_s = stale_s;
    Watch watch{test::arm5e, limits};
    int began = 0;
    for (int i = 0; i < 30; ++i) {
      bus.nodes[2].mute_tpdo = i >= 10 && i < 12;
      bus.step();
      watch.observe(bus.network, {}, bus.now);
      FaultArbiter reports;
      watch.check(bus.network, Vec3::Zero(), Vigilance::joints, bus.now, reports);
      for (const FaultReport& report : reports.reports()) began += report.fault == Fault::stale_position && report.code == 2;
    }
    return began;
  };
  EXPECT_EQ(with_a_gap(0.012), 0);
  EXPECT_EQ(with_a_gap(0.004), 1);
}

TEST_F(EachLimit, AToolOutsideMayComeBackAndNotGoOn) {
  Watch watch{test::arm5e, loose()};
  const auto began = [&](double x_m) {
    bus.step();
    watch.observe(bus.network, {}, bus.now);
    FaultArbiter reports;
    watch.check(bus.network, Vec3(x_m, 0, 0), Vigilance::joints, bus.now, reports);
    return reports.reports().size();
  };
  watch.tolerate_excursion(true);
  EXPECT_EQ(began(1.10), 0u);
  EXPECT_TRUE(watch.any_outside());
  EXPECT_EQ(began(1.05), 0u);
  EXPECT_EQ(began(1.08), 1u) << "it has been at 1.05";
  EXPECT_EQ(began(0.99), 0u);
  EXPECT_FALSE(watch.any_outside());
  EXPECT_EQ(began(1.01), 1u) << "it has been inside";
}

// ---- links ----

class Links : public EachLimit {
 protected:
  std::vector<FaultReport> reports_of(int cycles, Vigilance vigilance) {
    std::vector<FaultReport> all;
    for (int i = 0; i < cycles; ++i) {
      bus.step();
      watch.observe(bus.network, {}, bus.now);
      FaultArbiter reports;
      watch.check(bus.network, Vec3::Zero(), vigilance, bus.now, reports);
      all.insert(all.end(), reports.reports().begin(), reports.reports().end());
    }
    return all;
  }
  Watch watch{test::arm5e, loose()};
};

TEST_F(Links, AnOutputNodeThatIsSilentIsAFaultWithinFourCycles) {
  for (const Vigilance vigilance : {Vigilance::nodes, Vigilance::joints}) {
    EXPECT_TRUE(reports_of(10, vigilance).empty());
    bus.nodes[5].mute_tpdo = true;
    const auto reports = reports_of(5, vigilance);
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0].fault, Fault::io_lost);
    bus.nodes[5].mute_tpdo = false;
  }
}

TEST_F(Links, AComplaintOfADriveIsAFaultWithItsCode) {
  EXPECT_TRUE(reports_of(10, Vigilance::joints).empty());
  bus.nodes[2].send_emcy(0x3210, 0x05);
  const auto reports = reports_of(5, Vigilance::joints);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].fault, Fault::drive_fault);
  EXPECT_EQ(reports[0].code, 2);
  EXPECT_EQ(reports[0].emcy, 0x3210);
}

TEST_F(Links, FramesOfASecondMasterAreAFaultWithTheirIdentifier) {
  EXPECT_TRUE(reports_of(10, Vigilance::nodes).empty());
  for (const std::uint32_t id : {0x203u, 0x405u, 0x080u, 0x000u, 0x602u, 0x77Fu}) {
    CanFrame foreign;
    foreign.id = id;
    foreign.length = 2;
    bus.network.on_frame(foreign, bus.now);
    const auto reports = reports_of(3, Vigilance::nodes);
    ASSERT_EQ(reports.size(), 1u) << id;
    EXPECT_EQ(reports[0].fault, Fault::second_master);
    EXPECT_EQ(reports[0].code, static_cast<std::int32_t>(id));
  }
}

void send_foreign(canopen::Network& network, std::uint32_t id, Time now) {
  CanFrame foreign;
  foreign.id = id;
  foreign.length = 2;
  network.on_frame(foreign, now);
}

std::vector<std::int32_t> codes(const std::vector<FaultReport>& reports) {
  std::vector<std::int32_t> codes;
  for (const FaultReport& report : reports) {
    EXPECT_EQ(report.fault, Fault::second_master);
    codes.push_back(report.code);
  }
  return codes;
}

TEST_F(Links, EachIdentifierOfASecondMasterInOneTickIsAFault) {
  EXPECT_TRUE(reports_of(10, Vigilance::nodes).empty());
  for (const std::uint32_t id : {0x203u, 0x080u, 0x203u, 0x602u}) send_foreign(bus.network, id, bus.now);
  EXPECT_THAT(codes(reports_of(1, Vigilance::nodes)), testing::ElementsAre(0x203, 0x080, 0x602));
  EXPECT_EQ(bus.network.foreign()[0].frames, 2u);
  EXPECT_EQ(bus.network.foreign()[1].frames, 1u);
}

TEST_F(Links, AnIdentifierThatJoinsASecondMasterThatSendsInEveryTickIsAFault) {
  EXPECT_TRUE(reports_of(10, Vigilance::nodes).empty());
  for (int tick = 0; tick < 10; ++tick) {
    send_foreign(bus.network, 0x080, bus.now);
    if (tick >= 5) send_foreign(bus.network, 0x201, bus.now);
    const std::vector<std::int32_t> seen = codes(reports_of(1, Vigilance::nodes));
    const std::vector<std::int32_t> wanted = tick == 0   ? std::vector<std::int32_t>{0x080}
                                             : tick == 5 ? std::vector<std::int32_t>{0x201}
                                                         : std::vector<std::int32_t>{};
    EXPECT_EQ(seen, wanted) << "tick " << tick;
  }
}

// Nine identifiers that order no drive fill every named place: a tenth that does is not hidden by them.
TEST_F(Links, AnIdentifierBeyondTheNamedOnesIsAFaultAndAnRpdoIsToldThoughOthersGoOn) {
  EXPECT_TRUE(reports_of(10, Vigilance::nodes).empty());
  for (std::uint32_t node = 1; node <= 9; ++node) send_foreign(bus.network, 0x600 + node, bus.now);
  EXPECT_EQ(reports_of(1, Vigilance::nodes).size(), 9u);
  // A SYNC in each tick, and then set points beside it.
  for (int tick = 0; tick < 5; ++tick) {
    send_foreign(bus.network, 0x080, bus.now);
    EXPECT_TRUE(reports_of(1, Vigilance::nodes).empty());
  }
  send_foreign(bus.network, 0x080, bus.now);
  send_foreign(bus.network, 0x204, bus.now);
  EXPECT_THAT(codes(reports_of(1, Vigilance::nodes)), testing::ElementsAre(0x204));
  EXPECT_EQ(bus.network.foreign()[canopen::ForeignFrames::others].frames, 7u);
  EXPECT_EQ(bus.network.foreign()[canopen::ForeignFrames::other_rpdos].frames, 1u);
  EXPECT_EQ(bus.network.foreign_frames(), 16u);
}

}  // namespace
}  // namespace lf::safety
