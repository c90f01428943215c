// Between a strict drive's objects, in its own units and direction, and the counts and thousandths that the simulated drive works in.
#pragma once

#include <vector>

#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "host_sim/devices/devices_config.hpp"

namespace lf::devices {

class DriveUnits {
 public:
  // Objects that only one of the two has are left alone. Both outlive this.
  DriveUnits(const DriveConfig& config, ObjectDictionary& native, ObjectDictionary& drive);

  void take_inputs();   // what was written to the drive
  void give_outputs();  // what the drive says

 private:
  enum class Kind : std::uint8_t { plain, position, length, lower_limit, upper_limit, speed, rate, acceleration, torque, homing_method };
  struct Link {
    Object* native;
    Object* drive;
    Kind kind;
    std::int64_t own = 0;  // the native default, for a drive that holds 0
  };

  void link(ObjectDictionary& native, ObjectDictionary& drive, std::uint16_t index, std::uint8_t sub, Kind kind, bool input,
            std::uint16_t other = 0);
  double factor(Kind kind) const;
  void take(Link& link) const;
  void give(Link& link) const;

  double position_ = 1, speed_ = 1, acceleration_ = 1, torque_ = 1, sign_ = 1;
  std::vector<Link> inputs_, outputs_;
};

}  // namespace lf::devices
