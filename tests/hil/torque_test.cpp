// The joints' torques as the core estimates them from the motors' side, on the simulated arm, whose friction is not quite what the core takes it for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/arm5e_joints.hpp"
#include "tests/hil/joint_bench.hpp"

namespace lf::test {
namespace {

struct Way {
  std::size_t joint;
  double speed_rad_s;
  double blocked_at_rad;  // where the screw has the most lever
};

class TorqueOf : public testing::TestWithParam<Way> {};

// Moving freely both ways: what the drive truly gives the joint, over 40 ms as the estimate is, lies within the bounds.
TEST_P(TorqueOf, AMovingJointIsWithinItsBounds) {
  const Way& way = GetParam();
  const auto index = std::size_t(way.joint);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    JointBench bench(seed);
    ASSERT_TRUE(bench.enable(way.joint));
    int within = 0, all = 0;
    double true_nm = 0, widest = 0;
    for (int i = 0; i < 1400; ++i) {
      bench.move(way.joint, i < 700 ? way.speed_rad_s : -way.speed_rad_s);
      true_nm += (bench.platform->world().readings()[index].torque_nm - true_nm) * 0.1;
      if (i % 700 < 150) continue;  // setting off and turning round
      const safety::JointStates& joints = bench.watch->joints();
      ++all;
      within += true_nm >= joints.torque_low_nm[index] - 0.3 && true_nm <= joints.torque_high_nm[index] + 0.3;
      widest = std::max(widest, joints.torque_high_nm[index] - joints.torque_low_nm[index]);
    }
    EXPECT_GT(within, 0.95 * all) << "seed " << seed << ": " << within << " of " << all;
    EXPECT_LT(widest, 0.2 * bench.nominal.controller.limits.joints[index].max_torque_nm) << "the bounds tell something";
  }
}

// What blocks a joint is pressed on until the watch calls it an overload; with every friction that the simulator draws. The roll's limit lies above its drive's
// torque: a handle that is stuck is a turn that stalls, which lets go and looks again. Its overload is CappedTorqueOf's.
TEST_P(TorqueOf, ABlockedJointIsOverloaded) {
  const Way& way = GetParam();
  const auto index = std::size_t(way.joint);
  if (way.joint == arm5e_joint::roll) return;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    JointBench bench(seed, [&](hal::SimConfig& truth) {
      ArmJoint& joint = truth.world.arm.joints[index];
      (way.speed_rad_s > 0 ? joint.upper_rad : joint.lower_rad) = way.blocked_at_rad;
    });
    ASSERT_TRUE(bench.enable(way.joint));
    for (int i = 0; i < 6000 && bench.overloaded == arm5e_joint::count; ++i) bench.move(way.joint, way.speed_rad_s);
    EXPECT_EQ(bench.overloaded, index) << "seed " << seed << ": " << bench.watch->joints().torque_low_nm[index] << " to "
                                       << bench.watch->joints().torque_high_nm[index] << " N m";
  }
}

INSTANTIATE_TEST_SUITE_P(Each, TorqueOf,
                         testing::Values(Way{arm5e_joint::slew, -0.1, -0.57}, Way{arm5e_joint::shoulder, 0.08, 1.0},
                                         Way{arm5e_joint::elbow, -0.1, 1.12}, Way{arm5e_joint::roll, 0.3, 1.0}),
                         [](const testing::TestParamInfo<Way>& test) { return "Joint" + std::to_string(test.param.joint); });

class CappedTorqueOf : public testing::TestWithParam<std::size_t> {};

// The limits of roll and jaw lie above what their drives may give: only a reading beyond that, of a drive that does not keep its limit, is an overload.
TEST_P(CappedTorqueOf, IsAnOverloadWhenItsDriveDoesNotKeepItsLimit) {
  const auto index = std::size_t(GetParam());
  for (const bool broken : {false, true}) {
    JointBench bench(1, [&](hal::SimConfig& truth) {
      if (broken) truth.devices.faults.push_back({8.0, devices::DeviceFaultKind::torque_high, std::uint8_t(index + 1), 0.5, 0});
    });
    ASSERT_TRUE(bench.enable(GetParam()));
    for (int i = 0; i < 2500; ++i) bench.move(GetParam(), 0.2);
    EXPECT_EQ(bench.overloaded, broken ? index : arm5e_joint::count);
  }
}

INSTANTIATE_TEST_SUITE_P(OfRollAndJaw, CappedTorqueOf, testing::Values(arm5e_joint::roll, arm5e_joint::jaw),
                         [](const auto& test) { return test.param == arm5e_joint::roll ? "Roll" : "Jaw"; });

}  // namespace
}  // namespace lf::test
