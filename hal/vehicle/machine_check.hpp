// Holds a vehicle's configuration against the machine that it is read on: interface, camera, users, folders, real time. Nothing is opened for longer than the
// look, nothing is changed.
#pragma once

#include <string>
#include <vector>

#include "hal/vehicle/vehicle_config.hpp"

namespace lf::hal {

struct Finding {
  std::string key;      // of the configuration
  std::string problem;  // one line
  std::string remedy;   // one line
};

// Empty when the daemon can run as it is configured. A daemon that runs has camera and socket in use: that is told as well.
std::vector<Finding> check_machine(const VehicleConfig& config);

}  // namespace lf::hal
