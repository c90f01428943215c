#include "host_sim/devices/node_rack.hpp"

#include <utility>

namespace lf::devices {

NodeRack::NodeRack(const DevicesConfig& config, Time start) : config_(config), io_(config.io, config.boot_time) {
  check(config);
  for (const DriveConfig& drive : config.drives) {
    drives_.push_back(std::make_unique<Drive402>(drive, config.boot_time, config.seed));
  }
  for (JointDrive& drive : out_) drive.released = true;
  for (const DeviceFault& fault : config.faults) schedule(fault, start + Duration::from_s(fault.at_s));
}

std::size_t NodeRack::slot_of(std::uint8_t id) {
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (node(slot).id() == id) return slot;
  }
  return slots;
}

void NodeRack::power_on(Time t, const JointReadings& readings) {
  readings_ = readings;
  for (std::size_t slot = 0; slot < slots; ++slot) power_on(slot, t);
}

void NodeRack::power_on(std::size_t slot, Time t) { slot == io_slot ? io_.power_on(t) : drives_[slot]->power_on(t, readings_[slot]); }

void NodeRack::receive(std::size_t slot, const CanFrame& frame, Time t) {
  if (silent_[slot] == 0) node(slot).receive(frame, t);
}

std::vector<CanFrame> NodeRack::take_outbox(std::size_t slot) {
  std::vector<CanFrame> frames = std::exchange(node(slot).outbox(), {});
  if (silent_[slot] > 0) frames.clear();
  return frames;
}

void NodeRack::tick(Time t, const JointReadings& readings, const BusFault& bus_fault) {
  readings_ = readings;
  run_faults(t, bus_fault);
  for (std::size_t i = 0; i < joint_count; ++i) out_[i] = drives_[i]->tick(t, readings[i]);
  io_.set_estop_closed(estop_closed_ && estop_faults_ == 0);
  io_.set_interlock_closed(interlock_closed_ && interlock_faults_ == 0);
  io_.tick(t);
}

void NodeRack::schedule(const DeviceFault& fault, Time begin) {
  const Time end = fault.duration_s > 0 ? begin + Duration::from_s(fault.duration_s) : Time::from_ns(INT64_MAX);
  faults_.push_back({fault, begin, end});
}

void NodeRack::add_fault(const DeviceFault& fault, Time t) {
  DevicesConfig checked = config_;
  checked.faults = {fault};
  check(checked);
  schedule(fault, t);
}

void NodeRack::run_faults(Time t, const BusFault& bus_fault) {
  const auto set = [&](const DeviceFault& what, bool on) {
    if (!set_fault(what, on, t)) bus_fault(what, on);
  };
  for (Fault& fault : faults_) {
    if (!fault.on && !fault.over && t >= fault.begin) {
      fault.on = true;
      set(fault.what, true);
    }
    if (fault.on && t >= fault.end) {
      fault.on = false;
      fault.over = true;
      set(fault.what, false);
    }
  }
}

bool NodeRack::set_fault(const DeviceFault& fault, bool on, Time t) {
  const std::size_t slot = slot_of(fault.node);
  DriveFaults none;
  DriveFaults& drive = slot < joint_count ? drives_[slot]->faults() : none;
  switch (fault.kind) {
    case DeviceFaultKind::overcurrent: drive.overcurrent = on; return true;
    case DeviceFaultKind::hot: drive.hot = on; return true;
    case DeviceFaultKind::following: drive.jammed = on; return true;
    case DeviceFaultKind::stuck_encoder: drive.stuck_encoder = on; return true;
    case DeviceFaultKind::silent: silent_[slot] += on ? 1 : -1; return true;
    case DeviceFaultKind::reboot:
      if (on) power_on(slot, t);
      return true;
    case DeviceFaultKind::estop: estop_faults_ += on ? 1 : -1; return true;
    case DeviceFaultKind::interlock_open: interlock_faults_ += on ? 1 : -1; return true;
    case DeviceFaultKind::drop_frames:
    case DeviceFaultKind::error_frames:
    case DeviceFaultKind::bus_off: break;
  }
  return false;
}

}  // namespace lf::devices
