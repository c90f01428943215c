// Each limit of shared/safety/limits.yaml can act on the simulated arm. Torque, contact and workspace are passed by what the arm itself does. Angles and speeds are
// passed by its readings, too: a shoulder, roll or jaw that runs off at 1.5 times its top speed stays 2 to 8 % under its speed limit, and is stopped for not
// following.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/arm/kinematics.hpp"
#include "firmware/mission/workbench.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/joint_bench.hpp"

namespace lf::test {
namespace {

using safety::Fault;

bool was_found(const JointBench& bench, Fault fault, std::size_t code) {
  return std::find(bench.found.begin(), bench.found.end(), std::pair{fault, static_cast<std::int32_t>(code)}) != bench.found.end();
}

class ALimitOfJoint : public testing::TestWithParam<std::size_t> {};

constexpr double beyond_rad = 0.03;

// The joint stands inside its limits, and its encoder says that it is outside: the jaw's limits lie outside its stops.
TEST_P(ALimitOfJoint, OfAngleActsAtEitherEnd) {
  const std::size_t joint = GetParam();
  for (const bool upper : {false, true}) {
    JointBench bench(1, [&](hal::SimConfig& truth) {
      const ArmJoint& of = truth.world.arm.joints[joint];
      const scenario::Scenario scenario = scenario::load_scenario("default", {});
      const safety::JointLimit limit = scenario::make_nominal(scenario, true).controller.limits.joints[joint];
      const double inside_rad =
          upper ? std::min(limit.max_rad, of.upper_rad) - beyond_rad : std::max(limit.min_rad, of.lower_rad) + beyond_rad;
      truth.world.start_rad[joint] = inside_rad;
      truth.devices.drives[joint].encoder_offset_rad = (upper ? limit.max_rad + beyond_rad : limit.min_rad - beyond_rad) - inside_rad;
    });
    ASSERT_TRUE(bench.enable(joint));
    for (int i = 0; i < 50; ++i) bench.tick();
    EXPECT_TRUE(was_found(bench, Fault::joint_limit, joint)) << (upper ? "upper" : "lower");
  }
}

TEST_P(ALimitOfJoint, OfSpeedActsOnAReadingThatJumps) {
  const std::size_t joint = GetParam();
  JointBench bench(1, [&](hal::SimConfig& truth) {
    truth.devices.faults.push_back({8.0, devices::DeviceFaultKind::encoder_jump, static_cast<std::uint8_t>(joint + 1), 0, 0});
  });
  ASSERT_TRUE(bench.enable(joint));
  while (bench.now.s() < 9) bench.tick();
  EXPECT_TRUE(was_found(bench, Fault::overspeed, joint));
}

TEST(ALimit, OfSpeedActsOnASlewAndAnElbowThatRunOff) {
  for (const std::size_t joint : {arm5e_joint::slew, arm5e_joint::elbow}) {
    JointBench bench(1, [&](hal::SimConfig& truth) {
      const auto node = static_cast<std::uint8_t>(static_cast<std::size_t>(joint) + 1);
      truth.devices.faults.push_back({8.0, devices::DeviceFaultKind::runaway, node, 0, 0});
    });
    ASSERT_TRUE(bench.enable(joint));
    while (bench.now.s() < 9) bench.tick();
    EXPECT_TRUE(was_found(bench, Fault::overspeed, static_cast<std::size_t>(joint)));
  }
}

TEST_P(ALimitOfJoint, OfAgeActsOnADriveThatIsSilent) {
  const std::size_t joint = GetParam();
  JointBench bench(1, [&](hal::SimConfig& truth) {
    truth.devices.faults.push_back({8.0, devices::DeviceFaultKind::silent, static_cast<std::uint8_t>(joint + 1), 0, 0});
  });
  ASSERT_TRUE(bench.enable(joint));
  const double limit_s = bench.nominal.controller.limits.stale_position_s;
  while (bench.now.s() < 8.0) bench.tick();
  EXPECT_FALSE(was_found(bench, Fault::stale_position, joint));
  while (bench.now.s() < 8.0 + limit_s + 0.012) bench.tick();
  EXPECT_TRUE(was_found(bench, Fault::stale_position, joint));
}

INSTANTIATE_TEST_SUITE_P(Each, ALimitOfJoint, testing::Range(std::size_t{0}, arm5e_joint::count));

// The arm stands where the tool is beyond a face of its workspace, and its drives' readings say so.
TEST(ALimit, OfTheWorkspaceActsBeyondEveryFace) {
  const scenario::Scenario scenario = scenario::load_scenario("default", {});
  const safety::Limits limits = scenario::make_nominal(scenario, true).controller.limits;
  constexpr double clearly_m = 0.0022;  // over the 2 mm that the watch tolerates
  std::mt19937 random(1);
  const auto draw = [&] {
    arm::JointVector q = arm::JointVector::Zero();
    for (std::size_t j = 0; j < arm5e_joint::of_arm; ++j) {
      q[static_cast<Eigen::Index>(j)] = std::uniform_real_distribution(limits.joints[j].min_rad, limits.joints[j].max_rad)(random);
    }
    return q;
  };
  const auto acts = [&](const arm::JointVector& q) {
    JointBench bench(1, [&](hal::SimConfig& truth) {
      for (std::size_t j = 0; j < arm5e_joint::of_arm; ++j) truth.world.start_rad[j] = q[static_cast<Eigen::Index>(j)];
    });
    bench.watches_tool = true;
    EXPECT_TRUE(bench.enable(arm5e_joint::slew));
    for (int i = 0; i < 50; ++i) bench.tick();
    return was_found(bench, Fault::workspace, 0);
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      // Beyond this face, and within the others.
      const auto out_m = [&](const arm::JointVector& q) {
        const Vec3 tool_m = test::arm5e.base_from_tool(q).translation();
        double beyond_m = -HUGE_VAL, others_m = -HUGE_VAL;
        for (Eigen::Index other = 0; other < 3; ++other) {
          const auto i = static_cast<std::size_t>(other);
          const double above_m = tool_m[other] - limits.workspace_max_m[i], below_m = limits.workspace_min_m[i] - tool_m[other];
          (other == axis && upper ? beyond_m : others_m) = std::max(other == axis && upper ? beyond_m : others_m, above_m);
          (other == axis && !upper ? beyond_m : others_m) = std::max(other == axis && !upper ? beyond_m : others_m, below_m);
        }
        return std::min(beyond_m, -others_m);
      };
      // Some faces are passed by millimetres only: the farthest of many, and of those around it.
      arm::JointVector q = draw();
      for (int i = 0; i < 200'000 && out_m(q) < clearly_m; ++i) {
        const double step = i % 2 == 0 ? 1 : std::pow(10, -3 * std::uniform_real_distribution()(random));
        const arm::JointVector other = q + step * (draw() - q);
        if (out_m(other) > out_m(q)) q = other;
      }
      ASSERT_GE(out_m(q), clearly_m) << "axis " << axis << (upper ? " upper" : " lower");
      EXPECT_TRUE(acts(q)) << "axis " << axis << (upper ? " upper" : " lower");
    }
  }
  arm::JointVector inside = draw();
  while (safety::workspace_excursion_m(limits, test::arm5e.base_from_tool(inside).translation()) > 0) inside = draw();
  EXPECT_FALSE(acts(inside));
}

// The guard takes the smaller of this limit and half of the joint's own: at 25 N m it never was this one.
TEST(ALimit, OfContactIsTheOneThatActs) {
  const scenario::Scenario scenario = scenario::load_scenario("default", {});
  const safety::Limits limits = scenario::make_nominal(scenario, true).controller.limits;
  safety::Limits tighter = limits;
  tighter.max_contact_torque_nm *= 0.9;
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    EXPECT_EQ(mission::free_motion_guard(test::arm5e, limits).contact_torque_nm[joint], limits.max_contact_torque_nm);
    EXPECT_EQ(mission::free_motion_guard(test::arm5e, tighter).contact_torque_nm[joint], tighter.max_contact_torque_nm);
  }
  safety::Limits wider = limits;
  wider.max_contact_torque_nm *= 1.1;
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    EXPECT_EQ(mission::free_motion_guard(test::arm5e, wider).contact_torque_nm[joint], limits.max_contact_torque_nm)
        << "half of the joint's own";
  }
}

}  // namespace
}  // namespace lf::test
