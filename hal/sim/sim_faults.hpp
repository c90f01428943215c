// What goes wrong in a simulated run, and when: at a time, or at a step of the mission, which the simulator reads from the core's telemetry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/mission/steps.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

// config::fault_kinds() says what each does.
enum class SimFaultKind : std::uint8_t {
  device,  // of the devices or their bus: `SimFault::device`
  clock_lost,
  can_receive_fails,
  can_send_fails,
  camera_fails,
  panel_submit_fails,
  panel_receive_fails,
  telemetry_fails,
  vision_stalled,
  image_lost,
  camera_silent,
  camera_frozen,
  sensor_frozen,
  vision_late,
  vision_silent,
  vision_poor,
  handle_breaks,
  obstacle,
  abort_ordered,
  estop_ordered,
  shut_down_ordered,
  count
};
inline constexpr std::size_t sim_fault_kinds = static_cast<std::size_t>(SimFaultKind::count);

struct SimFault {
  SimFaultKind kind = SimFaultKind::device;
  devices::DeviceFault device;  // its times are not read
  double at_s = 0;
  mission::Step at_step = mission::Step::count;  // `count`: `at_s` counts from power-on
  double after_s = 0;                            // after `at_step` began for the first time
  double duration_s = 0;                         // 0: for the rest of the run
};

// Keeps the faults' times. Those of the devices end by themselves; of the others it knows which are on.
class FaultSchedule {
 public:
  explicit FaultSchedule(const std::vector<SimFault>& faults);

  void add(const SimFault& fault);
  // The mission is in this step now.
  void in_step(mission::Step step, Time now);
  // The next fault that begins by `now`, each once; nullptr when there is none. Faults whose duration is over end.
  const SimFault* next(Time now);
  // When this step began for the first time; nothing when it has not.
  std::optional<Time> entered(mission::Step step) const;
  bool on(SimFaultKind kind) const { return on_[static_cast<std::size_t>(kind)] > 0; }

 private:
  struct Entry {
    SimFault fault;
    Time begin, end;
    bool timed = false;  // `begin` is known
    bool begun = false, over = false;
  };

  std::vector<Entry> entries_;
  std::array<int, sim_fault_kinds> on_{};
  std::array<Time, mission::step_count> entered_{};
  std::array<bool, mission::step_count> seen_{};
};

}  // namespace lf::hal
