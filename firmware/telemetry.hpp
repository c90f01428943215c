// What the core says of itself every tick, for the record and the operator.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/mission/sight.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/mission/steps.hpp"
#include "firmware/safety/faults.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf {

// Calls of the platform, for on_port_error().
enum class Port : std::uint8_t { clock, can_receive, can_send, camera, panel_submit, panel_receive, telemetry, scan_ring, count };
inline constexpr std::size_t port_count = static_cast<std::size_t>(Port::count);

// A decision of the mission.
struct Event {
  enum class Kind : std::uint8_t {
    step,       // `step` begins
    fault,      // `fault` came up in `step`; `reaction` is taken
    located,    // the panel was found: value is the handle angle in rad of valve `code`; -1: none was looked for
    task_done,  // value: rad reached as seen by the second look, or the button's presses
    task_failed,
    emcy,  // node `code` sent `emcy`; 0x0000 withdraws its complaint
  };
  Kind kind = Kind::step;
  Time t;
  mission::Step step = mission::Step::idle;
  safety::Fault fault = safety::Fault::count;
  safety::Reaction reaction = safety::Reaction::count_only;
  std::uint8_t task = 0;  // index of the task under way
  std::int32_t code = 0;  // what the step or port says of its failure; of `located`, the valve
  double value = 0;
  std::uint16_t emcy = 0;  // of a fault: the EMCY code with which its node reported it; 0: none
};

struct Telemetry {
  Time t;
  mission::Step step = mission::Step::idle;
  bool joints_valid = false;  // each drive has answered lately; if not, the joints' numbers below say nothing
  PerJoint<double> target_rad{};
  PerJoint<double> actual_rad{};
  PerJoint<double> torque_nm{};
  std::uint8_t outputs = 0;  // asked of the output node
  std::uint32_t rejected_inputs = 0;
  std::array<std::uint32_t, safety::fault_count> faults{};
  StaticVector<Event, 24> events;  // of this tick: a look tells of up to 16 valves at once
  mission::Sight sight;            // of the newest look; a fault of panel vision is explained by it
};

}  // namespace lf
