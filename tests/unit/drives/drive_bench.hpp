// The master and six simulated nodes over the simulated bus, with joints that turn as their drives say and weigh nothing.
#pragma once

#include <functional>
#include <string>

#include "firmware/canopen/network.hpp"
#include "hal/config/machine.hpp"
#include "host_sim/devices/devices.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {

struct Make {
  std::string profile;     // of the core; empty: that of the drive
  std::string dictionary;  // of the simulated drive: a habit's name, or lanternfish
  devices::DriveSwitches switches{};
  bool reversed = false;
};

// The elbow is of this make, the others are the simulator's own.
class DriveBench {
 public:
  explicit DriveBench(const Make& make, const std::function<void(canopen::NetworkConfig&, devices::DevicesConfig&)>& change = {});

  bool boot();  // true when all nodes are in operation
  void run(Duration time);
  bool run_until(const std::function<bool()>& done, Duration limit);

  canopen::Axis& elbow() { return network.axis(arm5e_joint::elbow); }
  std::string sentence() const;  // why the elbow did not boot
  double joint_counts() const;   // the elbow's motor, in the arm's counts

  canopen::NetworkConfig config;
  devices::DevicesConfig devices_config;
  canopen::Network network;
  devices::Devices devices;
  JointReadings joints{};
  Time now;
  bool master_alive = true;
  bool orders_arrive = true;         // else nothing of the master's arrives but its heartbeat and guard requests, as another sends them
  double load_nm = 0;                // that the elbow's drive holds
  bool powered_before_done = false;  // a joint was not released while the boot ran

 private:
  void step();
  int ms_ = 0;
};

}  // namespace lf::test
