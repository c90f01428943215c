// Everything that can report a fault outside the steps themselves: the watch over the drives, the operator, the platform's calls, the images, the torque
// of free motion, the laser's interlock, and the steps' time-outs.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/arm/guarded_motion.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::mission {

class FaultSources {
 public:
  FaultSources(const arm::Arm& arm, const safety::Limits& limits);

  // A call of the platform failed since the last tick.
  void on_port_error(Port port);

  // Reports what began in this tick.
  void collect(const StepTick& tick, safety::Vigilance vigilance);

 private:
  static void collect_drives(const StepTick& tick, safety::Vigilance vigilance);
  static void collect_complaints(const StepTick& tick);
  static void collect_orders(const StepTick& tick);
  void collect_ports(const StepTick& tick);
  void collect_images(const StepTick& tick);
  void collect_contact(const StepTick& tick);
  static void collect_jaw(const StepTick& tick);
  static void collect_timeout(const StepTick& tick);

  arm::GuardedMotion free_guard_;                         // of all motion in which nothing may be touched
  std::array<bool, port_count> ports_failed_{};           // since the last tick
  std::array<std::uint32_t, port_count> ticks_failed_{};  // in a row
  std::uint32_t images_lost_ = 0;                         // known of
};

}  // namespace lf::mission
