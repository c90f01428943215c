// A robot on the test bench: one scenario's world, devices and core, stepped by the test, with sight given (known_sight.hpp) and every port able to fail.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/lockstep.hpp"
#include "hal/mock/failing_platform.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"
#include "tests/hil/bus_watch.hpp"
#include "tests/hil/known_sight.hpp"

namespace lf::test {

class Rig {
 public:
  using Platform = hal::FailingPlatform<KnownSight>;
  // Changes what the core is told before it starts.
  using Tell = std::function<void(ControllerConfig&)>;

  // Changes what is true.
  using Make = std::function<void(hal::SimConfig&)>;

  explicit Rig(const std::vector<std::string>& overrides = {}, std::uint64_t seed = 1, const Tell& tell = {}, const Make& make = {});

  void start() { controller().on_command(Command::start, now()); }
  void step();
  void run_for(double seconds);
  // Until the mission is in `step`, or has ended, or `limit_s` of simulated time have passed since the call. True when it is there.
  bool run_to(mission::Step step, double limit_s = 120);
  // Until the mission has ended; false when it has not after `limit_s`.
  bool run_to_end(double limit_s = 300);

  Controller& controller() { return lockstep_->controller(); }
  const mission::Mission& mission() { return controller().mission(); }
  mission::Step step_now() { return mission().step(); }
  const mission::Outcome& outcome() { return mission().outcome(); }
  Platform& ports() { return *failing_; }
  KnownSight& sight() { return *sight_; }
  // From now on the jaw moves between these angles only, and stands between them: something is between the fingers, or behind them.
  void block_jaw(double lower_rad, double upper_rad) { platform_->block_jaw(lower_rad, upper_rad); }
  // From now on something floats up from the wrist's left and pushes against it; see World::push_obstacle.
  void push_obstacle() {
    hal::SimFault fault;
    fault.kind = hal::SimFaultKind::obstacle;
    fault.at_s = now().s();
    platform_->add_fault(fault);
  }
  // From now on the handle is gone.
  void break_handle() {
    hal::SimFault fault;
    fault.kind = hal::SimFaultKind::handle_breaks;
    fault.at_s = now().s();
    platform_->add_fault(fault);
  }
  devices::Devices& devices() { return platform_->devices(); }
  const world::World& world() const { return platform_->world(); }
  const ScanPipeline& pipeline() const { return lockstep_->pipeline(); }
  const std::vector<Event>& events() const { return recorder_.events; }
  const ArmDescription& arm() const { return arm_; }
  Time now() const { return lockstep_->now(); }

  BusWatch& bus() { return recorder_.bus; }
  bool any_power() const { return recorder_.bus.any_power(platform_->devices()); }  // from the drives' side
  double fastest_joint_rad_s() const;                                               // of all five, in truth
  std::uint32_t count(safety::Fault fault) const;                                   // events of it
  // How it ended and what happened on the way, for failure messages.
  std::string story();

 private:
  class Recorder : public hal::SimObserver {
   public:
    void on_telemetry(const Telemetry& telemetry) override {
      for (const Event& event : telemetry.events) events.push_back(event);
    }
    void on_bus_frame(const devices::BusRecord& record) override { bus.on_frame(record); }
    std::vector<Event> events;
    BusWatch bus;
  };

  Recorder recorder_;
  ArmDescription arm_;
  std::unique_ptr<hal::SimPlatform> platform_;
  std::unique_ptr<KnownSight> sight_;
  std::unique_ptr<Platform> failing_;
  std::unique_ptr<hal::Lockstep<Platform>> lockstep_;
};

}  // namespace lf::test
