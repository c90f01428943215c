// The CAN bus with everything on it but the master: five servo drives and the output node, in simulated time.
//
// There is no side door: the master reaches the nodes with frames, the world with joint readings, and nothing else does.
// Order of one millisecond of a lockstep platform, at time t (a multiple of 1 ms):
//   world.step(devices.drives())      -> readings at t
//   devices.step(t, readings)            the bus runs from t - 1 ms to t, then every drive closes its loop
//   while (devices.next_to_master(f, at)) controller.on_can(0, f, at);
//   every 4th: controller.tick(t) -> devices.master_sends(frame, t) for each
// A frame sent at t is on the bus from t on; a SYNC sent at t arrives about 50 us later, which is when outputs switch, positions are latched and the
// camera's exposure starts. Answers come about 0.2 to 1 ms after the SYNC, so they reach the master before its next tick.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "host_sim/devices/bus/bus_record.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "host_sim/devices/exposure.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

class Devices {
 public:
  // Power comes on at `start`: boot-up messages follow `boot_time` later. Throws InputError if a drive's figures are impossible
  // (no stroke, no torque, a screw whose triangle does not close, a node number twice) or a fault names an unknown node.
  explicit Devices(const DevicesConfig& config, Time start = {});
  ~Devices();
  Devices(Devices&&) noexcept;
  Devices& operator=(Devices&&) noexcept;

  // Queues a frame in the master's controller at `t`, not before the last step's time. False when its 64 places are full or it is off the bus.
  bool master_sends(const CanFrame& frame, Time t);

  // Runs the bus up to `t`, then the drives on `readings`, which are those at `t`. `t` grows by 1 ms a call.
  void step(Time t, const JointReadings& readings);

  // What the drives do to the joints until the next step.
  const JointDrives& drives() const;

  // Frames that reached the master up to the last step, in order, each once. Error frames of its own controller come with CanFrame::error_flag and
  // SocketCAN's classes: 0x40 bus off, 0x100 restarted.
  bool next_to_master(CanFrame& frame, Time& delivered);

  bool laser_on() const;  // after the interlock
  bool lamps_on() const;
  std::optional<Exposure> take_exposure();  // oldest first, each once

  // Inputs of the output node beside those that faults open. Both chains are closed (healthy) at first.
  void set_estop_closed(bool closed);
  void set_interlock_closed(bool closed);

  // A fault from `t` on, besides the configured ones; its `at_s` is not read. Throws InputError as the constructor does.
  void add_fault(const DeviceFault& fault, Time t);
  DrivePower power(std::size_t joint) const;  // ground truth

  BusStats bus() const;
  // Called for every frame delivered on the bus, in the order of time, whoever sent it.
  void set_tap(std::function<void(const BusRecord&)> tap);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lf::devices
