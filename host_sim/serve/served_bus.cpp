#include "host_sim/serve/served_bus.hpp"

#include <algorithm>

#include "firmware/canopen/cob_id.hpp"
#include "host_sim/devices/bus/can_bits.hpp"

namespace lf::serve {

namespace {

constexpr int most_frames = 128;  // of a millisecond: a full bus at 1 Mbit/s has 21 of the shortest
constexpr std::size_t nobody = capacity::nodes;

}  // namespace

bool ServedBus::receive(const Pace& pace) {
  hal::ReceivedFrame received;
  for (int i = 0; i < most_frames; ++i) {
    const hal::PortStatus status = link_.receive(received);
    if (status == hal::port_empty) break;
    link_error_ = status;
    if (status != hal::port_ok) return false;
    if ((received.frame.id & CanFrame::error_flag) != 0) {
      ++stats_.error_frames;
      continue;
    }
    ++stats_.received;
    count(received.frame);
    if (tap_) tap_(received.t, received.frame);
    if (dropped(received.frame.id)) continue;
    const Time t = pace.simulated_at(received.t);
    real_drives_.hear(received.frame, t);
    real_outputs_.hear(received.frame, t);
    dispatch(received.frame, nobody, t);
    flush(t);
    if (received.frame.id == canopen::cob_id::sync && stats_.answer_us.size() < most_answers) {
      stats_.answer_us.push_back(1e6 * (link_.now() - received.t).s());
    }
  }
  return true;
}

void ServedBus::dispatch(const CanFrame& frame, std::size_t sender, Time t) {
  for (std::size_t slot = 0; slot < rack_.slots(); ++slot) {
    if (slot == sender || !served_.has(slot) || off_bus_[slot] > 0) continue;
    rack_.receive(slot, frame, t);
    collect(slot);
  }
}

void ServedBus::collect(std::size_t slot) {
  for (const CanFrame& frame : rack_.take_outbox(slot)) {
    if (served_.has(slot) && off_bus_[slot] == 0) outgoing_.push_back(frame);
  }
}

// Served nodes hear each other, too; their frames do not come back from the kernel.
void ServedBus::flush(Time t) {
  while (!outgoing_.empty()) {
    std::vector<CanFrame> frames;
    std::swap(frames, outgoing_);
    std::erase_if(frames, [this](const CanFrame& frame) { return dropped(frame.id); });
    if (frames.empty()) continue;
    const hal::PortStatus status = link_.send(frames);
    if (status == hal::port_ok) {
      stats_.sent += frames.size();
    } else {
      ++stats_.send_failures;
      link_error_ = status;
    }
    const Time sent = link_.now();
    for (const CanFrame& frame : frames) {
      count(frame);
      if (tap_) tap_(sent, frame);
      dispatch(frame, rack_.slot_of(canopen::cob_id::node_of(frame.id)), t);
    }
  }
}

void ServedBus::step(Time t, const JointReadings& readings) {
  if (!powered_) {
    powered_ = true;
    rack_.power_on(t, readings);
  }
  rack_.tick(t, readings, [&](const devices::DeviceFault& fault, bool on) { set_fault(fault, on, t); });
  for (std::size_t slot = 0; slot < rack_.slots(); ++slot) collect(slot);
  flush(t);
}

void ServedBus::set_fault(const devices::DeviceFault& fault, bool on, Time t) {
  if (fault.kind == devices::DeviceFaultKind::drop_frames) {
    if (on) {
      dropped_ids_.push_back(fault.can_id);
    } else {
      std::erase(dropped_ids_, fault.can_id);
    }
  }
  const std::size_t slot = rack_.slot_of(fault.node);
  if (fault.kind != devices::DeviceFaultKind::bus_off || slot == rack_.slots()) return;
  off_bus_[slot] += on ? 1 : -1;
  on ? rack_.node(slot).bus_off(t) : rack_.node(slot).bus_recovered(t);
}

JointDrives ServedBus::drives(const JointReadings& readings) const {
  JointDrives drives = rack_.drives();
  for (std::size_t i = 0; i < rack_.io_slot(); ++i) {
    if (!served_.has(i)) drives[i] = real_drives_.follow(i, readings[i].motor_position_rad);
  }
  return drives;
}

Outputs ServedBus::outputs() const {
  if (served_.has(rack_.io_slot())) return {rack_.laser_on(), rack_.lamps_on()};
  return {real_outputs_.laser_on(), real_outputs_.lamps_on()};
}

std::optional<devices::Exposure> ServedBus::take_exposure() {
  return served_.has(rack_.io_slot()) ? rack_.take_exposure() : real_outputs_.take_exposure();
}

void ServedBus::count(const CanFrame& frame) { stats_.bits += devices::frame_bits(frame) + devices::interframe_bits; }

bool ServedBus::dropped(std::uint32_t id) const { return std::find(dropped_ids_.begin(), dropped_ids_.end(), id) != dropped_ids_.end(); }

}  // namespace lf::serve
