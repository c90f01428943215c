#include "firmware/mission/fault_sources.hpp"

namespace lf::mission {

using safety::Fault;

namespace {

// One late tick is jitter; three are the time after which a position is stale.
constexpr std::uint32_t lost_ticks = 3;

}  // namespace

FaultSources::FaultSources(const arm::Arm& arm, const safety::Limits& limits) : free_guard_(free_motion_guard(arm, limits)) {}

void FaultSources::on_port_error(Port port) { ports_failed_[static_cast<std::size_t>(port)] = true; }

void FaultSources::collect(const StepTick& tick, safety::Vigilance vigilance) {
  // Ports before nodes: of what comes up in one tick, a bus that cannot be read explains nodes that are not heard.
  collect_ports(tick);
  collect_drives(tick, vigilance);
  collect_complaints(tick);
  collect_orders(tick);
  collect_images(tick);
  collect_contact(tick);
  collect_jaw(tick);
  if (tick.bench.camera.laser_inhibited()) tick.faults.report(Fault::interlock);
  collect_timeout(tick);
}

void FaultSources::collect_drives(const StepTick& tick, safety::Vigilance vigilance) {
  Workbench& bench = tick.bench;
  const Vec3 tool_m = bench.config.arm.base_from_tool(bench.measured_rad()).translation();
  bench.watch.check(tick.network, tool_m, vigilance, tick.now, tick.faults);
}

// What the nodes complain of goes into the record, whether it is a fault or not.
void FaultSources::collect_complaints(const StepTick& tick) {
  while (const std::optional<canopen::Emcy> emcy = tick.network.take_emcy()) {
    Event event;
    event.kind = Event::Kind::emcy;
    event.t = emcy->time;
    event.step = tick.step;
    event.task = static_cast<std::uint8_t>(tick.bench.job.index());
    event.code = emcy->node;
    event.emcy = emcy->code;
    (void)tick.telemetry.events.push_back(event);
  }
}

void FaultSources::collect_orders(const StepTick& tick) {
  OrderMailbox& mailbox = tick.bench.mailbox;
  if (mailbox.take(Command::emergency_stop)) tick.faults.report(Fault::estop, 1);
  if (mailbox.take(Command::abort) && tick.bench.course != Course::giving_up) tick.faults.report(Fault::aborted);
}

// Before the start nothing is lost with the bus.
void FaultSources::collect_ports(const StepTick& tick) {
  for (std::size_t port = 0; port < port_count; ++port) {
    const auto which = static_cast<Port>(port);
    const bool matters = which == Port::clock || tick.step != Step::idle;
    std::uint32_t& ticks = ticks_failed_[port];
    ticks = ports_failed_[port] && matters ? ticks + 1 : 0;
    if (ports_failed_[port]) tick.faults.report(Fault::port_error, static_cast<std::int32_t>(port));
    if (ticks != lost_ticks) continue;
    if (which == Port::clock) tick.faults.report(Fault::clock_lost, static_cast<std::int32_t>(ticks));
    if (which == Port::can_receive || which == Port::can_send) tick.faults.report(Fault::bus_off, static_cast<std::int32_t>(port));
  }
  ports_failed_ = {};
}

// A sweep tolerates a lost frame, but not a camera that is silent.
void FaultSources::collect_images(const StepTick& tick) {
  CameraWork& camera = tick.bench.camera;
  const std::uint32_t lost = camera.images_lost() - images_lost_;
  if (lost != 0) tick.faults.report(Fault::image_lost, static_cast<std::int32_t>(lost));
  images_lost_ = camera.images_lost();
  if (camera.take_silence()) tick.faults.report(Fault::camera_lost);
}

// After a contact or a grip the arm's load has changed: the torque of free motion is learned anew.
void FaultSources::collect_contact(const StepTick& tick) {
  const safety::Phase phase = row(tick.step).phase;
  const bool free = phase == safety::Phase::free || phase == safety::Phase::scan || tick.step == Step::stow;
  const Workbench& bench = tick.bench;
  if (!bench.powered || !free) return free_guard_.reset();
  const safety::JointStates& joints = bench.watch.joints();
  if (!joints.valid) return;
  bench.feel(free_guard_, joints.t);
  bench.report_touch(free_guard_, tick.faults);
}

void FaultSources::collect_jaw(const StepTick& tick) {
  const Workbench& bench = tick.bench;
  if (!bench.powered || bench.gripper.state() != arm::GripperState::lost) return;
  tick.faults.report(Fault::following_error, static_cast<std::int32_t>(bench.config.arm.jaw_joint()));
}

void FaultSources::collect_timeout(const StepTick& tick) {
  const double margin_s = row(tick.step).margin_s;
  const Duration limit = tick.clock.planned() + Duration::from_s(margin_s);
  if (margin_s <= 0 || tick.clock.elapsed(tick.now) <= limit) return;
  // What keeps the arm from being enabled is a drive that does not leave its fault, or else one that does not do as it is told.
  for (const bool in_fault : {true, false}) {
    for (std::size_t i = 0; i < tick.network.drive_count() && tick.step == Step::enable; ++i) {
      const canopen::Axis& axis = tick.network.axis(i);
      const bool asked = axis.requested() == canopen::AxisRequest::hold_enabled;
      if (in_fault ? !axis.drive_in_fault() : !asked || axis.enabled()) continue;
      tick.faults.report({Fault::drive_fault, static_cast<std::int32_t>(i), tick.network.fault(i).emcy_code});
      return;
    }
  }
  tick.faults.report(Fault::step_timeout);
}

}  // namespace lf::mission
