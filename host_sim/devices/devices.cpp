#include "host_sim/devices/devices.hpp"

#include <deque>
#include <vector>

#include "host_sim/devices/bus/can_bus.hpp"
#include "host_sim/devices/canopen/node_rack.hpp"

namespace lf::devices {
namespace {

constexpr std::uint32_t controller_bus_off = CanFrame::error_flag | 0x40;     // SocketCAN's CAN_ERR_BUSOFF
constexpr std::uint32_t controller_restarted = CanFrame::error_flag | 0x100;  // CAN_ERR_RESTARTED

}  // namespace

struct Devices::Impl {
  Impl(const DevicesConfig& config, Time start) : rack(config, start), now(start) {}

  void run_bus(Time until);
  void deliver(const BusRecord& record);
  void collect(std::size_t slot, Time at);
  void set_bus_fault(const DeviceFault& fault, bool on);
  void set_bus_off(std::uint8_t id, bool off);
  void set_second_master(const DeviceFault& fault, bool on);
  void run_second_master();

  NodeRack rack;
  CanBus bus;
  std::deque<BusRecord> to_master;
  std::function<void(const BusRecord&)> tap;
  Time now;
  bool powered = false;

  // A second master's frames, from when on each is due.
  struct Foreign {
    DeviceFault what;
    Time due;
  };
  std::vector<Foreign> foreign;
};

namespace {

bool same(const DeviceFault& a, const DeviceFault& b) { return a.kind == b.kind && a.node == b.node && a.at_s == b.at_s; }

// What the second master of the kind sends.
CanFrame foreign_frame(const DeviceFault& fault) {
  CanFrame frame;
  switch (fault.kind) {
    case DeviceFaultKind::foreign_rpdo:
      frame.id = 0x200u + fault.node;
      if (fault.node == can_map::io_node) {
        frame.length = 4;
        frame.data = {can_map::output_laser, 0, 0, 0};
      } else {
        frame.length = 8;
        frame.data = {0x0F, 0};  // operation enabled, target 0
      }
      return frame;
    case DeviceFaultKind::foreign_sdo:
      frame.id = 0x600u + fault.node;
      frame.length = 8;
      frame.data = {0x40, 0x18, 0x10, 0x01};  // upload 1018:01
      return frame;
    case DeviceFaultKind::foreign_sync: frame.id = 0x080; return frame;
    case DeviceFaultKind::foreign_nmt:
    case DeviceFaultKind::foreign_reset:
      frame.id = 0x000;
      frame.length = 2;
      frame.data = {fault.kind == DeviceFaultKind::foreign_nmt ? std::uint8_t{0x80} : std::uint8_t{0x82}, 0};
      return frame;
    default:
      frame.id = 0x700u + can_map::master_node;
      frame.length = 1;
      frame.data = {0x05};
      return frame;
  }
}

// A master that runs the arm sends all of its frames in every SYNC period.
std::vector<CanFrame> foreign_frames(const DeviceFault& fault, const DevicesConfig& config) {
  if (fault.kind != DeviceFaultKind::foreign_master) return {foreign_frame(fault)};
  DeviceFault part = fault;
  part.kind = DeviceFaultKind::foreign_sync;
  std::vector<CanFrame> frames{foreign_frame(part)};
  part.kind = DeviceFaultKind::foreign_rpdo;
  for (const DriveConfig& drive : config.drives) {
    part.node = drive.node;
    frames.push_back(foreign_frame(part));
  }
  part.kind = DeviceFaultKind::foreign_heartbeat;
  frames.push_back(foreign_frame(part));
  return frames;
}

Duration period_of(const DeviceFault& fault) {
  return fault.kind == DeviceFaultKind::foreign_master ? can_map::sync_period : second_master_period;
}

}  // namespace

void Devices::Impl::set_second_master(const DeviceFault& fault, bool on) {
  std::erase_if(foreign, [&](const Foreign& known) { return same(known.what, fault); });
  if (on) foreign.push_back({fault, now});
}

void Devices::Impl::run_second_master() {
  for (Foreign& each : foreign) {
    if (now < each.due) continue;
    for (const CanFrame& frame : foreign_frames(each.what, rack.config())) bus.send(second_master, frame, now);
    each.due = each.due + period_of(each.what);
  }
}

void Devices::Impl::run_bus(Time until) {
  BusRecord record;
  while (bus.next(until, record)) deliver(record);
}

void Devices::Impl::deliver(const BusRecord& record) {
  if (tap) tap(record);
  if (record.sender != can_map::master_node && !bus.bus_off(can_map::master_node)) to_master.push_back(record);
  for (std::size_t slot = 0; slot < rack.slots(); ++slot) {
    const std::uint8_t id = rack.node(slot).id();
    if (id == record.sender || bus.bus_off(id)) continue;
    rack.receive(slot, record.frame, record.delivered);
    collect(slot, record.delivered + rack.config().reaction);
  }
}

void Devices::Impl::collect(std::size_t slot, Time at) {
  for (const CanFrame& frame : rack.take_outbox(slot)) bus.send(rack.node(slot).id(), frame, at);
}

void Devices::Impl::set_bus_fault(const DeviceFault& fault, bool on) {
  if (fault.kind == DeviceFaultKind::drop_frames) bus.drop(fault.can_id, on);
  if (fault.kind == DeviceFaultKind::error_frames) bus.set_error_frames(on);
  if (fault.kind == DeviceFaultKind::bus_off) set_bus_off(fault.node, on);
  if (of_a_second_master(fault.kind)) set_second_master(fault, on);
}

void Devices::Impl::set_bus_off(std::uint8_t id, bool off) {
  bus.set_bus_off(id, off);
  if (id == can_map::master_node) {
    BusRecord record;
    record.frame.id = off ? controller_bus_off : controller_restarted;
    record.frame.length = 8;
    record.delivered = now;
    record.sender = id;
    to_master.push_back(record);
    return;
  }
  Node& lost = rack.node(rack.slot_of(id));
  off ? lost.bus_off(now) : lost.bus_recovered(now);
}

Devices::Devices(const DevicesConfig& config, Time start) : impl_(std::make_unique<Impl>(config, start)) {}
Devices::~Devices() = default;
Devices::Devices(Devices&&) noexcept = default;
Devices& Devices::operator=(Devices&&) noexcept = default;

bool Devices::master_sends(const CanFrame& frame, Time t) { return impl_->bus.send(can_map::master_node, frame, std::max(t, impl_->now)); }

void Devices::step(Time t, const JointReadings& readings) {
  Impl& d = *impl_;
  if (!d.powered) {
    d.powered = true;
    d.rack.power_on(d.now, readings);
  }
  d.run_bus(t);
  d.now = t;
  d.rack.tick(t, readings, [&d](const DeviceFault& fault, bool on) { d.set_bus_fault(fault, on); });
  d.run_second_master();
  for (std::size_t slot = 0; slot < d.rack.slots(); ++slot) d.collect(slot, t);
}

const JointDrives& Devices::drives() const { return impl_->rack.drives(); }

bool Devices::next_to_master(CanFrame& frame, Time& delivered) {
  if (impl_->to_master.empty()) return false;
  frame = impl_->to_master.front().frame;
  delivered = impl_->to_master.front().delivered;
  impl_->to_master.pop_front();
  return true;
}

bool Devices::laser_on() const { return impl_->rack.laser_on(); }
bool Devices::lamps_on() const { return impl_->rack.lamps_on(); }
std::optional<Exposure> Devices::take_exposure() { return impl_->rack.take_exposure(); }
void Devices::set_estop_closed(bool closed) { impl_->rack.set_estop_closed(closed); }
void Devices::set_interlock_closed(bool closed) { impl_->rack.set_interlock_closed(closed); }
void Devices::add_fault(const DeviceFault& fault, Time t) { impl_->rack.add_fault(fault, t); }
DrivePower Devices::power(std::size_t joint) const { return impl_->rack.power(joint); }
BusStats Devices::bus() const { return impl_->bus.stats(); }
void Devices::set_tap(std::function<void(const BusRecord&)> tap) { impl_->tap = std::move(tap); }

}  // namespace lf::devices
