#include "host_sim/devices/drive/drive402.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/devices/drive/drive_dictionary.hpp"

namespace lf::devices {
namespace {

constexpr double step_s = 1e-3;
constexpr double still_of_stiction = 0.02;  // what the filter leaves of a feed-forward that has ended
constexpr double torque_filter_s = 0.002;
constexpr double velocity_filter_s = 0.008;
constexpr double ramp_filter_s = 0.016;      // the position loop's of its feed-forward: a count an 8 ms is a speed to it, too
constexpr double jump_of_top = 0.5;          // a joint that follows is not so much slower than its set-point; four SYNCs' filter are in it
constexpr double fastest_of_top = 2;         // a joint that has run off turns at 1.5 times the top speed
constexpr double torque_high_of_peak = 1.2;  // beyond what the drive can apply: a broken current sensor

constexpr std::uint16_t bit_fault_reset = 0x80, bit_4 = 0x10;

PositionLoop::Config loop_config(const DriveConfig& config) {
  PositionLoop::Config loop;
  loop.still_rad_s = still_of_stiction * config.stiction_rad_s;
  loop.max_velocity_rad_s = config.max_velocity_rad_s;
  loop.max_acceleration_rad_s2 = config.max_acceleration_rad_s2;
  return loop;
}

std::vector<Object> node_objects_of(const DriveConfig& config) {
  std::vector<Object> objects = config.habit != nullptr ? strict_objects(config, drive_objects(config)) : drive_objects(config);
  for (Object& object : objects) {
    if (object.index != 0x1018) continue;
    if (object.sub == 1 && config.vendor != 0) object.value = config.vendor;
    if (object.sub == 2 && config.product != 0) object.value = config.product;
  }
  return objects;
}

std::optional<ObjectDictionary> native_objects_of(const DriveConfig& config) {
  if (config.habit == nullptr && !config.reversed) return std::nullopt;
  std::vector<Object> objects = drive_objects(config);
  if (config.habit == nullptr) return ObjectDictionary(std::move(objects));
  // A drive without 6072 has its maker's own limit, which is set to the rated torque when it is commissioned.
  const bool limited =
      std::any_of(config.dictionary->begin(), config.dictionary->end(), [](const DictionaryRow& row) { return row.index == 0x6072; });
  for (Object& object : objects) {
    if (!limited && object.index == 0x6072) object.value = std::min<std::int64_t>(object.value, 1000);
  }
  return ObjectDictionary(std::move(objects));
}

}  // namespace

Drive402::Drive402(const DriveConfig& config, Duration boot_time, std::uint64_t seed)
    : config_(config),
      actuator_(config.actuator),
      node_(config.node, node_objects_of(config), boot_time, *this),
      native_(native_objects_of(config)),
      o_(native_ ? *native_ : node_.objects()),
      noise_(seed ^ (std::uint64_t{config.node} << 56)),
      loop_(loop_config(config)),
      gear_(config.friction),
      winding_(config.water_celsius, config.rise_at_rated_celsius) {
  if (native_) units_.emplace(config, *native_, node_.objects());
  node_.set_inhibits_synchronous(config.switches.inhibits_synchronous);
  node_.set_ignores_deadlines(config.switches.ignores_deadline);
}

void Drive402::power_on(Time now, const JointReading& reading) {
  motor_rad_ = reading.motor_position_rad;
  measure(reading);
  node_.power_on(now);
}

void Drive402::restarted(Time) {
  if (units_) units_->take_inputs();
  state_ = DriveState::switch_on_disabled;
  ramping_ = brake_ = limited_ = set_point_taken_ = false;
  mode_ = 0;
  last_controlword_ = 0;
  following_ms_ = on_target_ms_ = 0;
  homing_.abandon();
  zero_ = config_.absolute_encoder ? o_.home_offset.value : o_.home_offset.value - encoder_;
  o_.position_actual.value = encoder_ + zero_;
  last_counts_ = static_cast<double>(o_.position_actual.value);
  profile_.hold(last_counts_);
  velocity_counts_s_ = ramp_counts_s_ = 0;
  if (units_) units_->give_outputs();
}

JointDrive Drive402::tick(Time now, const JointReading& reading) {
  measure(reading);
  watch(now);
  change_mode();
  generate(now);
  finish_ramp();
  const JointDrive drive = actuate();
  publish();
  node_.tick(now);
  return drive;
}

void Drive402::measure(const JointReading& reading) {
  const double angle_rad = reading.motor_position_rad + config_.encoder_offset_rad;
  const double counts_per_rad = actuator_.counts_per_rad(reading.motor_position_rad);
  if (!faults_.stuck_encoder) encoder_ = std::llround(actuator_.counts(angle_rad)) + config_.encoder_zero_counts;
  if (std::abs(counts_per_rad) > 1) rad_per_count_ = 1 / counts_per_rad;
  o_.position_actual_internal.value = encoder_;
  o_.position_actual.value = encoder_ + zero_;
  const auto actual = static_cast<double>(o_.position_actual.value);
  velocity_counts_s_ += ((actual - last_counts_) / step_s - velocity_counts_s_) * (step_s / velocity_filter_s);
  // An encoder that jumps is no motion: nothing turns at many times the top speed.
  const double fastest = fastest_of_top * top_speed();
  ramp_counts_s_ += (std::clamp((actual - last_counts_) / step_s, -fastest, fastest) - ramp_counts_s_) * (step_s / ramp_filter_s);
  last_counts_ = actual;
  measure_torque(reading);
  winding_.step(torque_ratio_, step_s);
}

// Of the motor.
double Drive402::torque_limit_nm() const {
  return std::min(config_.peak_torque_nm, 1e-3 * static_cast<double>(o_.max_torque.value) * config_.rated_torque_nm);
}

double Drive402::ratio() const { return 2 * std::numbers::pi / (config_.counts_per_rev * std::abs(rad_per_count_)); }

double Drive402::asked_of_stiction() const {
  if (config_.stiction_rad_s > 0) return loop_.asked_rad_s() / config_.stiction_rad_s;
  return loop_.asked_rad_s() == 0 ? 0 : std::copysign(1.0, loop_.asked_rad_s());
}

// What the motor needs for what the joint was given. Without power there is no current to measure.
void Drive402::measure_torque(const JointReading& reading) {
  const double turned_rad = reading.motor_position_rad - motor_rad_;
  motor_rad_ = reading.motor_position_rad;
  const double noise = config_.torque_noise_ratio * noise_.next();
  if (!powered()) {
    gear_.reset();
    torque_ratio_ = jammed_nm_ = 0;
    return;
  }
  const double direction = rad_per_count_ < 0 ? -1 : 1;
  const double wound_nm = direction * asked_of_stiction() * config_.rated_torque_nm * step_s / winding_s;
  double motor_nm = gear_.step(direction * reading.torque_nm, direction * turned_rad * ratio() / step_s, ratio(), step_s, wound_nm);
  const double limit_nm = torque_limit_nm();
  // What has seized stands however much the controller winds up.
  jammed_nm_ = faults_.jammed ? std::clamp(jammed_nm_ + wound_nm, -limit_nm, limit_nm) : 0;
  if (faults_.jammed) motor_nm = jammed_nm_;
  const double high_nm = faults_.high_torque ? torque_high_of_peak * config_.peak_torque_nm : 0;
  torque_ratio_ += ((std::clamp(motor_nm, -limit_nm, limit_nm) + high_nm) / config_.rated_torque_nm + noise - torque_ratio_) *
                   (step_s / torque_filter_s);
}

// What this make takes beside what its dictionary says.
Abort Drive402::may_write_habit(const Object& object, std::int64_t value) const {
  const DriveHabit& habit = *config_.habit;
  const auto takes = [value](std::uint32_t values) { return value >= 0 && value < 32 && ((values >> value) & 1u) != 0; };
  switch (object.index) {
    case 0x605A:
      if (config_.switches.refuses_quick_stop_6 && value == 6) return Abort::bad_value;
      return takes(habit.quick_stop_values) ? Abort::none : Abort::bad_value;
    case 0x6007: return takes(habit.abort_values) ? Abort::none : Abort::bad_value;
    case 0x6060:
      if (value == mode_cyclic_position && !habit.cyclic_position) return Abort::bad_value;
      return value == 0 || value == mode_profile_position || value == mode_profile_velocity || value == mode_homing ||
                     value == mode_cyclic_position
                 ? Abort::none
                 : Abort::bad_value;
    case 0x60C2:
      if (state_ == DriveState::operation_enabled) return Abort::device_state;
      return object.sub == 2 && value != -3 ? Abort::bad_value : Abort::none;
    default: return Abort::none;
  }
}

Abort Drive402::may_write(const Object& object, std::int64_t value) {
  if (config_.habit != nullptr) return may_write_habit(object, value);
  switch (object.index) {
    case 0x605A: return value == 3 || value == 4 ? Abort::bad_value : Abort::none;
    case 0x6060: {
      const bool known = value == 0 || value == mode_profile_position || value == mode_profile_velocity || value == mode_homing ||
                         value == mode_cyclic_position;
      return known ? Abort::none : Abort::bad_value;
    }
    case 0x6098:
      if (homing_.state() == Homing::State::running) return Abort::device_state;
      return known_homing_method(value) ? Abort::none : Abort::bad_value;
    case 0x60C2:
    case 0x607C: return state_ == DriveState::operation_enabled ? Abort::device_state : Abort::none;
    default: return Abort::none;
  }
}

void Drive402::received(Time now) {
  last_target_ = now;
  if (units_) units_->take_inputs();
  on_controlword(now);
}

void Drive402::written(const Object& object, Time now) {
  if (units_) units_->take_inputs();
  if (object.index == 0x6040) on_controlword(now);
}

void Drive402::on_controlword(Time now) {
  const auto controlword = static_cast<std::uint16_t>(o_.controlword.value);
  const bool reset = (controlword & bit_fault_reset) != 0 && (last_controlword_ & bit_fault_reset) == 0;
  const bool start = (controlword & bit_4) != 0 && (last_controlword_ & bit_4) == 0;
  last_controlword_ = controlword;
  if (reset && state_ == DriveState::fault) {
    reset_fault(now);
    return;
  }
  const DriveState next = after(state_, command_of(controlword), o_.quick_stop_option.value);
  if (next != state_) {
    if (!powered()) enabled_at_ = now;
    enter(next);
  }
  if (state_ != DriveState::operation_enabled || !start) return;
  if (mode_ == mode_homing) {
    homed_ = false;
    homing_.start(o_.homing_method.value, static_cast<double>(o_.homing_speed.value),
                  static_cast<double>(o_.limit_high.value - o_.limit_low.value), static_cast<double>(o_.position_actual.value));
  }
  if (mode_ == mode_profile_position && !set_point_taken_) {
    set_point_ = o_.target_position.value + ((controlword & 0x40) != 0 ? set_point_ : 0);
    set_point_taken_ = true;
  }
}

// A fault whose cause is still there stays. 8130 stays until the master has reset the communication.
void Drive402::reset_fault(Time now) {
  const bool too_hot = faults_.hot || winding_.celsius() > config_.trip_celsius;
  if (faults_.overcurrent || too_hot || winding_.overloaded() || node_.active(emcy::heartbeat)) return;
  for (const std::uint16_t code : {emcy::overcurrent, emcy::hot, emcy::following, emcy::stopped_by_master, emcy::pdo_timeout,
                                   emcy::bus_off_recovered, emcy::software_limit}) {
    node_.clear(code, now);
  }
  o_.error_code.value = 0;
  brake_ = false;
  enter(DriveState::switch_on_disabled);
}

bool Drive402::powered() const {
  return ramping_ || state_ == DriveState::operation_enabled || state_ == DriveState::quick_stop_active ||
         state_ == DriveState::fault_reaction_active;
}

// Options 605B and 605C: 0 switches the power off at once, 1 slows down first.
bool Drive402::ramp_wanted(DriveState next) const {
  if (next == DriveState::ready_to_switch_on) return o_.shutdown_option.value == 1;
  if (next == DriveState::switched_on) return o_.disable_option.value == 1;
  return false;
}

// A set-point moves by whole counts from SYNC to SYNC: its speed is a count's or none. The ramp begins at what the loop's filter made of it, and where the
// demand is; but where the joint is, and as it moves, if that is off by more than the loop lags, or if the demand has just jumped: a stop makes up for no
// following error. No ramp is faster than the drive.
void Drive402::begin_ramp() {
  const double demand = profile_.position(), actual = static_cast<double>(o_.position_actual.value);
  const double velocity = loop_.demand_velocity_rad_s() / rad_per_count_;
  const bool jumped = std::abs(velocity - ramp_counts_s_) > jump_of_top * top_speed();
  const bool follows = !jumped && std::abs(demand - actual) <= loop_.lag_counts(velocity);
  if (follows || config_.switches.ramps_from_demand) return profile_.move(demand, velocity);
  const double top_counts_s = std::min(top_speed(), config_.max_velocity_rad_s / std::abs(rad_per_count_));
  const double from_counts_s = std::clamp(ramp_counts_s_, -top_counts_s, top_counts_s);
  profile_.move(actual, from_counts_s);
  loop_.take_up(from_counts_s * rad_per_count_);
}

void Drive402::enter(DriveState state) {
  const bool was_enabled = state_ == DriveState::operation_enabled;
  const bool was_powered = powered();
  if (was_enabled && mode_ == mode_cyclic_position) begin_ramp();
  ramping_ = was_enabled && ramp_wanted(state) && !profile_.standing();
  if (state == DriveState::quick_stop_active && o_.quick_stop_option.value == 0) state = DriveState::switch_on_disabled;
  state_ = state;
  if (state != DriveState::operation_enabled) {
    homing_.abandon();
    limited_ = false;
  }
  if (state == DriveState::operation_enabled) {
    if (!was_powered) {
      profile_.hold(static_cast<double>(o_.position_actual.value));
      loop_.reset();
    }
    cyclic_.hold(profile_.position());
    set_point_ = std::llround(profile_.position());
    set_point_taken_ = false;
    following_ms_ = 0;
    mode_ = o_.mode.value;
  }
}

void Drive402::fault(std::uint16_t code, std::int64_t option, Time now) {
  if (state_ == DriveState::fault_reaction_active || state_ == DriveState::fault) return;
  o_.error_code.value = code;
  reaction_option_ = option;
  const bool reaction = powered() && option != 0;
  brake_ = option != 0;
  ramping_ = false;
  enter(reaction ? DriveState::fault_reaction_active : DriveState::fault);
  node_.raise(code, now);
}

void Drive402::connection_lost(std::uint16_t code, Time now) {
  if (config_.switches.ignores_lost_master && code == emcy::heartbeat) return;
  const bool by_master = code == emcy::stopped_by_master;
  if (by_master && state_ != DriveState::operation_enabled) return;
  const bool faults = config_.habit != nullptr && config_.habit->lost_master_faults && !config_.switches.holds_without_master && !by_master;
  if (faults) return fault(code, o_.abort_option.value == 3 ? quick_stop_ramp : 0, now);
  switch (o_.abort_option.value) {
    case 1: return fault(code, o_.fault_option.value, now);
    case 2:
    case 3: {
      const Command command = o_.abort_option.value == 2 ? Command::disable_voltage : Command::quick_stop;
      const DriveState next = after(state_, command, o_.quick_stop_option.value);
      if (next != state_) enter(next);
      return;
    }
    default: return;
  }
}

void Drive402::watch(Time now) {
  const std::int64_t option = o_.fault_option.value;
  if (faults_.overcurrent || winding_.overloaded()) fault(emcy::overcurrent, option, now);
  if (faults_.hot || winding_.celsius() > config_.trip_celsius) fault(emcy::hot, option, now);
  if (config_.habit != nullptr && config_.habit->limits_fault && limited_) fault(emcy::software_limit, option, now);
  if (without_sync(now)) {
    node_.raise(emcy::pdo_timeout, now);
    connection_lost(emcy::pdo_timeout, now);
  }
  following_ms_ = follows_badly() ? following_ms_ + 1 : 0;
  if (following_ms_ > o_.following_time_ms.value) fault(emcy::following, option, now);
}

// An interpolating drive that gets no target for some of its periods, 60C2.
bool Drive402::without_sync(Time now) const {
  if (config_.habit == nullptr || state_ != DriveState::operation_enabled || mode_ != mode_cyclic_position) return false;
  const bool faults = config_.habit->sync_loss == SyncLoss::faults || config_.switches.faults_without_sync;
  if (!faults || o_.interpolation_time.value == 0) return false;
  const double period_s =
      static_cast<double>(o_.interpolation_time.value) * std::pow(10.0, static_cast<double>(o_.interpolation_exponent.value));
  // EPOS4 misses its target, whichever of SYNC and RPDO was lost.
  const Time last = config_.habit->misses_targets ? std::min(last_sync_, last_target_) : last_sync_;
  const Time since = std::max(last, enabled_at_);
  const Object* bridged = node_.objects().find(config_.habit->sync_losses_bridged_by, 0);
  const double cycles = bridged != nullptr ? static_cast<double>(bridged->value) : config_.habit->sync_losses_bridged;
  return (now - since).s() > (2.5 + cycles) * period_s;
}

bool Drive402::brake_closed(Time now) const {
  return config_.habit != nullptr && state_ == DriveState::operation_enabled &&
         now - enabled_at_ < Duration::from_ms(config_.habit->brake_opens_ms);
}

bool Drive402::follows_badly() const {
  if (state_ != DriveState::operation_enabled || mode_ == mode_homing || mode_ == 0) return false;
  if (o_.following_window.value == 0xFFFFFFFF) return false;
  return std::abs(profile_.position() - static_cast<double>(o_.position_actual.value)) > static_cast<double>(o_.following_window.value);
}

}  // namespace lf::devices
