// The joints' torques as the core estimates them from the motors' side, on the simulated arm, whose friction is not quite what the core takes it for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>

#include "firmware/arm/actuator.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/watch.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::test {
namespace {

using Angles = std::array<double, joint_count>;

constexpr Angles parked{0, 0.60, 1.90, 0, 0.3};

// Network and watch over the simulated arm, nothing within its reach. One joint is moved at a steady speed.
class Bench {
 public:
  explicit Bench(std::uint64_t seed, const std::function<void(hal::SimConfig&)>& change = {}) {
    const scenario::Scenario scenario = scenario::load_scenario("default", {});
    const scenario::Sample sample = scenario::draw(scenario, seed);
    nominal = scenario::make_nominal(scenario, sample.lamps_lit);
    hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal, 1);
    truth.world.base_from_panel.translation().x() += 2;
    truth.world.start_rad = parked;
    if (change) change(truth);
    platform = std::make_unique<hal::SimPlatform>(truth, nobody_);
    network = std::make_unique<canopen::Network>(nominal.controller.network);
    watch = std::make_unique<safety::Watch>(nominal.controller.limits, nominal.controller.transmissions);
  }

  // False when the joint does not come into power.
  bool enable(Joint joint) {
    network->start_boot(now);
    for (int i = 0; i < 2000 && network->boot().state == canopen::BootState::running; ++i) tick();
    for (int i = 0; i < 500 && !network->axis(joint).enabled(); ++i) {
      network->axis(joint).request(canopen::AxisRequest::hold_enabled);
      tick();
    }
    target_ = network->axis(joint).actual_counts();
    return network->axis(joint).enabled();
  }

  void move(Joint joint, double speed_rad_s) {
    const double per_count = arm::rad_per_count(joint, watch->joints().position_rad[std::size_t(joint)]);
    target_ += speed_rad_s * 0.004 / per_count;
    const double lead = 0.05 / per_count, actual = network->axis(joint).actual_counts();
    target_ = std::clamp(target_, actual - lead, actual + lead);
    network->axis(joint).set_target_counts(static_cast<std::int32_t>(std::lround(target_)));
    tick();
  }

  void tick() {
    (void)platform->wait_for_tick(now);
    for (hal::ReceivedFrame received; platform->receive_can(0, received) == hal::port_ok;) network->on_frame(received.frame, received.t);
    Angles rad{};
    for (std::size_t i = 0; i < joint_count; ++i)
      rad[i] = arm::rad_from_counts(static_cast<Joint>(i), network->axis(static_cast<Joint>(i)).actual_counts());
    watch->observe(*network, rad, now);
    safety::FaultArbiter began;
    watch->check(*network, Vec3(0.2, 0, 0.5), safety::Vigilance::joints, now, began);
    for (const safety::FaultReport& report : began.reports()) {
      if (report.fault == safety::Fault::overload) overloaded = static_cast<std::size_t>(report.code);
    }
    canopen::Outbox outbox;
    network->tick(now, outbox);
    (void)platform->send_can(0, {outbox.data(), outbox.size()});
  }

  scenario::Nominal nominal;
  std::unique_ptr<hal::SimPlatform> platform;
  std::unique_ptr<canopen::Network> network;
  std::unique_ptr<safety::Watch> watch;
  Time now;
  std::size_t overloaded = joint_count;

 private:
  hal::SimObserver nobody_;
  double target_ = 0;
};

struct Way {
  Joint joint;
  double speed_rad_s;
  double blocked_at_rad;  // where the screw has the most lever
};

class TorqueOf : public testing::TestWithParam<Way> {};

// Moving freely both ways: what the drive truly gives the joint, over 40 ms as the estimate is, lies within the bounds.
TEST_P(TorqueOf, AMovingJointIsWithinItsBounds) {
  const Way& way = GetParam();
  const auto index = std::size_t(way.joint);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Bench bench(seed);
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
// torque: a handle that is stuck is a turn that stalls, which lets go and looks again.
TEST_P(TorqueOf, ABlockedJointIsOverloaded) {
  const Way& way = GetParam();
  const auto index = std::size_t(way.joint);
  if (way.joint == Joint::roll) return;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    Bench bench(seed, [&](hal::SimConfig& truth) {
      ArmJoint& joint = truth.world.arm.joints[index];
      (way.speed_rad_s > 0 ? joint.upper_rad : joint.lower_rad) = way.blocked_at_rad;
    });
    ASSERT_TRUE(bench.enable(way.joint));
    for (int i = 0; i < 6000 && bench.overloaded == joint_count; ++i) bench.move(way.joint, way.speed_rad_s);
    EXPECT_EQ(bench.overloaded, index) << "seed " << seed << ": " << bench.watch->joints().torque_low_nm[index] << " to "
                                       << bench.watch->joints().torque_high_nm[index] << " N m";
  }
}

INSTANTIATE_TEST_SUITE_P(Each, TorqueOf,
                         testing::Values(Way{Joint::slew, -0.1, -0.57}, Way{Joint::shoulder, 0.08, 1.0}, Way{Joint::elbow, -0.1, 1.12},
                                         Way{Joint::roll, 0.3, 1.0}),
                         [](const testing::TestParamInfo<Way>& test) { return "Joint" + std::to_string(std::size_t(test.param.joint)); });

// The jaw grips with all that its drive may give: only a reading beyond that, of a drive that does not keep its limit, is an overload.
TEST(TorqueOfTheJaw, IsAnOverloadWhenItsDriveDoesNotKeepItsLimit) {
  for (const bool broken : {false, true}) {
    Bench bench(1, [&](hal::SimConfig& truth) {
      if (broken) truth.devices.faults.push_back({8.0, devices::DeviceFaultKind::torque_high, 5, 0.5, 0});
    });
    ASSERT_TRUE(bench.enable(Joint::jaw));
    for (int i = 0; i < 2500; ++i) bench.move(Joint::jaw, 0.2);
    EXPECT_EQ(bench.overloaded, broken ? std::size_t(Joint::jaw) : joint_count);
  }
}

}  // namespace
}  // namespace lf::test
