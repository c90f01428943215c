// The drives and the output node side by side, with what goes wrong in them, and no bus between them: who owns the rack carries their frames,
// over a simulated bus (devices.hpp) or a real one (host_sim/serve).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/devices/devices_config.hpp"
#include "host_sim/devices/drive/drive402.hpp"
#include "host_sim/devices/exposure.hpp"
#include "host_sim/devices/io_node.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

class NodeRack {
 public:
  // Faults count from `start`. Throws InputError as Devices does.
  NodeRack(const DevicesConfig& config, Time start);

  const DevicesConfig& config() const { return config_; }
  // Drives come first, in the order of the joints.
  std::size_t io_slot() const { return drives_.size(); }
  std::size_t slots() const { return drives_.size() + 1; }
  Node& node(std::size_t slot) { return slot == io_slot() ? io_.node() : drives_[slot]->node(); }
  std::size_t slot_of(std::uint8_t node);  // slots() when there is none

  // Power comes on at every node, or dips at one.
  void power_on(Time t, const JointReadings& readings);
  void power_on(std::size_t slot, Time t);

  // A frame reaches a node, which may leave answers in its outbox; a silent one hears nothing.
  void receive(std::size_t slot, const CanFrame& frame, Time t);
  // Takes what a node wants to send, oldest first; what a silent one wants is lost.
  std::vector<CanFrame> take_outbox(std::size_t slot);

  // Told of faults of the bus itself (of_the_bus), which are its owner's to make.
  using BusFault = std::function<void(const DeviceFault&, bool on)>;

  // One millisecond of everything: configured faults begin and end, then drives close their loops on `readings`, which are those at `t`.
  void tick(Time t, const JointReadings& readings, const BusFault& bus_fault);
  const JointDrives& drives() const { return out_; }

  // A fault from now on, besides the configured ones. Throws InputError as the constructor does.
  void add_fault(const DeviceFault& fault, Time t);

  DrivePower power(std::size_t joint) const;

  bool laser_on() const { return io_.laser_on(); }
  bool lamps_on() const { return io_.lamps_on(); }
  std::optional<Exposure> take_exposure() { return io_.take_exposure(); }
  void set_estop_closed(bool closed) { estop_closed_ = closed; }
  void set_interlock_closed(bool closed) { interlock_closed_ = closed; }

 private:
  struct Fault {
    DeviceFault what;
    Time begin, end;
    bool on = false;
    bool over = false;
  };

  void schedule(const DeviceFault& fault, Time begin);
  void run_faults(Time t, const BusFault& bus_fault);
  // False when the fault is the bus's.
  bool set_fault(const DeviceFault& fault, bool on, Time t);
  void set_identity(std::size_t slot);
  void tick_drive(std::size_t joint, Time t, JointReading reading);

  DevicesConfig config_;
  std::vector<std::unique_ptr<Drive402>> drives_;
  IoNode io_;
  // What is tampered with between a drive and its joint or its dictionary.
  struct Tampering {
    bool encoder_jump = false, torque_frozen = false, runaway = false;
    std::int64_t torque_object = 0;  // 6077 as it froze
    std::int64_t window = 0;         // 6065 before the runaway
  };
  PerJoint<Tampering> tampering_;
  std::array<int, capacity::nodes> silent_{};
  std::vector<Fault> faults_;
  JointDrives out_;
  JointReadings readings_{};
  bool estop_closed_ = true, interlock_closed_ = true;
  int estop_faults_ = 0, interlock_faults_ = 0;
};

}  // namespace lf::devices
