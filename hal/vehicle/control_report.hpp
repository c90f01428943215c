// What the control thread and the vision thread say of themselves ten times a second, for status and log: plain numbers that cross a ring.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/controller.hpp"
#include "hal/vehicle/commissioning.hpp"
#include "hal/vehicle/socket_can.hpp"
#include "shared/messages/scan_messages.hpp"

namespace lf::hal {

struct ControlReport {
  Time t;
  bool commissioning = false;  // in the core's place
  Commissioning::State commissioning_state = Commissioning::State::booting;
  std::size_t commissioning_joint = 0;
  mission::Standing standing = mission::Standing::idle;
  mission::Step step = mission::Step::idle;
  mission::Outcome outcome;
  mission::FaultCounts faults_after_end{};
  StaticVector<mission::TaskResult, mission::MissionConfig::max_tasks> tasks;
  PerJoint<canopen::AxisState> axes{};
  PerJoint<bool> zeros_lost{};             // the joint needs a zero: its drive has lost its position, and does not home by itself
  std::uint32_t cores_taken = 0;           // exchanges of the core before this report
  std::uint32_t commissionings_ended = 0;  // that had begun, before this report
  bool jaw_doubted = false;                // the core does not know what the jaw holds
  PerJoint<canopen::AxisFault> axis_faults{};
  std::uint8_t inputs = 0, outputs = 0;  // of the output node, bits of can_map
  bool inputs_fresh = false;             // it says so now: it is in operation
  canopen::BootReport boot;
  canopen::NetworkStats network;
  std::array<std::uint32_t, port_count> port_errors{};
  std::uint32_t orders_refused = 0;
  std::uint32_t rejected_inputs = 0;
  ScanStats scan;
  SocketCan::Stats can;
  std::uint64_t ticks = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t page_faults = 0;  // of the control thread, since its first tick
  std::uint64_t heap_calls = 0;   // of the control thread's turns and of the core on the vision thread, since the first tick
  std::uint64_t frames_unlogged = 0;
  bool realtime = false;  // the control thread is SCHED_FIFO
};

struct CameraReport {
  std::uint64_t images = 0, skipped = 0, broken = 0, repeated = 0, missed = 0;
  std::uint32_t stamps_missed = 0, controls_refused = 0, losses = 0, reopened = 0, restarts = 0;
  int status = 0;  // of the last look: port_ok, port_empty or errno
};

}  // namespace lf::hal
