#include "firmware/safety/watch.hpp"

#include <algorithm>
#include <cmath>

namespace lf::safety {

namespace {

// Limits are held against noise: one wrist count is 0.003 rad, and the observer overshoots by a tenth at the end of a move.
constexpr double position_tolerance_rad = 0.01;
constexpr double speed_tolerance = 1.25;
// Of the rated torque: two sigma of 12-bit current sensing and half a thousandth's step of 6077.
constexpr double torque_doubt = 0.01;
// The tool's box is a coarse fence; calibration and quantisation are worth a millimetre.
constexpr double workspace_tolerance_m = 0.002;
// A torque over its limit has to last: breakaway peaks of a gear last some milliseconds.
constexpr int overload_ticks = 75;  // 300 ms

}  // namespace

void Watch::observe(const canopen::Network& network, const PerJoint<double>& rad, Time now) {
  joints_.valid = true;
  Time newest;
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) {
    const canopen::Axis& axis = network.axis(i);
    joints_.fresh[i] = is_fresh(axis, now) && std::isfinite(rad[i]);
    joints_.valid = joints_.valid && joints_.fresh[i];
    if (axis.actual_time() > newest) newest = axis.actual_time();
  }
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) {
    if (joints_.fresh[i]) joints_.position_rad[i] = rad[i];
  }
  if (!joints_.valid) return;
  const double dt_s = (newest - joints_.t).s();
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) {
    const canopen::Axis& axis = network.axis(i);
    // A drive that homes by its own method changes its zero: its reading leaps, and the joint does not.
    const bool zero_changes = axis.requested() == canopen::AxisRequest::home;
    if (!observing_ || dt_s > 0.1 || zero_changes) {
      observers_[i].reset(rad[i]);
    } else if (dt_s > 0) {
      observers_[i].update(rad[i], dt_s);
    }
    joints_.velocity_rad_s[i] = observers_[i].velocity_rad_s();
    joints_.speed_known[i] = !zero_changes;
    observe_torque(axis, i);
    observe_encoder(axis, i, now);
  }
  joints_.t = newest;
  observing_ = true;
}

void Watch::observe_torque(const canopen::Axis& axis, std::size_t joint) {
  const ArmModel::Joint& which = arm_->joint(joint);
  const double q = joints_.position_rad[joint], rated_nm = axis.rated_torque_unm() * 1e-6;
  const arm::Transmission transmission(which, transmissions_[joint]);
  const arm::TorqueEstimate torque =
      torque_observers_[joint].update(transmission, arm::rad_per_count(which, q), q, joints_.velocity_rad_s[joint],
                                      axis.torque_permille() * 1e-3 * rated_nm, torque_doubt * rated_nm);
  joints_.torque_nm[joint] = torque.nm;
  joints_.torque_low_nm[joint] = torque.low_nm;
  joints_.torque_high_nm[joint] = torque.high_nm;
}

void Watch::observe_encoder(const canopen::Axis& axis, std::size_t joint, Time now) {
  // Of the joint's torque limit: 3.9 N m of the default's 26, 10 N at the tool; and the half, which nothing but a hold takes. Of what the motor may give, less
  // the doubt of its current: near a stroke's end a screw's motor gives its joint less than half of the limit.
  constexpr double load_share = 0.15, much_share = 0.5, motor_share = 0.9;
  const double limit_nm = limits_.joints[joint].max_torque_nm;
  StuckEncoder::Sample sample;
  sample.t = now;
  sample.actual_counts = axis.actual_counts();
  sample.target_counts = axis.target_counts();
  sample.rad_per_count = arm::rad_per_count(arm_->joint(joint), joints_.position_rad[joint]);
  sample.torque_nm = joints_.torque_nm[joint];
  sample.load_nm = load_share * limit_nm;
  sample.follows = axis.enabled();
  sample.holds_much = at_least_nm(joint) >= much_share * limit_nm;
  sample.motor_at_limit = std::abs(axis.torque_permille()) >= motor_share * axis.setup().max_torque_of(axis.rated_torque_unm());
  const bool stuck = encoders_[joint].update(sample);
  stuck_[joint] = stuck && joint < arm_->pointing_joints();
}

double Watch::at_least_nm(std::size_t joint) const {
  return arm::TorqueEstimate{joints_.torque_nm[joint], joints_.torque_low_nm[joint], joints_.torque_high_nm[joint]}.at_least_nm();
}

bool Watch::shows_nothing(std::size_t joint) const { return encoders_[joint].shows_nothing(); }

// Half a SYNC period more than the limit, for the loop's jitter.
bool Watch::is_fresh(const canopen::Axis& axis, Time now) const {
  const Duration oldest = Duration::from_s(limits_.stale_position_s) + can_map::sync_period / 2;
  return axis.fresh(now) && now - axis.actual_time() <= oldest;
}

double Watch::excursion_rad(std::size_t joint) const {
  const double q = joints_.position_rad[joint];
  return std::max({0.0, limits_.joints[joint].min_rad - q, q - limits_.joints[joint].max_rad});
}

bool Watch::outside(std::size_t joint) const { return excursion_rad(joint) > position_tolerance_rad; }

bool Watch::any_outside() const {
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) {
    if (outside(i)) return true;
  }
  return tool_outside_;
}

void Watch::tolerate_excursion(bool tolerate) {
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) tolerated_rad_[i] = tolerate ? excursion_rad(i) : 0;
  tolerating_ = tolerate;
  tolerated_m_ = HUGE_VAL;  // as far as the tool is out in the next check
}

void Watch::raise(bool present, std::size_t index, const FaultReport& report, FaultArbiter& began) {
  bool& known = present_[static_cast<std::size_t>(report.fault)][index];
  if (present && !known && !began.report(report)) return;  // no room: reported in the next tick
  known = present;
}

void Watch::check(const canopen::Network& network, const Vec3& tool_m, Vigilance vigilance, Time now, FaultArbiter& began) {
  check_bus(network, now, began);
  if (vigilance == Vigilance::bus) return stood_.fill(false);
  check_nodes(network, vigilance, now, began);
  if (vigilance == Vigilance::nodes) {
    for (std::size_t i = 0; i < arm_->joint_count(); ++i) check_standing(network, i, began);
    return;
  }
  for (std::size_t i = 0; i < arm_->joint_count(); ++i) {
    check_drive(network, i, began);
    if (joints_.valid) check_joint(i, began);
  }
  if (joints_.valid) check_workspace(tool_m, began);
}

void Watch::check_bus(const canopen::Network& network, Time now, FaultArbiter& began) {
  const canopen::IoModule& io = network.io();
  raise(io.seen() && io.fresh(now) && !io.estop_closed(), 0, {Fault::estop}, began);
  raise(network.bus_off(), 0, {Fault::bus_off}, began);
  // Before the boot the bus is not this master's.
  const bool ours = network.boot().state != canopen::BootState::idle;
  for (std::size_t i = 0; i < canopen::ForeignFrames::slots; ++i) {
    const auto& sender = network.foreign()[i];
    raise(ours && sender.frames != foreign_[i].frames, i, {Fault::second_master, static_cast<std::int32_t>(sender.id)}, began);
  }
  foreign_ = network.foreign();
}

// While drives are being enabled an old latched silence is being reset: only the data themselves count then.
void Watch::check_nodes(const canopen::Network& network, Vigilance vigilance, Time now, FaultArbiter& began) {
  const canopen::IoModule& io = network.io();
  const canopen::NodeFault& io_link = network.fault(network.io_index());
  const bool io_failed = io_link.heartbeat_lost || (io_link.emcy_active && io_link.error_register != 0);
  const auto io_code = static_cast<std::int32_t>(network.io_index());
  const bool io_silent = io.seen() && !io.fresh(now);
  raise(io_failed || io_silent, 0, {Fault::io_lost, io_code, io_link.emcy_code}, began);
  for (std::size_t node = 0; node < network.node_count(); ++node) {
    const canopen::NodeFault& link = network.fault(node);
    const auto code = static_cast<std::int32_t>(node);
    if (node < network.drive_count()) {
      const canopen::Axis& axis = network.axis(node);
      raise(link.heartbeat_lost, node, {Fault::node_lost, code, link.emcy_code}, began);
      const bool latched = vigilance == Vigilance::joints && axis.fault() == canopen::AxisFault::stale;
      const bool stale = latched || !joints_.fresh[node];
      raise(axis.seen() && stale, node, {Fault::stale_position, code}, began);
    }
    raise(link.rebooted || link.left_operational, node, {Fault::node_rebooted, code, link.emcy_code}, began);
  }
}

// The EMCY may come before the statusword, or after it.
void Watch::check_drive(const canopen::Network& network, std::size_t joint, FaultArbiter& began) {
  using canopen::AxisFault;
  const AxisFault fault = network.axis(joint).fault();
  const canopen::NodeFault& link = network.fault(joint);
  const auto code = static_cast<std::int32_t>(joint);
  raise(fault == AxisFault::following_error || stuck_[joint], joint, {Fault::following_error, code, link.emcy_code}, began);
  const bool others = fault == AxisFault::following_error || fault == AxisFault::stale || fault == AxisFault::node_lost;
  const bool complains = link.emcy_active && link.error_register != 0;
  raise((fault != AxisFault::none && !others) || complains, joint, {Fault::drive_fault, code, link.emcy_code}, began);
}

// Others are still being enabled, or homed. An error that was latched before this one took power is being reset.
void Watch::check_standing(const canopen::Network& network, std::size_t joint, FaultArbiter& began) {
  const canopen::Axis& axis = network.axis(joint);
  const bool stands = axis.requested() == canopen::AxisRequest::hold_enabled;
  stood_[joint] = stands && (stood_[joint] || axis.enabled());
  if (!stood_[joint]) return;
  const auto code = static_cast<std::int32_t>(joint);
  const bool left = axis.fault() == canopen::AxisFault::following_error;
  raise(left, joint, {Fault::following_error, code, network.fault(joint).emcy_code}, began);
  if (joints_.valid) check_speed(joint, began);
}

void Watch::check_speed(std::size_t joint, FaultArbiter& began) {
  const bool too_fast = std::abs(joints_.velocity_rad_s[joint]) > limits_.joints[joint].max_speed_rad_s * speed_tolerance;
  raise(too_fast, joint, {Fault::overspeed, static_cast<std::int32_t>(joint)}, began);
}

void Watch::check_joint(std::size_t joint, FaultArbiter& began) {
  const auto code = static_cast<std::int32_t>(joint);
  const JointLimit& limit = limits_.joints[joint];
  tolerated_rad_[joint] = std::min(tolerated_rad_[joint], excursion_rad(joint));
  raise(excursion_rad(joint) > tolerated_rad_[joint] + position_tolerance_rad, joint, {Fault::joint_limit, code}, began);
  check_speed(joint, began);
  overload_ticks_[joint] = at_least_nm(joint) > limit.max_torque_nm ? overload_ticks_[joint] + 1 : 0;
  raise(overload_ticks_[joint] > overload_ticks, joint, {Fault::overload, code}, began);
}

void Watch::check_workspace(const Vec3& tool_m, FaultArbiter& began) {
  const double excursion_m = workspace_excursion_m(limits_, tool_m);
  if (tolerating_ && !std::isfinite(tolerated_m_)) tolerated_m_ = excursion_m;
  tolerated_m_ = tolerating_ ? std::min(tolerated_m_, excursion_m) : 0;
  tool_outside_ = excursion_m > workspace_tolerance_m;
  raise(excursion_m > tolerated_m_ + workspace_tolerance_m, 0, {Fault::workspace}, began);
}

}  // namespace lf::safety
