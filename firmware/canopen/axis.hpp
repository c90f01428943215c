// One CiA 402 drive in operation: state machine, cyclic synchronous position, homing, and the watch over its answers.
//
// Synchronous RPDO data act at the next SYNC and are answered one SYNC later, so a statusword tells of a controlword three SYNCs after it was
// decided: every handshake waits that long. Positions are the arm's counts, torques thousandths of the rated torque; what goes to the drive and comes from it
// is in the units of its profile.
//
// A latched fault stops the drive (quick stop) and stays until `reset_fault` is requested; nothing restarts by itself. A latched fault never keeps the
// power on: `disable` and `remove_power` go before it.
#pragma once

#include <cstdint>

#include "firmware/canopen/boot_report.hpp"
#include "firmware/canopen/cia402.hpp"
#include "firmware/canopen/sdo_client.hpp"
#include "firmware/canopen/setup.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

enum class AxisRequest : std::uint8_t {
  disable,       // without power, on the way down through every state
  hold_enabled,  // powered in cyclic synchronous position: holds where it is, then follows `set_target_counts`
  quick_stop,    // stops on the quick-stop ramp and stays stopped
  reset_fault,   // clears a latched fault and resets the drive's with a rising edge; becomes `disable` when done
  remove_power,  // disable voltage, from every state, at once and as long as it is asked for, whatever the drive answers or not
  home,          // runs the homing of DriveSetup; becomes `disable` in cyclic mode when done, `homed()` tells
};

enum class AxisState : std::uint8_t {
  offline,    // not heard, or the node is not operational
  disabled,   // without power
  enabling,   // on the way to `enabled`, or between modes
  enabled,    // follows targets
  homing,     // the drive moves by itself
  stopping,   // on the way to `disabled` or `stopped`
  stopped,    // quick stop active
  fault,      // latched, see `fault()`
  resetting,  // `reset_fault` at work
};
const char* name(AxisState state);

enum class AxisFault : std::uint8_t {
  none,
  drive_fault,         // the drive is in its fault state (following error, over-temperature, lost heartbeat...): its EMCY has the code
  following_error,     // bit 13 while following, before the drive itself faults
  stale,               // no TPDO for three SYNC cycles
  dropped_out,         // left operation enabled without being told to (power or safe-torque-off)
  transition_timeout,  // a commanded state was not reached
  mode_refused,        // 6060 was not accepted or 6061 did not follow
  homing_error,        // bit 13 in homing mode
  homing_timeout,
  reset_refused,  // three rising edges did not clear the fault
  node_lost,      // heartbeat lost, rebooted, or no longer operational
};
const char* name(AxisFault fault);

// What a joint may do at the pose where it is. A screw has fewer counts a radian at its stroke's ends than within it, so the caller works these out again for
// each pose.
struct AxisLimits {
  std::uint32_t max_speed_counts_s = 0;       // of the target's steps
  std::uint32_t following_window_counts = 0;  // how far the joint may be off its target
};

class Axis {
 public:
  // Three SYNC cycles: a command acts one SYNC after it is sent and is answered one later.
  static constexpr std::uint8_t handshake_syncs = 3;
  // A drive may take tens of milliseconds to leave its fault state: each rising edge is given 25 SYNCs, 100 ms, and there are three.
  static constexpr std::uint8_t reset_syncs = 25;
  static constexpr std::uint8_t reset_edges = 3;

  struct Stats {
    std::uint32_t power_refused = 0;    // requests for power without a known zero
    std::uint32_t targets_refused = 0;  // outside the position limits, or while not enabled
    std::uint32_t targets_limited = 0;  // cycles in which the target ran ahead of the maximum speed and was held back
    std::uint32_t unknown_states = 0;   // statuswords with a pattern the standard does not have
    std::uint32_t zeros_lost = 0;
  };

  Axis() = default;
  // `setup` is known by its place.
  Axis(const DriveSetup& setup, const NetworkConfig& config);

  // The same set-up, elsewhere.
  void find_setup(const DriveSetup& setup) { setup_ = &setup; }

  // The core's side. Asking once is enough; `reset_fault` and `home` asked again after they ended start again. Ignored while offline. What leads to power
  // is refused, and counted, for a joint without a known zero.
  void request(AxisRequest request);
  AxisRequest requested() const { return request_; }
  // Next target, in effect while `enabled()`. False, and counted, when outside the limits or not enabled: the last target stays. An axis that was enabled
  // outside its limits may stay there or come closer to them.
  bool set_target_counts(std::int32_t counts);
  // In effect from the next `step` until they are set again. The set-up's numbers hold at every pose: what is larger than these has no effect.
  void set_limits_here(const AxisLimits& limits);
  const AxisLimits& limits_here() const { return limits_; }
  // Torque feed-forward (60B2), limited to the maximum torque; 0 unless set, and 0 again whenever the axis is not enabled.
  void set_torque_offset_permille(std::int16_t permille);

  AxisState state() const;
  bool enabled() const { return state() == AxisState::enabled; }
  // The last statusword tells of current in the motor, or tells nothing that is known.
  bool powered() const;
  bool drive_in_fault() const { return drive_state() == DriveState::fault; }    // what the drive says, whatever was made of it
  bool runs() const { return drive_state() == DriveState::operation_enabled; }  // not told to stop, or has not heard it
  // The drive says, and no longer ago than three SYNC cycles, that there is no current in the motor.
  bool confirmed_unpowered(Time now) const { return fresh(now) && !powered(); }
  bool homed() const { return homed_; }  // true from boot for absolute encoders
  // The drive has said that its position is lost. Outlives faults, resets and boots: it ends with a homing, or with the axis.
  bool zero_lost() const { return zero_lost_; }
  void lose_zero();  // told by somebody else who has heard its drive
  bool may_have_power() const { return setup_->may_have_power() && !(zero_lost_ && setup_->homing_method == 0); }
  AxisFault fault() const { return fault_; }
  // The latest values, those of the SYNC at `actual_time()`.
  std::int32_t actual_counts() const { return actual_counts_; }
  std::int16_t torque_permille() const { return torque_permille_; }
  Time actual_time() const { return actual_time_; }
  bool seen() const { return seen_; }
  // Values not older than three SYNC cycles. What is not fresh must not be acted on.
  bool fresh(Time now) const;
  std::int32_t target_counts() const { return target_counts_; }  // as sent, after limiting
  std::int64_t following_counts() const { return static_cast<std::int64_t>(target_counts_) - actual_counts_; }
  bool following_error() const;  // bit 13 in cyclic mode
  bool drive_follows() const;    // bit 12 in cyclic mode; drives clear it when an internal limit is active
  std::uint16_t statusword() const { return statusword_; }
  std::uint16_t controlword() const { return controlword_; }
  DriveState drive_state() const { return decode_statusword(statusword_); }
  // The motor's rated torque in micro newton metres, found at boot: 6076 in its unit, or what the machine's file states.
  std::uint32_t rated_torque_unm() const { return rated_torque_unm_; }
  const DriveSetup& setup() const { return *setup_; }
  // 605A, as the drive took it.
  std::int16_t quick_stop_option() const { return quick_stop_option_; }
  const Stats& stats() const { return stats_; }

  // The network's side.
  void go_online(const NodeBoot& boot, Time now);  // configured, in cyclic mode, and started
  void go_offline();                               // being booted
  void lose_node();                                // latches node_lost
  void forget_home();                              // the node lost its memory
  void on_emcy(std::uint16_t code);                // a lost position stops the drive, and its zero is not known any more
  void on_tpdo(const CanFrame& frame, Time sync);  // `frame` has the right identifier and length
  void step(Time now, SdoClient& sdo);             // once a SYNC
  // False before the first TPDO: a target that was never seeded is never sent.
  bool make_rpdo(CanFrame& frame) const;

 private:
  enum class HomingPhase : std::uint8_t { idle, enter_mode, enable, run, leave_mode };
  enum class ModeStep : std::uint8_t { settled, write, writing, reading };

  void forget_state();
  void supervise(Time now);
  void watch_brake(Time now);
  bool may_move() const { return brake_open_ || (setup_->profile.brake_opens == Duration{} && !setup_->profile.waits_to_follow); }
  bool follows_badly(Time now);
  void latch(AxisFault fault);
  DriveGoal goal() const;
  void choose_command(Time now);
  void choose_reset_word(Time now);
  void set_controlword(std::uint16_t word);
  bool powered_and_commanded() const;
  void step_mode(Time now, SdoClient& sdo);
  void start_mode_transfer(Time now, SdoClient& sdo);
  OperationMode wanted_mode() const;
  bool mode_settled() const { return mode_step_ == ModeStep::settled && mode_ == wanted_mode(); }
  void step_homing(Time now);
  void watch_homing();
  void step_target();
  bool handshake_over() const { return syncs_since_change_ >= handshake_syncs; }

  const DriveSetup* setup_ = nullptr;
  std::int16_t quick_stop_option_ = 0;
  Duration sync_period_;
  Duration transition_timeout_;
  AxisLimits limits_;
  std::int64_t step_budget_ = 0;  // 1e-9 counts
  AxisRequest request_ = AxisRequest::disable;
  AxisFault fault_ = AxisFault::none;
  bool online_ = false;
  bool seen_ = false;
  bool homed_ = false;
  bool zero_lost_ = false;
  bool was_enabled_ = false;
  bool brake_open_ = false;  // and the drive follows: targets may move
  Time operating_since_;
  Time in_step_since_;  // within the following-error window
  // From the drive.
  std::uint16_t statusword_ = 0;
  std::int32_t actual_counts_ = 0;
  std::int16_t torque_permille_ = 0;
  Time actual_time_;
  std::uint32_t rated_torque_unm_ = 0;
  // To the drive.
  std::uint16_t controlword_ = 0;
  std::int32_t target_counts_ = 0;
  std::int32_t wanted_counts_ = 0;
  std::int16_t torque_offset_permille_ = 0;
  // Handshakes.
  std::uint8_t syncs_since_change_ = 0;
  std::uint8_t reset_edges_sent_ = 0;
  Time waiting_since_;  // for the drive's state to change
  DriveState last_state_ = DriveState::unknown;
  OperationMode mode_ = OperationMode::cyclic_position;
  OperationMode next_mode_ = OperationMode::cyclic_position;
  ModeStep mode_step_ = ModeStep::settled;
  Time mode_since_;
  HomingPhase homing_ = HomingPhase::idle;
  Time homing_since_;
  Stats stats_;
};

}  // namespace lf::canopen
