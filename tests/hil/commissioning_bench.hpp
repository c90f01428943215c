// The simulated arm as a commissioning finds it, and the loop that gives it the bus.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware/arm/actuator.hpp"
#include "hal/lockstep.hpp"
#include "hal/sim/sim_platform.hpp"
#include "hal/vehicle/commissioning.hpp"
#include "host_sim/scenario/instance.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {

using Zeros = PerJoint<std::int32_t>;
using Angles = PerJoint<double>;

inline constexpr Zeros somewhere{12'345, -70'000, 7, 100'123, -54'321};
// Folded, the jaw closed.
inline const Angles parked{0, 0.60, 1.90, 0, test::arm5e.model().joints[4].lower_rad + 0.004};
// Screws rub, and what is not known of that before costs 0.02 degrees.
inline constexpr double allowed_rad = 0.07 * pi / 180;

// The arm with nothing within its reach, and drives whose zeros nobody knows.
class CommissioningBench {
 public:
  explicit CommissioningBench(
      const Zeros& zeros, const Angles& start_rad = parked, const std::vector<devices::DeviceFault>& faults = {},
      const std::function<void(hal::SimConfig&)>& change = [](hal::SimConfig&) {}, const std::vector<std::string>& overrides = {})
      : zeros_(zeros) {
    const scenario::Scenario scenario = scenario::load_scenario("default", overrides);
    const scenario::Sample sample = scenario::draw(scenario, 1);
    nominal_ = scenario::make_nominal(scenario, sample.lamps_lit);
    hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal_, 1);
    truth.world.base_from_panel.translation().x() += 2;
    truth.world.start_rad = start_rad;
    truth.devices.faults = faults;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      truth.devices.drives[i].encoder_zero_counts = zeros[i];
      truth.devices.drives[i].encoder_offset_rad = 0;
      backlash_rad_[i] = truth.world.arm.joints[i].backlash_rad;
    }
    change(truth);
    drives_ = truth.devices.drives;
    platform_ = std::make_unique<hal::SimPlatform>(truth, nobody_);
  }

  hal::Commissioning::Config config() const {
    hal::Commissioning::Config config;
    config.network = nominal_.controller.network;
    config.backlash_rad = backlash_rad_;
    config.transmissions = nominal_.controller.transmissions;
    // The jaw's zero is an old one, the others' are not known.
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) config.network.drives[i].zero_known = i == 4;
    config.network.drives[4].encoder_zero_counts = zeros_[4];
    config.jaw_known = true;
    return config;
  }

  void run(
      hal::Commissioning& commissioning, const std::function<bool()>& called_off = [] { return false; }) {
    while (!commissioning.ended()) {
      Time now;
      (void)platform_->wait_for_tick(now);
      for (hal::ReceivedFrame received; platform_->receive_can(0, received) == hal::port_ok;) {
        if (ear_) ear_(received.frame);
        commissioning.on_frame(received.frame, received.t);
      }
      if (called_off()) commissioning.stop("it was called off");
      canopen::Outbox outbox;
      commissioning.tick(now, outbox);
      (void)platform_->send_can(0, {outbox.data(), outbox.size()});
    }
  }
  // Gets each frame before the master does, and may change it.
  void set_ear(const std::function<void(CanFrame&)>& ear) { ear_ = ear; }
  // Of the true drives, not of what the master was told.
  bool any_powered() const {
    const JointDrives drives = platform_->devices().drives();
    return std::any_of(drives.begin(), drives.end(), [](const JointDrive& drive) { return !drive.released; });
  }

  // Half a count is what rounding costs.
  double tolerance_rad(std::size_t joint) const {
    return allowed_rad + 0.5 * arm::rad_per_count(test::arm5e.joint(joint), angles()[joint]);
  }
  // How far the angle at the joint's place is off when the zero is taken to be `zero_counts`.
  double error_rad(std::size_t joint, std::int32_t zero_counts) const {
    const double per_count = arm::rad_per_count(test::arm5e.joint(joint), angles()[joint]);
    return (zero_counts - zeros_[joint]) * per_count;
  }

  Angles angles() const {
    Angles all{};
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) all[i] = platform_->world().readings()[i].position_rad;
    return all;
  }
  const scenario::Nominal& nominal() const { return nominal_; }
  const devices::DriveConfig& drive(std::size_t joint) const { return drives_[joint]; }
  const Angles& backlash_rad() const { return backlash_rad_; }
  hal::SimPlatform& platform() { return *platform_; }

 private:
  Zeros zeros_;
  Angles backlash_rad_{};
  std::vector<devices::DriveConfig> drives_;
  scenario::Nominal nominal_;
  hal::SimObserver nobody_;
  std::function<void(CanFrame&)> ear_;
  std::unique_ptr<hal::SimPlatform> platform_;
};

}  // namespace lf::test
