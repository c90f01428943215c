#include "firmware/canopen/axis.hpp"

#include <algorithm>
#include <cstdint>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

namespace {

constexpr std::uint16_t mode_object = 0x6060;
constexpr std::uint16_t mode_display_object = 0x6061;
constexpr int least_following_timeout_ms = 40;    // some drives take only 0: ten SYNCs, as long as a target may lie ahead for
constexpr int latest_following_timeout_ms = 200;  // whatever the drive is told: a slew at 0.3 rad/s goes 0.06 rad meanwhile
constexpr std::uint16_t word_of(Command command) { return static_cast<std::uint16_t>(command); }

constexpr std::int64_t ns_per_s = 1'000'000'000;  // steps are budgeted in thousand-millionths of a count

std::int16_t clamped(std::int64_t value) { return static_cast<std::int16_t>(std::clamp<std::int64_t>(value, INT16_MIN, INT16_MAX)); }

bool in_fault(DriveState state) { return state == DriveState::fault || state == DriveState::fault_reaction; }

bool reached(DriveState state, DriveGoal goal) {
  switch (goal) {
    case DriveGoal::disabled: return state == DriveState::switch_on_disabled;
    case DriveGoal::enabled:
    case DriveGoal::resumed: return state == DriveState::operation_enabled;
    case DriveGoal::quick_stop: return state == DriveState::quick_stop_active || state == DriveState::switch_on_disabled || in_fault(state);
    case DriveGoal::fault_reset: return !in_fault(state);
  }
  return false;
}

}  // namespace

const char* name(AxisState state) {
  switch (state) {
    case AxisState::offline: return "offline";
    case AxisState::disabled: return "disabled";
    case AxisState::enabling: return "enabling";
    case AxisState::enabled: return "enabled";
    case AxisState::homing: return "homing";
    case AxisState::stopping: return "stopping";
    case AxisState::stopped: return "stopped";
    case AxisState::fault: return "fault";
    case AxisState::resetting: return "resetting";
  }
  return "unknown";
}

const char* name(AxisFault fault) {
  switch (fault) {
    case AxisFault::none: return "none";
    case AxisFault::drive_fault: return "drive reports a fault";
    case AxisFault::following_error: return "following error";
    case AxisFault::stale: return "no process data for three cycles";
    case AxisFault::dropped_out: return "drive left operation by itself";
    case AxisFault::transition_timeout: return "commanded state not reached";
    case AxisFault::mode_refused: return "mode of operation not accepted";
    case AxisFault::homing_error: return "homing error";
    case AxisFault::homing_timeout: return "homing took too long";
    case AxisFault::reset_refused: return "fault not cleared by reset";
    case AxisFault::node_lost: return "node lost";
  }
  return "unknown";
}

Axis::Axis(const DriveSetup& setup, const NetworkConfig& config)
    : setup_(&setup),
      quick_stop_option_(setup.quick_stop_option),
      sync_period_(config.sync_period),
      transition_timeout_(config.transition_timeout + setup.profile.brake_opens + setup.profile.brake_closes),
      limits_{setup.max_speed_counts_s, setup.following_window_counts} {}

void Axis::request(AxisRequest request) {
  if (!online_) return;
  const bool leads_to_power = request == AxisRequest::hold_enabled || request == AxisRequest::home;
  if (leads_to_power && !may_have_power()) {
    ++stats_.power_refused;
    return;
  }
  if (request == AxisRequest::reset_fault && request_ != request) reset_edges_sent_ = 0;
  request_ = request;
}

bool Axis::set_target_counts(std::int32_t counts) {
  const std::int32_t low = std::min(setup_->min_counts, target_counts_), high = std::max(setup_->max_counts, target_counts_);
  if (!enabled() || counts < low || counts > high) {
    ++stats_.targets_refused;
    return false;
  }
  wanted_counts_ = counts;
  return true;
}

void Axis::set_limits_here(const AxisLimits& limits) {
  limits_.max_speed_counts_s = std::min(limits.max_speed_counts_s, setup_->max_speed_counts_s);
  limits_.following_window_counts = std::min(limits.following_window_counts, setup_->following_window_counts);
}

void Axis::set_torque_offset_permille(std::int16_t permille) {
  const auto limit = static_cast<std::int16_t>(std::min<std::uint16_t>(setup_->max_torque_of(rated_torque_unm_), 0x7FFF));
  torque_offset_permille_ = enabled() ? std::clamp(permille, static_cast<std::int16_t>(-limit), limit) : std::int16_t{0};
}

AxisState Axis::state() const {
  if (!online_ || !seen_) return AxisState::offline;
  if (request_ == AxisRequest::reset_fault) return AxisState::resetting;
  if (fault_ != AxisFault::none) return AxisState::fault;
  const DriveState drive = drive_state();
  switch (request_) {
    case AxisRequest::home: return AxisState::homing;
    case AxisRequest::hold_enabled:
      return mode_settled() && may_move() && drive == DriveState::operation_enabled && controlword_ == word_of(Command::enable_operation)
                 ? AxisState::enabled
                 : AxisState::enabling;
    case AxisRequest::quick_stop: return reached(drive, DriveGoal::quick_stop) ? AxisState::stopped : AxisState::stopping;
    default: return reached(drive, DriveGoal::disabled) || drive == DriveState::not_ready ? AxisState::disabled : AxisState::stopping;
  }
}

bool Axis::powered() const {
  switch (drive_state()) {
    case DriveState::not_ready:
    case DriveState::switch_on_disabled:
    case DriveState::ready_to_switch_on:
    case DriveState::switched_on:
    case DriveState::fault: return false;
    default: return true;
  }
}

// Half a period more than three, for the loop's jitter.
bool Axis::fresh(Time now) const { return seen_ && now - actual_time_ <= sync_period_ * 7 / 2; }

bool Axis::following_error() const {
  return mode_ == OperationMode::cyclic_position && drive_state() == DriveState::operation_enabled && (statusword_ & status_bit13) != 0;
}

bool Axis::drive_follows() const {
  return mode_ == OperationMode::cyclic_position && drive_state() == DriveState::operation_enabled && (statusword_ & status_bit12) != 0;
}

void Axis::forget_state() {
  request_ = AxisRequest::disable;
  fault_ = AxisFault::none;
  seen_ = false;
  was_enabled_ = false;
  brake_open_ = false;
  statusword_ = 0;
  controlword_ = 0;
  torque_offset_permille_ = 0;
  syncs_since_change_ = 0;
  reset_edges_sent_ = 0;
  last_state_ = DriveState::unknown;
  mode_ = OperationMode::cyclic_position;
  mode_step_ = ModeStep::settled;
  homing_ = HomingPhase::idle;
}

void Axis::go_online(const NodeBoot& boot, Time now) {
  forget_state();
  online_ = true;
  rated_torque_unm_ = boot.rated_torque_unm;
  quick_stop_option_ = boot.quick_stop_option;
  waiting_since_ = now;
  if (setup_->homing_method == 0) homed_ = setup_->zero_known && !zero_lost_;
}

void Axis::go_offline() {
  forget_state();
  online_ = false;
}

void Axis::lose_node() {
  if (online_) latch(AxisFault::node_lost);
}

void Axis::forget_home() { homed_ = setup_->homing_method == 0 && setup_->zero_known && !zero_lost_; }

void Axis::on_emcy(std::uint16_t code) {
  if (!setup_->profile.loses_position(code)) return;
  lose_zero();
  if (online_ && seen_) latch(AxisFault::drive_fault);
}

void Axis::lose_zero() {
  zero_lost_ = true;
  homed_ = false;
  ++stats_.zeros_lost;
}

void Axis::on_tpdo(const CanFrame& frame, Time sync) {
  statusword_ = get<std::uint16_t>(frame, can_map::drive_tpdo1::statusword);
  const DriveScale& scale = setup_->profile.scale;
  const std::int64_t counts = scale.counts(get<std::int32_t>(frame, can_map::drive_tpdo1::position));
  actual_counts_ = static_cast<std::int32_t>(counts - setup_->encoder_zero_counts);
  torque_permille_ = clamped(scale.torque.over(scale.sign * get<std::int16_t>(frame, can_map::drive_tpdo1::torque)));
  actual_time_ = sync;
  if (!seen_) target_counts_ = wanted_counts_ = actual_counts_;
  seen_ = true;
  if (drive_state() == DriveState::unknown) ++stats_.unknown_states;
}

void Axis::step(Time now, SdoClient& sdo) {
  if (syncs_since_change_ < 0xFF) ++syncs_since_change_;
  if (!online_ || !seen_) return;
  watch_brake(now);
  supervise(now);
  step_homing(now);
  step_mode(now, sdo);
  choose_command(now);
  step_target();
  was_enabled_ = powered_and_commanded();
}

bool Axis::powered_and_commanded() const {
  const bool commanded = (controlword_ & 0x8Fu) == word_of(Command::enable_operation);
  return commanded && drive_state() == DriveState::operation_enabled;
}

void Axis::latch(AxisFault fault) {
  if (fault_ != AxisFault::none) return;
  fault_ = fault;
  homing_ = HomingPhase::idle;
}

void Axis::supervise(Time now) {
  if (!fresh(now)) return latch(AxisFault::stale);
  if (request_ == AxisRequest::reset_fault) return;
  const DriveState drive = drive_state();
  if (in_fault(drive)) return latch(AxisFault::drive_fault);
  // The controlword said "enable operation" until now, so this was not our doing.
  if (was_enabled_ && drive != DriveState::operation_enabled) return latch(AxisFault::dropped_out);
  if (mode_step_ == ModeStep::settled && (following_error() || follows_badly(now))) latch(AxisFault::following_error);
}

// A target that moves before the brake is open is a following error, or a brake worn down.
void Axis::watch_brake(Time now) {
  if (drive_state() != DriveState::operation_enabled) {
    brake_open_ = false;
    operating_since_ = now;
    return;
  }
  const DriveProfile& profile = setup_->profile;
  if (now - operating_since_ < profile.brake_opens) return;
  if (!profile.waits_to_follow || drive_follows() || mode_ != OperationMode::cyclic_position) brake_open_ = true;
}

// For drives that do not time it themselves; a drive that does gets twice its time, and then its own watch is taken to have failed.
bool Axis::follows_badly(Time now) {
  const std::int64_t apart = following_counts() < 0 ? -following_counts() : following_counts();
  const bool follows = enabled() && mode_ == OperationMode::cyclic_position;
  if (!follows || apart <= limits_.following_window_counts) in_step_since_ = now;
  const Duration timeout = Duration::from_ms(std::max<int>(setup_->following_timeout_ms, least_following_timeout_ms));
  const Duration late = std::min(timeout * 2, Duration::from_ms(latest_following_timeout_ms));
  return now - in_step_since_ > (setup_->profile.master_times_following ? timeout : late);
}

DriveGoal Axis::goal() const {
  if (request_ == AxisRequest::reset_fault) return DriveGoal::fault_reset;
  if (request_ == AxisRequest::disable || request_ == AxisRequest::remove_power) return DriveGoal::disabled;
  if (fault_ != AxisFault::none) return DriveGoal::quick_stop;
  switch (request_) {
    case AxisRequest::quick_stop: return DriveGoal::quick_stop;
    case AxisRequest::hold_enabled:
      if (!mode_settled()) return DriveGoal::disabled;
      return quick_stop_option_ >= 5 ? DriveGoal::resumed : DriveGoal::enabled;
    case AxisRequest::home: return homing_ == HomingPhase::enable || homing_ == HomingPhase::run ? DriveGoal::enabled : DriveGoal::disabled;
    default: return DriveGoal::disabled;
  }
}

void Axis::set_controlword(std::uint16_t word) {
  if (word == controlword_) return;
  controlword_ = word;
  syncs_since_change_ = 0;
}

void Axis::choose_command(Time now) {
  if (goal() == DriveGoal::fault_reset) return choose_reset_word(now);
  const DriveState drive = drive_state();
  if (drive != last_state_ || reached(drive, goal())) waiting_since_ = now;
  last_state_ = drive;
  if (now - waiting_since_ > transition_timeout_) latch(AxisFault::transition_timeout);

  // What a silent drive said last is no ground for a step down: it is told to go down at once.
  const bool at_once = request_ == AxisRequest::remove_power || (goal() == DriveGoal::disabled && !fresh(now));
  const Command command = at_once ? Command::disable_voltage : command_for(drive, goal());
  std::uint16_t word = word_of(command);
  const bool start_homing = homing_ == HomingPhase::run && drive == DriveState::operation_enabled;
  if (start_homing) word = static_cast<std::uint16_t>(word | control_homing_start);
  if (handshake_over() || at_once || command == Command::quick_stop) set_controlword(word);
}

// Bit 7 acts on its rising edge: low for a handshake, high until the fault is gone or it is time for the next edge.
void Axis::choose_reset_word(Time now) {
  const DriveState drive = drive_state();
  waiting_since_ = now;
  if (!in_fault(drive)) {
    fault_ = fresh(now) ? AxisFault::none : AxisFault::stale;
    request_ = AxisRequest::disable;
    return set_controlword(word_of(Command::disable_voltage));
  }
  const bool high = controlword_ == word_of(Command::fault_reset);
  if (high && syncs_since_change_ < reset_syncs) return;
  if (high && reset_edges_sent_ >= reset_edges) {
    fault_ = AxisFault::reset_refused;
    request_ = AxisRequest::disable;
    return set_controlword(word_of(Command::disable_voltage));
  }
  if (high) return set_controlword(word_of(Command::disable_voltage));
  // Until the edge may come, no word of before stays on the bus: it may be the one that enables.
  if (drive == DriveState::fault_reaction || !handshake_over()) return set_controlword(word_of(Command::disable_voltage));
  set_controlword(word_of(command_for(drive, DriveGoal::fault_reset)));
  ++reset_edges_sent_;
}

OperationMode Axis::wanted_mode() const {
  const bool homing = homing_ == HomingPhase::enter_mode || homing_ == HomingPhase::enable || homing_ == HomingPhase::run;
  return homing ? OperationMode::homing : OperationMode::cyclic_position;
}

// Changes the mode while the drive is without power, so that no target of one mode is ever taken for one of the other.
void Axis::step_mode(Time now, SdoClient& sdo) {
  if (mode_step_ == ModeStep::settled) {
    if (mode_ == wanted_mode() || fault_ != AxisFault::none || drive_state() != DriveState::switch_on_disabled) return;
    next_mode_ = wanted_mode();
    mode_since_ = now;
    mode_step_ = ModeStep::write;
  }
  if (sdo.busy()) return;
  if (mode_step_ == ModeStep::write) {
    if (sdo.download(mode_object, 0, static_cast<std::uint8_t>(next_mode_), 1)) mode_step_ = ModeStep::writing;
    return;
  }
  if (sdo.state() != SdoClient::State::done) {
    mode_step_ = ModeStep::settled;
    return latch(AxisFault::mode_refused);
  }
  start_mode_transfer(now, sdo);
}

// The transfer before is done: reads 6061 until it shows the mode that was written.
void Axis::start_mode_transfer(Time now, SdoClient& sdo) {
  const bool shown =
      mode_step_ == ModeStep::reading && static_cast<std::int8_t>(sdo.number() & 0xFFu) == static_cast<std::int8_t>(next_mode_);
  if (shown) {
    mode_ = next_mode_;
    mode_step_ = ModeStep::settled;
    return;
  }
  if (now - mode_since_ > transition_timeout_) {
    mode_step_ = ModeStep::settled;
    return latch(AxisFault::mode_refused);
  }
  if (sdo.upload(mode_display_object, 0)) mode_step_ = ModeStep::reading;
}

void Axis::step_homing(Time now) {
  if (request_ != AxisRequest::home || fault_ != AxisFault::none) {
    homing_ = HomingPhase::idle;
    return;
  }
  if (setup_->homing_method == 0) {
    request_ = AxisRequest::disable;
    return;
  }
  if (homing_ == HomingPhase::idle) {
    homing_ = HomingPhase::enter_mode;
    homing_since_ = now;
    homed_ = false;
  }
  if (now - homing_since_ > setup_->homing_timeout) return latch(AxisFault::homing_timeout);
  switch (homing_) {
    case HomingPhase::enter_mode:
      if (mode_settled()) homing_ = HomingPhase::enable;
      return;
    case HomingPhase::enable:
      if (powered_and_commanded() && handshake_over()) homing_ = HomingPhase::run;
      return;
    case HomingPhase::run: return watch_homing();
    case HomingPhase::leave_mode:
      if (!mode_settled()) return;
      homing_ = HomingPhase::idle;
      homed_ = true;
      zero_lost_ = false;
      request_ = AxisRequest::disable;
      return;
    case HomingPhase::idle: return;
  }
}

// Bits 10 and 12 may still tell of an earlier homing until the start bit was taken and answered.
void Axis::watch_homing() {
  const bool started = (controlword_ & control_homing_start) != 0 && handshake_over();
  if (!started) return;
  if ((statusword_ & status_bit13) != 0) return latch(AxisFault::homing_error);
  const bool attained = (statusword_ & status_bit12) != 0 && (statusword_ & status_target_reached) != 0;
  if (attained) homing_ = HomingPhase::leave_mode;
}

// Until the drive follows, the target is where it is: enabling never jumps. Then each cycle earns its share of the maximum speed to spend; one more count
// may be saved, because coarse encoders take several cycles a count.
void Axis::step_target() {
  if (!enabled()) {
    target_counts_ = wanted_counts_ = actual_counts_;
    step_budget_ = 0;
    torque_offset_permille_ = 0;
    return;
  }
  const std::int64_t income = static_cast<std::int64_t>(limits_.max_speed_counts_s) * sync_period_.ns();
  step_budget_ = std::min(step_budget_ + income, income + ns_per_s);
  const std::int64_t furthest = step_budget_ / ns_per_s;
  const std::int64_t wanted_step = static_cast<std::int64_t>(wanted_counts_) - target_counts_;
  const std::int64_t step = std::clamp(wanted_step, -furthest, furthest);
  if (step != wanted_step) ++stats_.targets_limited;
  step_budget_ -= (step < 0 ? -step : step) * ns_per_s;
  target_counts_ = static_cast<std::int32_t>(target_counts_ + step);
}

bool Axis::make_rpdo(CanFrame& frame) const {
  if (!online_ || !seen_) return false;
  const DriveProfile& profile = setup_->profile;
  const std::uint8_t length = profile.torque_offset ? can_map::drive_rpdo1::length : can_map::drive_rpdo1::torque_offset;
  frame = empty_frame(cob_id::rpdo1 + setup_->node, length);
  put(frame, can_map::drive_rpdo1::controlword, controlword_);
  const std::int64_t counts = std::int64_t{target_counts_} + setup_->encoder_zero_counts;
  put(frame, can_map::drive_rpdo1::target_position, profile.scale.drive_position(counts));
  if (profile.torque_offset) {
    put(frame, can_map::drive_rpdo1::torque_offset, clamped(profile.scale.torque.times(profile.scale.sign * torque_offset_permille_)));
  }
  return true;
}

}  // namespace lf::canopen
