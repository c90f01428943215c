#include "host_sim/devices/canopen/node_rack.hpp"

#include <utility>

namespace lf::devices {

namespace {

constexpr double encoder_jump_rad = 0.25;     // a coupling that slips by a tooth of some 14 degrees
constexpr double runaway_of_top_speed = 1.5;  // what is left of the supply's reserve
constexpr std::uint16_t following_window = 0x6065, torque_actual = 0x6077, identity = 0x1018;
constexpr std::int64_t no_window = 0xFFFFFFFF;
constexpr std::int64_t wrong_product = 0x10;  // xor'ed: another device of the same vendor

}  // namespace

NodeRack::NodeRack(const DevicesConfig& config, Time start) : config_(config), io_(config.io, config.boot_time) {
  check(config);
  for (const DriveConfig& drive : config.drives) {
    drives_.push_back(std::make_unique<Drive402>(drive, config.boot_time, config.seed));
  }
  for (JointDrive& drive : out_) drive.released = true;
  for (const DeviceFault& fault : config.faults) schedule(fault, start + Duration::from_s(fault.at_s));
}

std::size_t NodeRack::slot_of(std::uint8_t id) {
  for (std::size_t slot = 0; slot < slots(); ++slot) {
    if (node(slot).id() == id) return slot;
  }
  return slots();
}

void NodeRack::power_on(Time t, const JointReadings& readings) {
  readings_ = readings;
  for (std::size_t slot = 0; slot < slots(); ++slot) power_on(slot, t);
}

void NodeRack::power_on(std::size_t slot, Time t) { slot == io_slot() ? io_.power_on(t) : drives_[slot]->power_on(t, readings_[slot]); }

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
  for (std::size_t i = 0; i < drives_.size(); ++i) tick_drive(i, t, readings[i]);
  io_.set_estop_closed(estop_closed_ && estop_faults_ == 0);
  io_.set_interlock_closed(interlock_closed_ && interlock_faults_ == 0);
  io_.tick(t);
}

void NodeRack::tick_drive(std::size_t joint, Time t, JointReading reading) {
  const Tampering& tampering = tampering_[joint];
  const DriveConfig& config = config_.drives[joint];
  if (tampering.encoder_jump) reading.motor_position_rad += encoder_jump_rad;
  out_[joint] = drives_[joint]->tick(t, reading);
  if (tampering.runaway && drives_[joint]->state() == DriveState::operation_enabled)
    out_[joint].velocity_rad_s = runaway_of_top_speed * config.max_velocity_rad_s;
  if (Object* torque = drives_[joint]->node().objects().find(torque_actual, 0); torque != nullptr && tampering.torque_frozen)
    torque->value = tampering.torque_object;
}

DrivePower NodeRack::power(std::size_t joint) const {
  switch (drives_[joint]->state()) {
    case DriveState::operation_enabled: return DrivePower::operation;
    case DriveState::quick_stop_active:
    case DriveState::fault_reaction_active: return DrivePower::stopping;
    default: return DrivePower::off;
  }
}

// The second call undoes the first.
void NodeRack::set_identity(std::size_t slot) {
  Object* product = node(slot).objects().find(identity, 2);
  if (product == nullptr) return;
  product->value ^= wrong_product;
  product->power_on ^= wrong_product;
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
  if (of_the_bus(fault.kind)) return false;
  const std::size_t slot = slot_of(fault.node);
  DriveFaults none;
  Tampering untouched;
  Tampering& tampering = slot < drives_.size() ? tampering_[slot] : untouched;
  DriveFaults& drive = slot < drives_.size() ? drives_[slot]->faults() : none;
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
    case DeviceFaultKind::encoder_jump: tampering.encoder_jump = on; return true;
    case DeviceFaultKind::torque_high: drive.high_torque = on; return true;
    case DeviceFaultKind::torque_frozen: {
      const Object* torque = slot < drives_.size() ? drives_[slot]->node().objects().find(torque_actual, 0) : nullptr;
      tampering.torque_object = torque != nullptr ? torque->value : 0;
      tampering.torque_frozen = on;
      return true;
    }
    case DeviceFaultKind::runaway: {
      Object* window = slot < drives_.size() ? drives_[slot]->node().objects().find(following_window, 0) : nullptr;
      if (window != nullptr) {
        if (on) tampering.window = window->value;
        window->value = on ? no_window : tampering.window;
      }
      tampering.runaway = on;
      return true;
    }
    case DeviceFaultKind::wrong_identity: set_identity(slot); return true;
    default: return false;
  }
}

}  // namespace lf::devices
