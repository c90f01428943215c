// The CiA 401 output node in operation: laser, lamps and camera trigger out, emergency stop and interlock in.
//
// What is asked for in one cycle acts at the next SYNC and is reported one SYNC later. A changed trigger counter is one exposure, so the counter
// starts from the one the node reports and the node never sees a change that nobody asked for.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/setup.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

class IoModule {
 public:
  static constexpr std::uint8_t rpdo_length = can_map::io_rpdo1::length;
  static constexpr std::uint8_t tpdo_length = can_map::io_tpdo1::length;

  struct Stats {
    std::uint32_t triggers = 0;          // asked for
    std::uint32_t triggers_refused = 0;  // second one in a cycle, exposure out of range, or node not heard
    std::uint32_t laser_inhibited = 0;   // cycles in which the laser was asked for but the interlock or a stale node kept it off
  };

  IoModule() = default;
  explicit IoModule(const NetworkConfig& config) : sync_period_(config.sync_period) {}

  // The core's side. Outputs are bits of can_map; what a set_outputs leaves out goes off.
  // The laser also needs the interlock closed and the node fresh; once inhibited, it stays off until it was asked off and on again.
  void set_outputs(std::uint8_t outputs);
  std::uint8_t wanted_outputs() const { return wanted_outputs_; }
  bool laser_inhibited() const { return laser_inhibited_; }
  // One exposure, 1..65535 us, at the next SYNC. False, and counted, when it cannot be.
  bool trigger_camera(Duration exposure);
  std::uint8_t trigger_counter() const { return trigger_counter_; }  // that of the last exposure asked for

  std::uint8_t outputs() const { return outputs_; }  // as the node reports them
  std::uint8_t inputs() const { return inputs_; }
  bool estop_closed() const { return (inputs_ & can_map::input_estop_closed) != 0; }          // false until heard
  bool interlock_closed() const { return (inputs_ & can_map::input_interlock_closed) != 0; }  // false until heard
  std::uint8_t last_trigger_counter() const { return last_trigger_counter_; }                 // as reported
  Duration last_exposure() const { return last_exposure_; }
  Time actual_time() const { return actual_time_; }  // of the SYNC the reported values belong to
  bool seen() const { return seen_; }
  bool fresh(Time now) const;  // reported values not older than three SYNC cycles
  // The outputs through the whole of [from, to], if they did not switch in it, reports have reached `to`, and the memory of the last 16 switches
  // reaches back to `from`; nothing otherwise. A frame exposed over a switch is thus told from a clean one.
  std::optional<std::uint8_t> outputs_during(Time from, Time to) const;
  const Stats& stats() const { return stats_; }

  // The network's side.
  void go_online() { online_ = true; }
  void go_offline();
  void on_tpdo(const CanFrame& frame, Time sync);  // `frame` has the right identifier and length
  void step(Time now);                             // once a SYNC
  bool make_rpdo(CanFrame& frame, std::uint8_t node) const;

 private:
  struct Steady {  // one stretch of unchanged outputs, from its first report to its last
    std::uint8_t outputs = 0;
    Time from, to;
  };
  static constexpr std::size_t history =
      16;  // 16 switches are 0.32 s of laser-on/laser-off at 25 Hz with settling; images are back within 0.2 s

  Duration sync_period_;
  bool online_ = false;
  bool seen_ = false;
  std::uint8_t wanted_outputs_ = 0;
  std::uint8_t sent_outputs_ = 0;
  bool laser_inhibited_ = false;
  bool trigger_pending_ = false;
  std::uint8_t trigger_counter_ = 0;
  std::uint16_t exposure_us_ = 0;
  std::uint8_t outputs_ = 0;
  std::uint8_t inputs_ = 0;
  std::uint8_t last_trigger_counter_ = 0;
  Duration last_exposure_;
  Time actual_time_;
  std::array<Steady, history> steady_{};
  std::size_t steady_count_ = 0;  // ever seen; the newest is at (count - 1) % history
  Stats stats_;
};

}  // namespace lf::canopen
