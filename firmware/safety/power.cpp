#include "firmware/safety/power.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/arm/actuator.hpp"

namespace lf::safety {

namespace {

// Since it was last booted, or ever. One that was lost or taken out of operation was heard before.
bool never_heard(const canopen::Network& network, std::size_t joint) {
  return network.axis(joint).state() == canopen::AxisState::offline && !network.fault(joint).link();
}

}  // namespace

void Power::stop(Time now, canopen::Network& network) {
  if (state_ == State::stopping || state_ == State::removing) return;
  network.quick_stop_all();
  restart_unheard(now, network);
  state_ = State::stopping;
  told_by_nmt_.fill(false);
  left_.fill(false);
  taken_.fill(std::nullopt);
  brakes_since_.fill(now);
  note_what_left(now, network);
  outputs_off_since_ = now;
  insist_at_ = now + heed_time;
  since_ = now;
  rest_since_.fill(now);
  rest_rad_.fill(HUGE_VAL);
}

void Power::remove(Time now, canopen::Network& network) {
  network.remove_power();
  if (state_ == State::removing) return;
  restart_unheard(now, network);
  if (state_ != State::stopping) {
    told_by_nmt_.fill(false);
    taken_.fill(std::nullopt);
    outputs_off_since_ = now;
  }
  state_ = State::removing;
  since_ = now;
  // What NMT has taken out of operation takes no process data.
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    if (told_by_nmt_[i] && !network.restarted_as_told(i)) network.reset_node(i, now);
  }
  insist_at_ = network.foreign_nmt_since(now, insist_period) ? now : now + heed_time;
}

Duration Power::longest_lowering(const canopen::NetworkConfig& config) {
  Duration longest = usual_lowering;
  for (const canopen::DriveSetup& drive : config.drives) longest = std::max(longest, drive.profile.brake_closes + lowering_beside_brake);
  return longest;
}

void Power::lower(Time now, canopen::Network& network) {
  if (state_ == State::stopping || state_ == State::removing) return;
  network.disable_all();
  state_ = State::lowering;
  since_ = now;
}

// Braking, NMT stop makes what does not heed its process data stop by itself (6007). Where the power is to go, only a restart is sure for every make: some
// stay powered after their quick stop, and deaf to process data once they are stopped.
void Power::insist(Time now, canopen::Network& network) {
  if (now < insist_at_) return;
  insist_at_ = now + (network.foreign_nmt_since(now, insist_period) ? insist_period_beside : insist_period);
  restart_unheard(now, network);
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    if (never_heard(network, i) || heeds(i, now, network)) continue;
    if (state_ == State::stopping && !taken_[i]) {
      network.stop_node(i);
      // Since the first order: a repeated one finds it braking.
      if (!told_by_nmt_[i]) brakes_since_[i] = now;
      told_by_nmt_[i] = true;
    } else if (!network.restarted_as_told(i)) {
      network.reset_node(i, now);
    }
  }
}

// One that has restarted already stays so: nothing but a boot or another master gives it power.
void Power::restart_unheard(Time now, canopen::Network& network) {
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    if (never_heard(network, i) && !network.restarted_as_told(i)) network.reset_node(i, now);
  }
}

// A drive that is not heard may hear, and brakes in good order then: it is given time before NMT makes it deaf to process data. Where none is heard, nobody
// knows which of them hear.
bool Power::heeds(std::size_t joint, Time now, const canopen::Network& network) const {
  const canopen::Axis& axis = network.axis(joint);
  if (axis.fresh(now) && taken_[joint]) return !axis.powered() || now - *taken_[joint] < heed_time;
  if (axis.fresh(now)) return state_ == State::stopping ? !axis.runs() : !axis.powered();
  if (network.fault(joint).left_operational || network.foreign_nmt_since(now, insist_period)) return false;
  if (state_ == State::stopping) return deaf_ticks_ < deaf_ticks;
  return !told_by_nmt_[joint] && now - since_ < silent_time;
}

bool Power::hears_none(Time now, const canopen::Network& network) {
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    if (network.axis(i).fresh(now)) return false;
  }
  return true;
}

void Power::tick(const JointStates& joints, Time now, canopen::Network& network) {
  deaf_ticks_ = hears_none(now, network) ? std::min(deaf_ticks_ + 1, deaf_ticks) : 0;
  if (state_ == State::stopping || state_ == State::removing) {
    note_what_left(now, network);
    insist(now, network);
    insist_on_outputs(now, network);
  }
  if (state_ == State::stopping) {
    const Standing stands = standing(joints, now, network);
    if (confirmed(now, network) || stands.all || now - since_ >= longest_stop) remove(now, network);
    if (state_ == State::stopping && stands.heard) take_heard(joints, now, network);
  } else if (state_ == State::lowering) {
    if (confirmed(now, network)) state_ = State::off;
    if (state_ != State::off && now - since_ >= longest_lowering(network.config())) remove(now, network);
  } else if (state_ == State::removing) {
    network.remove_power();
    if (confirmed(now, network)) state_ = State::off;
  } else if (state_ == State::off) {
    // Nothing comes on by itself; a drive that does, or that is heard again after a silence, is told off.
    for (std::size_t i = 0; i < network.drive_count(); ++i) {
      const canopen::Axis& axis = network.axis(i);
      if (axis.fresh(now) && axis.powered()) return remove(now, network);
    }
  }
}

// Of the quick stop, 6085. Options 1 and 5 of 605A brake by another object, and a drive without 6085 by its maker's number.
Duration Power::ramp(const JointStates& joints, std::size_t joint, const canopen::Network& network) const {
  const canopen::DriveSetup& setup = network.axis(joint).setup();
  const std::int16_t option = network.axis(joint).quick_stop_option();
  const bool by_6085 = (option == 2 || option == 6) && setup.quick_stop_counts_s2 != 0 &&
                       setup.profile.absence(canopen::BootValue::quick_stop_deceleration) == nullptr;
  Duration ramp;
  if (joints.speed_known[joint] && setup.quick_stop_counts_s2 != 0) {
    const double counts_per_rad = 1 / std::abs(arm::rad_per_count(arm_->joint(joint), joints.position_rad[joint]));
    const double to_still_rad_s = std::max(0.0, std::abs(joints.velocity_rad_s[joint]) - still_rad / still_time.s());
    ramp = Duration::from_s(to_still_rad_s * counts_per_rad / setup.quick_stop_counts_s2);
  }
  return by_6085 && joints.speed_known[joint] ? ramp : std::max(ramp, unknown_ramp);
}

Power::Standing Power::standing(const JointStates& joints, Time now, const canopen::Network& network) {
  Standing stands;
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    const canopen::Axis& axis = network.axis(i);
    // What has no power is not waited for: a screw may be driven back.
    if (axis.confirmed_unpowered(now) && now - since_ >= heed_time) continue;
    if (!joints.fresh[i]) {
      // Its ramp counts from when it was told, or from when it was heard last, whichever is later: the speed is of that moment.
      const Time began = std::max(brakes_since_[i], axis.seen() ? axis.actual_time() : since_);
      const Duration margin = left_[i] ? heed_time : told_by_nmt_[i] ? still_time : silent_margin;
      stands.all = stands.all && now - began >= ramp(joints, i, network) + margin;
      continue;
    }
    const double rad = joints.position_rad[i];
    const std::int32_t counts = axis.actual_counts();
    const bool one_count = std::abs(std::int64_t{counts} - rest_counts_[i]) <= 1;
    const bool known = std::isfinite(rest_rad_[i]);
    if (!known || (std::abs(rad - rest_rad_[i]) > still_rad && !one_count)) {
      rest_rad_[i] = rad;
      rest_counts_[i] = counts;
      rest_since_[i] = now;
    }
    stands.heard = stands.heard && now - rest_since_[i] >= still_time;
  }
  stands.all = stands.all && stands.heard;
  return stands;
}

// What stands does not wait under power for the ramp of a joint that nobody hears.
void Power::take_heard(const JointStates& joints, Time now, canopen::Network& network) {
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    if (!joints.fresh[i] || taken_[i]) continue;
    network.axis(i).request(canopen::AxisRequest::remove_power);
    taken_[i] = now;
  }
}

// By another master's NMT, a restart, or a deadline of its own. What has left operation sends nothing, so that it brakes since it was heard last; one that was silent
// while it was in operation brakes since it was found to have left.
void Power::note_what_left(Time now, const canopen::Network& network) {
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    const canopen::NodeFault& fault = network.fault(i);
    if (left_[i] || !(fault.rebooted || fault.left_operational)) continue;
    left_[i] = true;
    const canopen::Axis& axis = network.axis(i);
    const bool was_silent = axis.seen() && network.operational_at(i) - axis.actual_time() > heed_time;
    if (was_silent && !told_by_nmt_[i]) brakes_since_[i] = now;
  }
}

// Its process data are lost: stopped by NMT, every output takes its error value, off.
void Power::insist_on_outputs(Time now, canopen::Network& network) {
  const canopen::IoModule& io = network.io();
  const bool known_off = io.fresh(now) && io.outputs() == 0;
  if (known_off || io.wanted_outputs() != 0 || !io.seen()) outputs_off_since_ = now;
  if (now - outputs_off_since_ < heed_time) return;
  network.stop_node(network.io_index());
  outputs_off_since_ = now + (insist_period - heed_time);
}

// A statusword that was sent before the drive heard the order says nothing of it: a drive on its way up would be taken for down.
bool Power::confirmed(Time now, const canopen::Network& network) const {
  if (now - since_ < network.config().sync_period * (canopen::Axis::handshake_syncs + 1)) return false;
  for (std::size_t i = 0; i < network.drive_count(); ++i) {
    const canopen::Axis& axis = network.axis(i);
    // A node that this master has restarted has no power. One that booted up by itself may have it: NMT reset communication leaves some drives theirs.
    if (network.restarted_as_told(i) || axis.confirmed_unpowered(now)) continue;
    const bool given_time = state_ == State::removing && now - since_ >= blind_time;
    if (axis.fresh(now) || !given_time) return false;
  }
  return true;
}

const char* name(Power::State state) {
  switch (state) {
    case Power::State::off: return "off";
    case Power::State::on: return "on";
    case Power::State::lowering: return "lowering";
    case Power::State::stopping: return "stopping";
    case Power::State::removing: return "removing";
  }
  return "unknown";
}

}  // namespace lf::safety
