// A DBC of all that is on a machine's bus, for tools that decode a log: process data in units of the joints, NMT, SYNC, emergencies, services, heartbeats.
//
// Process data are those that the master maps (docs/canopen.md); can_map.yaml has their places. The format is Vector's, as canmatrix and SavvyCAN read it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lf::app {

struct DbcDrive {
  std::string name;
  std::uint8_t node = 0;
  // Of one of the drive's units, in its direction: radians of the joint, or the metres by which its screw grows. What a drive counts where the joint's own count is 0 is
  // found at commissioning, and not in it.
  double position = 1;
  bool screw = false;
  double torque_nm = 1;       // of one of the drive's units, at the motor's shaft
  bool torque_offset = true;  // the drive takes one
};

std::string dbc(const std::vector<DbcDrive>& drives, std::uint8_t outputs_node);

}  // namespace lf::app
