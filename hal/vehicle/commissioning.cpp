#include "hal/vehicle/commissioning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "firmware/arm/actuator.hpp"
#include "firmware/arm/gripper.hpp"
#include "hal/vehicle/gentle_network.hpp"
#include "hal/vehicle/zero_moved.hpp"

namespace lf::hal {

namespace {

// After the last order: quick stop, NMT stop.
constexpr Duration stop_time = Duration::from_ms(300);
// Of the following-error window, 0.15 rad where a joint has the most counts: off the stop, and how near is there.
constexpr double back_off_windows = 1, arrived_windows = 0.03;
// Of the torque that is allowed: what stands still with less does not press, its encoder or its drive is at fault. Free motion takes about half of it.
constexpr double least_pressing = 0.7;
// Drives without 6072 press with what their maker's tool allows. So far above what is meant, for longer than a breakaway lasts, a joint is stopped.
constexpr double too_hard = 1.3;
constexpr int too_hard_ticks = 25;
// Of the load on the stop. A spring's torque falls in proportion: from two places the place of none is known, well above the weight of the arm. The second
// load is at most so much of the first.
constexpr double begins_to_fall = 0.9, has_fallen = 0.5, still_falls = 0.7;
// A screw that nearly locks itself tells little on its way back.
constexpr double least_back_efficiency = 0.3;
// The stretch on which friction is found, in following-error windows: some 0.15 to 0.6 rad.
constexpr double least_rub_windows = 1, most_rub_windows = 4;
// Of the drives' best: a third of the torque has to do.
constexpr double rub_acceleration = 0.25;

// Of a target's lead over its joint: then it presses.
constexpr double nearly_all = 0.9;

// The sum over all senders of what another master has sent as RPDOs.
std::uint32_t foreign_set_points(const canopen::Network& network) {
  std::uint32_t frames = 0;
  for (std::size_t slot = 0; slot < canopen::ForeignFrames::slots; ++slot) {
    const canopen::ForeignFrames::Sender& sender = network.foreign()[slot];
    if (canopen::is_rpdo(sender.id)) frames += sender.frames;
  }
  return frames;
}

}  // namespace

Commissioning::Commissioning(const Config& config) : config_(config), network_(gentle_network(config)), power_(config_.arm) {}

double Commissioning::stop_rad(std::size_t joint) const {
  const ArmModel::Joint& stroke = config_.arm.joint(joint);
  return direction(joint) < 0 ? stroke.lower_rad : stroke.upper_rad;
}

// Where the jaw is left: closed, and not pressing on its stop.
double Commissioning::shut_rad() const { return config_.arm.jaw().lower_rad + 0.005; }

// Whether a joint stands is all that they tell here: where its zero is nobody knows, and a screw's counts are taken for those in the middle of its stroke.
safety::JointStates Commissioning::joint_states(Time now) const {
  safety::JointStates joints;
  for (std::size_t i = 0; i < joint_count(); ++i) {
    const canopen::Axis& axis = network_.axis(i);
    const ArmModel::Joint& stroke = config_.arm.joint(i);
    joints.fresh[i] = axis.fresh(now);
    joints.position_rad[i] = axis.actual_counts() * arm::rad_per_count(stroke, 0.5 * (stroke.lower_rad + stroke.upper_rad));
  }
  return joints;
}

PerJoint<double> Commissioning::places_rad() const {
  PerJoint<double> places{};
  for (std::size_t i = 0; i < joint_count() && !config_.here; ++i) places[i] = stop_rad(i);
  return places;
}

void Commissioning::go(State state, Time now) {
  state_ = state;
  since_ = moved_ = now;
  too_hard_ticks_ = 0;
}

void Commissioning::stop(const char* why) {
  if (stop_reason_ == nullptr) stop_reason_ = why;
}

void Commissioning::emergency_stop(const char* why) {
  emergency_stopped_ = true;
  stop(why);
}

void Commissioning::fail(const char* why, Time now) {
  std::snprintf(failure_.data(), failure_.size(), "%s", why);
  power_.stop(now, network_);
  network_.io().set_outputs(0);
  go(State::halting, now);
}

void Commissioning::fail_joint(const char* why, Time now) {
  fail(why, now);
  std::snprintf(failure_.data(), failure_.size(), "%s: %s", config_.names[joint_].c_str(), why);
}

// What a failed one has found is not kept.
PerJoint<bool> Commissioning::zeros_lost() const {
  PerJoint<bool> lost{};
  for (std::size_t i = 0; i < joint_count(); ++i) {
    const canopen::Axis& one = network_.axis(i);
    lost[i] = one.zero_lost() && !(state_ == State::done && found_[i] && one.stats().zeros_lost == losses_when_found_[i]);
  }
  return lost;
}

PerJoint<bool> Commissioning::lost_before_found() const {
  PerJoint<bool> lost{};
  for (std::size_t i = 0; i < joint_count(); ++i) lost[i] = found_[i] && losses_when_found_[i] > 0;
  return lost;
}

bool Commissioning::without_power() const {
  return std::none_of(powered_.begin(), powered_.end(), [](bool powered) { return powered; });
}

void Commissioning::tick(Time now, canopen::Outbox& outbox) {
  if (!booted_) {
    booted_ = true;
    network_.start_boot(now);
    since_ = now;
  }
  note_power(now);
  watch(now);
  step(now);
  power_.tick(joint_states(now), now, network_);
  network_.tick(now, outbox);
}

// A drive that was just told to take power has not heard it yet.
void Commissioning::note_power(Time now) {
  for (std::size_t i = 0; i < joint_count(); ++i) {
    const canopen::Axis& one = network_.axis(i);
    const bool off = one.confirmed_unpowered(now) && one.requested() != canopen::AxisRequest::hold_enabled;
    if (one.fresh(now) && one.powered()) powered_[i] = true;
    if (off || network_.restarted_as_told(i)) powered_[i] = false;
  }
}

// Set points of another master came since the last look: they take back a quick stop, and no stop but that of the power holds against them.
bool Commissioning::hear_set_points() {
  const std::uint32_t before = std::exchange(set_points_, foreign_set_points(network_));
  return state_ != State::booting && state_ != State::stopping && !ended() && set_points_ != before;
}

void Commissioning::watch(Time now) {
  if (hear_set_points()) {
    if (state_ != State::halting && state_ != State::powering_off) fail("another master is on the bus", now);
    return power_.remove(now, network_);
  }
  const bool ends = state_ == State::halting || state_ == State::powering_off || state_ == State::stopping || ended();
  if (ends) return;
  if (stop_reason_ != nullptr) return fail(stop_reason_, now);
  if (state_ == State::booting) {
    foreign_frames_ = network_.foreign_frames();
    return;
  }
  if (!network_.operational()) return fail("a node was lost", now);
  const canopen::IoModule& io = network_.io();
  if (!io.seen() || !io.fresh(now)) return fail("the emergency-stop chain cannot be read", now);
  if (!io.estop_closed()) {
    emergency_stopped_ = true;
    return fail("the emergency-stop chain is open", now);
  }
  if (network_.foreign_frames() != foreign_frames_) return fail("another master is on the bus", now);
  for (std::size_t i = 0; i < joint_count(); ++i) {
    const canopen::Axis& one = network_.axis(i);
    if (one.fault() == canopen::AxisFault::none) continue;
    fail(canopen::name(one.fault()), now);
    std::snprintf(failure_.data(), failure_.size(), "%s: %s", config_.names[i].c_str(), canopen::name(one.fault()));
    return;
  }
  if (joint_ < joint_count() && now - joint_since_ > longest(config_.arm.joint(joint_), config_))
    fail_joint(found_[joint_] ? "it was not back in time" : "no stop was found in time", now);
}

Duration Commissioning::longest(const ArmModel::Joint& joint, const Config& config) {
  constexpr double reserve = 1.2, besides_s = 60;  // for the stops, for friction
  const double way_s =
      static_cast<double>(joint.upper_rad - joint.lower_rad) / (config.speed_fraction * static_cast<double>(joint.velocity_rad_s));
  return std::max(config.longest, Duration::from_s(2 * reserve * way_s + besides_s));
}

void Commissioning::step(Time now) {
  switch (state_) {
    case State::booting:
      if (network_.boot().state == canopen::BootState::failed) {
        fail("boot failed", now);
        const canopen::BootReport boot = network_.boot();
        if (const canopen::NodeBoot* node = boot.failed(); node != nullptr)
          std::snprintf(failure_.data(), failure_.size(), "boot failed, node %d: %s", node->node, canopen::name(node->failure));
        return;
      }
      if (network_.boot().state != canopen::BootState::done || !network_.operational()) return;
      if (config_.here) return take_here(now);
      return begin_work(now);
    case State::enabling:
      power_.switch_on();
      if (power_.state() != safety::Power::State::on) return;  // a drive that had power before is being told off
      if (axis().requested() != canopen::AxisRequest::hold_enabled) axis().request(canopen::AxisRequest::hold_enabled);
      powered_[joint_] = true;
      if (!axis().enabled()) return;
      target_ = last_counts_ = started_counts_ = axis().actual_counts();
      moved_ = now;
      reopening_ = false;
      return go(State::seeking, now);
    case State::seeking: return seek(now);
    case State::easing: return ease(now);
    case State::rubbing: return rub(now);
    case State::backing_off: return back_off(now);
    case State::releasing:
      if (axis().state() != canopen::AxisState::disabled) return;
      return end_joint(now);
    case State::halting:
      if (power_.state() != safety::Power::State::stopping) go(State::powering_off, now);
      return;
    case State::powering_off:
      if (!power_.off()) return;
      network_.shut_down();
      return go(State::stopping, now);
    case State::stopping:
      if (now - since_ >= stop_time) go(failure_[0] == '\0' ? State::done : State::failed, now);
      return;
    case State::done:
    case State::failed: return;
  }
}

const char* Commissioning::why_not() const {
  const std::size_t jaw = config_.arm.jaw_joint();
  const bool arm_moves =
      std::any_of(config_.joints.begin(), config_.joints.begin() + config_.arm.arm_joints(), [](bool one) { return one; });
  if (!arm_moves || config_.joints[jaw]) return nullptr;
  if (!config_.jaw_known || network_.axis(jaw).zero_lost()) return "nobody knows whether the jaw is empty: commission it, too";
  const std::int32_t counts = network_.axis(jaw).actual_counts() - config_.network.drives[jaw].encoder_zero_counts;
  if (arm::stands_closed(config_.arm.jaw(), arm::rad_from_counts(config_.arm.joint(jaw), counts))) return nullptr;
  return "the jaw is not closed: what is between its fingers would move with the arm, or be in its way. Commission the jaw, too, which "
         "opens and closes it";
}

void Commissioning::begin_work(Time now) {
  if (const char* why = why_not()) return fail(why, now);
  turn_ = 0;
  next_joint(now);
}

void Commissioning::next_joint(Time now) {
  while (turn_ < joint_count() && !config_.joints[in_turn(turn_)]) ++turn_;
  joint_since_ = now;
  if (turn_ < joint_count()) {
    joint_ = in_turn(turn_);
    return go(State::enabling, now);
  }
  joint_ = joint_count();
  network_.shut_down();
  go(State::stopping, now);
}

void Commissioning::end_joint(Time now) {
  if (ends_elsewhere(joint_, now)) return;
  ++turn_;
  next_joint(now);
}

void Commissioning::take_here(Time now) {
  for (std::size_t i = 0; i < joint_count(); ++i) {
    if (config_.joints[i]) take_zero(i, network_.axis(i).actual_counts() - arm::counts_from_rad(config_.arm.joint(i), 0));
  }
  for (std::size_t i = 0; i < joint_count(); ++i) {
    if (ends_elsewhere(i, now)) return;
  }
  turn_ = joint_count();
  next_joint(now);
}

void Commissioning::take_zero(std::size_t joint, std::int32_t zero_counts) {
  zero_counts_[joint] = zero_counts;
  found_[joint] = true;
  losses_when_found_[joint] = network_.axis(joint).stats().zeros_lost;
  moved_rad_[joint] = off_earlier_rad(joint);
}

double Commissioning::off_earlier_rad(std::size_t joint) const {
  if (network_.axis(joint).zero_lost()) return 0;
  const canopen::DriveSetup& drive = config_.network.drives[joint];
  const auto off_rad = [&](std::int32_t earlier_counts) {
    return zero_moved_rad(config_.arm.joint(joint), places_rad()[joint], static_cast<double>(zero_counts_[joint]) - earlier_counts);
  };
  const double off_known = drive.zero_known ? off_rad(drive.encoder_zero_counts) : 0;
  const double off_file = config_.zero_in_file[joint] ? off_rad(*config_.zero_in_file[joint]) : 0;
  const double most_rad = std::max(off_known, off_file);
  return most_rad > told_move_rad ? most_rad : 0;
}

bool Commissioning::ends_elsewhere(std::size_t joint, Time now) {
  if (moved_rad_[joint] <= 0 || config_.moved) return false;
  std::array<char, 160> why{};
  std::snprintf(
      why.data(), why.size(),
      "its zero was found %.2f rad from where it was: %s. If its encoder or its stop was changed, commission it alone with --moved",
      moved_rad_[joint], config_.here ? "see how it stands in the jig" : "look for what it met");
  joint_ = joint;
  fail_joint(why.data(), now);
  return true;
}

bool Commissioning::presses_too_hard() {
  const bool now = std::abs(axis().torque_permille()) > too_hard * pressing_permille(config_, joint_);
  too_hard_ticks_ = now ? too_hard_ticks_ + 1 : 0;
  return too_hard_ticks_ > too_hard_ticks;
}

void Commissioning::fail_pressing(Time now) {
  std::array<char, 120> why{};
  std::snprintf(why.data(), why.size(), "it presses with %ld %% of its rated torque: limit it to %ld %% with its maker's tool",
                std::lround(std::abs(axis().torque_permille()) / 10.0), std::lround(pressing_permille(config_, joint_) / 10.0));
  fail_joint(why.data(), now);
}

// Against what it presses on.
bool Commissioning::stands(Time now, bool pressing) {
  const std::int32_t actual = axis().actual_counts();
  // A joint that presses between two counts wavers by one.
  if (std::abs(actual - last_counts_) > 1) {
    last_counts_ = actual;
    moved_ = now;
  }
  return pressing && now - moved_ >= config_.stall;
}

// The target creeps on, a lead ahead of the joint at most: at the stop the lead is what presses.
void Commissioning::seek(Time now) {
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const double way = direction(joint_), lead = drive.following_window_counts / 2.0;
  const std::int32_t actual = axis().actual_counts();
  if (presses_too_hard()) return fail_pressing(now);
  target_ += way * config_.speed_fraction * drive.max_speed_counts_s * network_.config().sync_period.s();
  target_ = std::clamp(target_, actual - lead, actual + lead);
  (void)axis().set_target_counts(static_cast<std::int32_t>(target_));
  if (!stands(now, std::abs(target_ - actual) >= nearly_all * lead)) return;
  pressed_permille_ = std::abs(axis().torque_permille());
  if (pressed_permille_ < least_pressing * pressing_permille(config_, joint_)) {
    std::array<char, 120> why{};
    std::snprintf(why.data(), why.size(), "it stands still and presses with %ld %% of its torque only: look at its encoder and its gear",
                  std::lround(pressed_permille_ / 10));
    return fail_joint(why.data(), now);
  }
  pressed_load_ = config_.transmissions[joint_].friction.efficiency * (pressed_permille_ - coulomb_permille());
  pressed_counts_ = actual;
  easing_counts_.reset();
  target_ = actual;
  go(State::easing, now);
}

// In the drive's unit, thousandths of the rated torque.
double Commissioning::coulomb_permille() {
  return 1e3 * config_.transmissions[joint_].friction.coulomb_nm / (1e-6 * std::max(1u, axis().rated_torque_unm()));
}

// Back so slowly that each reading is one at rest, until the torque is gone.
void Commissioning::ease(Time now) {
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const double way = direction(joint_);
  const std::int32_t actual = axis().actual_counts();
  // The spring of gear and links turns the motor back now: what it has of torque comes through the friction of that direction.
  const double back_efficiency = std::max(least_back_efficiency, config_.transmissions[joint_].friction.back_efficiency);
  const double load = (way * axis().torque_permille() + coulomb_permille()) / back_efficiency;
  if (!easing_counts_ && load < begins_to_fall * pressed_load_) {
    easing_counts_ = actual;
    easing_load_ = load;
  }
  if (!easing_counts_ || load >= std::min(has_fallen * pressed_load_, still_falls * easing_load_)) {
    target_ -= way * config_.ease_fraction * drive.max_speed_counts_s * network_.config().sync_period.s();
    (void)axis().set_target_counts(static_cast<std::int32_t>(std::lround(target_)));
    if (std::abs(target_ - pressed_counts_) > drive.following_window_counts) fail_joint("it does not come off its stop", now);
    return;
  }
  stop_counts_ = actual + (actual - *easing_counts_) * load / (easing_load_ - load);
  const double touching_rad = stop_rad(joint_) + way * 0.5 * config_.backlash_rad[joint_];
  const double zero = stop_counts_ - arm::exact_counts_from_rad(config_.arm.joint(joint_), touching_rad);
  take_zero(joint_, static_cast<std::int32_t>(std::lround(zero)));
  target_ = actual;
  begin_rubbing(now);
}

double Commissioning::off_stop_counts() const {
  return stop_counts_ - direction(joint_) * back_off_windows * config_.network.drives[joint_].following_window_counts;
}

double Commissioning::started_off_stop() const {
  const double off_stop = off_stop_counts();
  return direction(joint_) < 0 ? std::max<double>(started_counts_, off_stop) : std::min<double>(started_counts_, off_stop);
}

double Commissioning::goal_counts() const {
  if (!is_jaw(joint_)) return started_off_stop();
  return reopening_ ? off_stop_counts() : zero_counts_[joint_] + arm::exact_counts_from_rad(config_.arm.joint(joint_), shut_rad());
}

// The stretch begins off the stop and goes where the joint has just come from: there is nothing on it.
void Commissioning::begin_rubbing(Time now) {
  const double window = config_.network.drives[joint_].following_window_counts;
  const double length = std::min(std::abs(started_off_stop() - off_stop_counts()), most_rub_windows * window);
  if (length < least_rub_windows * window) return go(State::backing_off, now);
  rub_from_ = off_stop_counts();
  rub_to_ = rub_from_ - direction(joint_) * length;
  pass_.reset();
  rub_speed_ = 0;
  fit_.reset();
  go(State::rubbing, now);
}

void Commissioning::rub(Time now) {
  if (presses_too_hard()) return fail_pressing(now);
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const bool back = !pass_ || *pass_ % 2 == 1;  // to where the stretch begins
  const double end = back ? rub_from_ : rub_to_;
  const double dt_s = network_.config().sync_period.s();
  const double speed = (pass_ && *pass_ >= 2 ? config_.fast_fraction : config_.slow_fraction) * drive.max_speed_counts_s;
  const double acceleration = rub_acceleration * drive.quick_stop_counts_s2;
  // No faster than it can brake before the end, and on the last step as fast as just reaches it.
  const double way_left = std::abs(end - target_);
  const double wanted = std::min({speed, std::sqrt(2 * acceleration * way_left), way_left / dt_s});
  rub_speed_ = std::min(wanted, rub_speed_ + acceleration * dt_s);
  const double place = (axis().actual_counts() - rub_from_) / (rub_to_ - rub_from_);
  if (pass_ && rub_speed_ == speed) fit_.add(*pass_, place, 1e-3 * std::copysign(speed, end - target_), axis().torque_permille());
  target_ = way_left < 1 ? end : target_ + std::copysign(rub_speed_ * dt_s, end - target_);
  (void)axis().set_target_counts(static_cast<std::int32_t>(std::lround(target_)));
  if (target_ != end || std::abs(axis().actual_counts() - end) > std::max(3.0, arrived_windows * drive.following_window_counts)) return;
  rub_speed_ = 0;
  pass_ = pass_ ? *pass_ + 1 : 0;
  if (*pass_ < FrictionFit::passes) return;
  end_rubbing();
  go(State::backing_off, now);
}

void Commissioning::end_rubbing() {
  const arm::TransmissionSetup& known = config_.transmissions[joint_];
  const FoundFriction found = fit_.solve(known.friction.efficiency, known.friction.back_efficiency);
  friction_found_[joint_] = found.valid;
  const double mnm = 1e-6 * axis().rated_torque_unm();                            // of a thousandth of the rated torque
  const double motor_rad_s = 1000 / known.counts_per_rev * 2 * std::numbers::pi;  // of 1000 counts/s
  friction_[joint_] = {found.coulomb * mnm, found.viscous * mnm / motor_rad_s, found.rms * mnm};
}

// To where it was: an arm that is left unfolded stands outside of its workspace, and no order leads it back. From a stop, off it. The jaw is closed, and opened
// again where something keeps it from closing.
void Commissioning::back_off(Time now) {
  const canopen::DriveSetup& drive = config_.network.drives[joint_];
  const double window = drive.following_window_counts, lead = window / 2;
  const double goal = goal_counts();
  const double step = config_.speed_fraction * drive.max_speed_counts_s * network_.config().sync_period.s();
  const std::int32_t actual = axis().actual_counts();
  const bool closing = is_jaw(joint_) && !reopening_;
  if (presses_too_hard()) return closing ? reopen(now) : fail_pressing(now);
  target_ = std::clamp(target_ + std::clamp(goal - target_, -step, step), actual - lead, actual + lead);
  (void)axis().set_target_counts(static_cast<std::int32_t>(std::lround(target_)));
  const bool arrived = std::abs(actual - goal) <= std::max(3.0, arrived_windows * window);  // drives hold within two counts
  if (!arrived && stands(now, target_ == goal || std::abs(target_ - actual) >= nearly_all * lead)) {
    return closing ? reopen(now) : fail_joint("something is in its way back", now);
  }
  if (!arrived) return;
  if (reopening_) return fail_joint("something is between its fingers: take it out, or move the arm away from it", now);
  axis().request(canopen::AxisRequest::disable);
  go(State::releasing, now);
}

// From where it stands: a target that is led back over its lead would go on pressing meanwhile.
void Commissioning::reopen(Time now) {
  reopening_ = true;
  moved_ = now;
  too_hard_ticks_ = 0;
  target_ = axis().actual_counts();
  (void)axis().set_target_counts(axis().actual_counts());
}

}  // namespace lf::hal
