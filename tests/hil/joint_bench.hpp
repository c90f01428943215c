// Network and watch over the simulated arm, one joint of which is moved: what the core's watch says of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "firmware/arm/actuator.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/watch.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {

using Angles = PerJoint<double>;

inline constexpr Angles parked{0, 0.60, 1.90, 0, 0.3};

// Network and watch over the simulated arm, nothing within its reach. One joint is moved at a steady speed.
class JointBench {
 public:
  explicit JointBench(std::uint64_t seed, const std::function<void(hal::SimConfig&)>& change = {}) {
    const scenario::Scenario scenario = scenario::load_scenario("default", {});
    const scenario::Sample sample = scenario::draw(scenario, seed);
    nominal = scenario::make_nominal(scenario, sample.lamps_lit);
    hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal, 1);
    truth.world.base_from_panel.translation().x() += 2;
    truth.world.start_rad = parked;
    if (change) change(truth);
    platform = std::make_unique<hal::SimPlatform>(truth, nobody_);
    network = std::make_unique<canopen::Network>(nominal.controller.network);
    watch = std::make_unique<safety::Watch>(test::arm5e, nominal.controller.limits, nominal.controller.transmissions);
  }

  // False when the joint does not come into power.
  bool enable(std::size_t joint) {
    network->start_boot(now);
    for (int i = 0; i < 2000 && network->boot().state == canopen::BootState::running; ++i) tick();
    for (int i = 0; i < 500 && !network->axis(joint).enabled(); ++i) {
      network->axis(joint).request(canopen::AxisRequest::hold_enabled);
      tick();
    }
    target_ = network->axis(joint).actual_counts();
    return network->axis(joint).enabled();
  }

  void move(std::size_t joint, double speed_rad_s) {
    const double per_count = arm::rad_per_count(test::arm5e.joint(joint), watch->joints().position_rad[std::size_t(joint)]);
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
    for (std::size_t i = 0; i < arm5e_joint::count; ++i)
      rad[i] = arm::rad_from_counts(test::arm5e.joint(i), network->axis(i).actual_counts());
    watch->observe(*network, rad, now);
    safety::FaultArbiter began;
    const Vec3 tool_m =
        watches_tool ? test::arm5e.base_from_tool(arm::planar_joints(rad[0], rad[1], rad[2], rad[3])).translation() : Vec3(0.2, 0, 0.5);
    watch->check(*network, tool_m, safety::Vigilance::joints, now, began);
    for (const safety::FaultReport& report : began.reports()) {
      if (report.fault == safety::Fault::overload) overloaded = static_cast<std::size_t>(report.code);
      found.emplace_back(report.fault, report.code);
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
  bool watches_tool = false;  // else the tool is taken for inside its workspace
  std::size_t overloaded = arm5e_joint::count;
  std::vector<std::pair<safety::Fault, std::int32_t>> found;  // every fault that began, with its code

 private:
  hal::SimObserver nobody_;
  double target_ = 0;
};

}  // namespace lf::test
