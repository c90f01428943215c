#include "host_sim/devices/devices.hpp"

#include <deque>
#include <vector>

#include "host_sim/devices/can_bus.hpp"
#include "host_sim/devices/drive402.hpp"
#include "host_sim/devices/io_node.hpp"

namespace lf::devices {
namespace {

constexpr std::size_t io_slot = joint_count;  // drives come first
constexpr std::size_t slots = joint_count + 1;
constexpr std::uint32_t controller_bus_off = CanFrame::error_flag | 0x40;     // SocketCAN's CAN_ERR_BUSOFF
constexpr std::uint32_t controller_restarted = CanFrame::error_flag | 0x100;  // CAN_ERR_RESTARTED

struct Fault {
  DeviceFault what;
  Time begin, end;
  bool on = false;
  bool over = false;
};

}  // namespace

struct Devices::Impl {
  Impl(const DevicesConfig& config, Time start);

  Node& node(std::size_t slot) { return slot == io_slot ? io.node() : drives[slot]->node(); }
  std::size_t slot_of(std::uint8_t id);
  void run_bus(Time until);
  void deliver(const BusRecord& record);
  void collect(std::size_t slot, Time at);
  void run_faults(Time now);
  void set_fault(const DeviceFault& fault, bool on, Time now);
  void set_bus_off(std::uint8_t id, bool off, Time now);

  DevicesConfig config;
  CanBus bus;
  std::vector<std::unique_ptr<Drive402>> drives;
  IoNode io;
  std::array<int, slots> silent{};
  std::vector<Fault> faults;
  std::deque<BusRecord> to_master;
  std::function<void(const BusRecord&)> tap;
  JointDrives out;
  JointReadings readings{};
  Time now;
  bool powered = false;
  bool estop_closed = true, interlock_closed = true;
  int estop_faults = 0, interlock_faults = 0;
};

Devices::Impl::Impl(const DevicesConfig& c, Time start) : config(c), io(c.io, c.boot_time), now(start) {
  check(config);
  for (const DriveConfig& drive : config.drives) {
    drives.push_back(std::make_unique<Drive402>(drive, config.boot_time, config.seed));
  }
  for (JointDrive& drive : out) drive.released = true;
  for (const DeviceFault& fault : config.faults) {
    const Time begin = start + Duration::from_s(fault.at_s);
    const Time end = fault.duration_s > 0 ? begin + Duration::from_s(fault.duration_s) : Time::from_ns(INT64_MAX);
    faults.push_back({fault, begin, end});
  }
}

std::size_t Devices::Impl::slot_of(std::uint8_t id) {
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (node(slot).id() == id) return slot;
  }
  return slots;
}

void Devices::Impl::run_bus(Time until) {
  BusRecord record;
  while (bus.next(until, record)) deliver(record);
}

void Devices::Impl::deliver(const BusRecord& record) {
  if (tap) tap(record);
  if (record.sender != can_map::master_node && !bus.bus_off(can_map::master_node)) to_master.push_back(record);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    Node& receiver = node(slot);
    if (receiver.id() == record.sender || silent[slot] > 0 || bus.bus_off(receiver.id())) continue;
    receiver.receive(record.frame, record.delivered);
    collect(slot, record.delivered + config.reaction);
  }
}

void Devices::Impl::collect(std::size_t slot, Time at) {
  Node& sender = node(slot);
  if (silent[slot] == 0) {
    for (const CanFrame& frame : sender.outbox()) bus.send(sender.id(), frame, at);
  }
  sender.outbox().clear();
}

void Devices::Impl::run_faults(Time t) {
  for (Fault& fault : faults) {
    if (!fault.on && !fault.over && t >= fault.begin) {
      fault.on = true;
      set_fault(fault.what, true, t);
    }
    if (fault.on && t >= fault.end) {
      fault.on = false;
      fault.over = true;
      set_fault(fault.what, false, t);
    }
  }
}

void Devices::Impl::set_fault(const DeviceFault& fault, bool on, Time t) {
  const std::size_t slot = slot_of(fault.node);
  DriveFaults none;
  DriveFaults& drive = slot < joint_count ? drives[slot]->faults() : none;
  switch (fault.kind) {
    case DeviceFaultKind::overcurrent: drive.overcurrent = on; return;
    case DeviceFaultKind::hot: drive.hot = on; return;
    case DeviceFaultKind::following: drive.jammed = on; return;
    case DeviceFaultKind::stuck_encoder: drive.stuck_encoder = on; return;
    case DeviceFaultKind::silent: silent[slot] += on ? 1 : -1; return;
    case DeviceFaultKind::reboot:
      if (on) slot == io_slot ? io.power_on(t) : drives[slot]->power_on(t, readings[slot]);
      return;
    case DeviceFaultKind::estop: estop_faults += on ? 1 : -1; return;
    case DeviceFaultKind::interlock_open: interlock_faults += on ? 1 : -1; return;
    case DeviceFaultKind::drop_frames: bus.drop(fault.can_id, on); return;
    case DeviceFaultKind::error_frames: bus.set_error_frames(on); return;
    case DeviceFaultKind::bus_off: set_bus_off(fault.node, on, t); return;
  }
}

void Devices::Impl::set_bus_off(std::uint8_t id, bool off, Time t) {
  bus.set_bus_off(id, off);
  if (id == can_map::master_node) {
    BusRecord record;
    record.frame.id = off ? controller_bus_off : controller_restarted;
    record.frame.length = 8;
    record.delivered = t;
    record.sender = id;
    to_master.push_back(record);
    return;
  }
  Node& lost = node(slot_of(id));
  off ? lost.bus_off(t) : lost.bus_recovered(t);
}

Devices::Devices(const DevicesConfig& config, Time start) : impl_(std::make_unique<Impl>(config, start)) {}
Devices::~Devices() = default;
Devices::Devices(Devices&&) noexcept = default;
Devices& Devices::operator=(Devices&&) noexcept = default;

bool Devices::master_sends(const CanFrame& frame, Time t) { return impl_->bus.send(can_map::master_node, frame, std::max(t, impl_->now)); }

void Devices::step(Time t, const JointReadings& readings) {
  Impl& d = *impl_;
  d.readings = readings;
  if (!d.powered) {
    d.powered = true;
    for (std::size_t i = 0; i < joint_count; ++i) d.drives[i]->power_on(d.now, readings[i]);
    d.io.power_on(d.now);
  }
  d.run_bus(t);
  d.now = t;
  d.run_faults(t);
  for (std::size_t i = 0; i < joint_count; ++i) {
    d.out[i] = d.drives[i]->tick(t, readings[i]);
    d.collect(i, t);
  }
  d.io.set_estop_closed(d.estop_closed && d.estop_faults == 0);
  d.io.set_interlock_closed(d.interlock_closed && d.interlock_faults == 0);
  d.io.tick(t);
  d.collect(io_slot, t);
}

const JointDrives& Devices::drives() const { return impl_->out; }

bool Devices::next_to_master(CanFrame& frame, Time& delivered) {
  if (impl_->to_master.empty()) return false;
  frame = impl_->to_master.front().frame;
  delivered = impl_->to_master.front().delivered;
  impl_->to_master.pop_front();
  return true;
}

bool Devices::laser_on() const { return impl_->io.laser_on(); }
bool Devices::lamps_on() const { return impl_->io.lamps_on(); }
std::optional<Exposure> Devices::take_exposure() { return impl_->io.take_exposure(); }
void Devices::set_estop_closed(bool closed) { impl_->estop_closed = closed; }
void Devices::set_interlock_closed(bool closed) { impl_->interlock_closed = closed; }
BusStats Devices::bus() const { return impl_->bus.stats(); }
void Devices::set_tap(std::function<void(const BusRecord&)> tap) { impl_->tap = std::move(tap); }

}  // namespace lf::devices
