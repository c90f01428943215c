// What stop tests read from the bus and the drives, beside the core's own account: when the quick stop was sent, and which drive has power.
#pragma once

#include <array>
#include <optional>

#include "firmware/canopen/cia402.hpp"
#include "firmware/canopen/codec.hpp"
#include "host_sim/devices/devices.hpp"
#include "shared/can/can_map.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {

class BusWatch {
 public:
  void on_frame(const devices::BusRecord& record) {
    const CanFrame& frame = record.frame;
    const bool from_master = record.sender == can_map::master_node;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const std::uint8_t node = can_map::drive_nodes[i];
      if (from_master && frame.id == 0x200u + node) on_controlword(i, canopen::get<std::uint16_t>(frame, 0), record.delivered);
      if (!from_master && frame.id == 0x180u + node) statusword_[i] = canopen::get<std::uint16_t>(frame, 0);
    }
    if (!from_master && frame.id == 0x180u + can_map::io_node) {
      const bool closed = (canopen::get<std::uint8_t>(frame, can_map::io_tpdo1::inputs) & can_map::input_estop_closed) != 0;
      if (closed) last_closed_ = record.delivered;
      if (!closed && !first_open_) first_open_ = record.delivered;
    }
  }

  // Forgets what was sent before.
  void mark() {
    quick_stop_.fill(std::nullopt);
    first_open_.reset();
  }
  // The first time since the mark that every drive had been sent a quick stop, or a power off.
  std::optional<Time> all_stopped() const {
    std::optional<Time> latest;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      const std::optional<Time>& t = quick_stop_[i];
      if (!t) return std::nullopt;
      if (!latest || *t > *latest) latest = t;
    }
    return latest;
  }
  std::optional<Time> first_open() const { return first_open_; }  // report of an open chain since the mark
  Time last_closed() const { return last_closed_; }               // report of a closed chain

  // From the drive's side: its gear is released, or its last statusword is that of a state without current.
  bool powered(std::size_t joint, const devices::Devices& devices) const {
    if (devices.drives()[joint].released) return false;
    if (!statusword_[joint]) return false;
    switch (canopen::decode_statusword(*statusword_[joint])) {
      case canopen::DriveState::operation_enabled:
      case canopen::DriveState::quick_stop_active:
      case canopen::DriveState::fault_reaction: return true;
      default: return false;
    }
  }
  bool any_power(const devices::Devices& devices) const {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      if (powered(i, devices)) return true;
    }
    return false;
  }

 private:
  void on_controlword(std::size_t joint, std::uint16_t word, Time t) {
    const bool stops = (word & 0x86) == 0x02 || (word & 0x82) == 0x00;  // quick stop, or disable voltage
    if (!stops) {
      quick_stop_[joint].reset();
    } else if (!quick_stop_[joint]) {
      quick_stop_[joint] = t;
    }
  }

  PerJoint<std::optional<Time>> quick_stop_{};
  PerJoint<std::optional<std::uint16_t>> statusword_{};
  std::optional<Time> first_open_;
  Time last_closed_;
};

}  // namespace lf::test
