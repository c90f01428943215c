#include "firmware/safety/watch.hpp"

#include <algorithm>
#include <cmath>

namespace lf::safety {

namespace {

// Limits are held against noise: one wrist count is 0.003 rad, and the observer overshoots by a tenth at the end of a move.
constexpr double position_tolerance_rad = 0.01;
constexpr double speed_tolerance = 1.25;
// The tool's box is a coarse fence; calibration and quantisation are worth a millimetre.
constexpr double workspace_tolerance_m = 0.002;
// A torque over its limit has to last: breakaway peaks of a gear last some milliseconds.
constexpr int overload_ticks = 25;  // 100 ms

}  // namespace

void Watch::observe(const canopen::Network& network, const std::array<double, joint_count>& rad, Time now) {
  joints_.valid = true;
  Time newest;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const canopen::Axis& axis = network.axis(static_cast<Joint>(i));
    joints_.fresh[i] = axis.fresh(now) && std::isfinite(rad[i]);
    joints_.valid = joints_.valid && joints_.fresh[i];
    if (axis.actual_time() > newest) newest = axis.actual_time();
  }
  if (!joints_.valid) return;
  const double dt_s = (newest - joints_.t).s();
  for (std::size_t i = 0; i < joint_count; ++i) {
    const canopen::Axis& axis = network.axis(static_cast<Joint>(i));
    if (!observing_ || dt_s > 0.1) {
      observers_[i].reset(rad[i]);
    } else if (dt_s > 0) {
      observers_[i].update(rad[i], dt_s);
    }
    joints_.position_rad[i] = rad[i];
    joints_.velocity_rad_s[i] = observers_[i].velocity_rad_s();
    joints_.torque_nm[i] = axis.torque_permille() * 1e-3 * axis.rated_torque_mnm() * 1e-3;
  }
  joints_.t = newest;
  observing_ = true;
}

double Watch::excursion_rad(std::size_t joint) const {
  const double q = joints_.position_rad[joint];
  return std::max({0.0, limits_.joints[joint].min_rad - q, q - limits_.joints[joint].max_rad});
}

bool Watch::outside(std::size_t joint) const { return excursion_rad(joint) > position_tolerance_rad; }

bool Watch::any_outside() const {
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (outside(i)) return true;
  }
  return false;
}

void Watch::bear_outside(bool bear) {
  for (std::size_t i = 0; i < joint_count; ++i) borne_rad_[i] = bear ? excursion_rad(i) : 0;
}

void Watch::raise(bool present, Fault fault, std::int32_t code, FaultReports& began) {
  std::uint8_t& known = present_[static_cast<std::size_t>(fault)];
  const auto bit = static_cast<std::uint8_t>(1u << (static_cast<unsigned>(code) & 7u));
  if (present && (known & bit) == 0 && !began.push_back({fault, code})) return;
  known = static_cast<std::uint8_t>(present ? known | bit : known & ~bit);
}

void Watch::check(const canopen::Network& network, const Vec3& tool_m, bool armed, Time now, FaultReports& began) {
  const canopen::IoModule& io = network.io();
  raise(io.seen() && io.fresh(now) && !io.estop_closed(), Fault::estop, 0, began);
  raise(network.bus_off(), Fault::bus_off, 0, began);
  if (!armed) return;
  raise(!io.fresh(now), Fault::io_lost, 0, began);
  for (std::size_t node = 0; node < canopen::Network::node_count; ++node) {
    const canopen::NodeFault& link = network.fault(node);
    const bool drive = node < joint_count;
    raise(link.heartbeat_lost, drive ? Fault::node_lost : Fault::io_lost, static_cast<std::int32_t>(node), began);
    raise(link.rebooted || link.left_operational, Fault::node_rebooted, static_cast<std::int32_t>(node), began);
  }
  for (std::size_t i = 0; i < joint_count; ++i) {
    const auto code = static_cast<std::int32_t>(i);
    const canopen::Axis& axis = network.axis(static_cast<Joint>(i));
    const canopen::AxisFault fault = axis.fault();
    using canopen::AxisFault;
    raise(fault == AxisFault::following_error, Fault::following_error, code, began);
    raise(fault == AxisFault::stale || !joints_.fresh[i], Fault::stale_position, code, began);
    raise(fault != AxisFault::none && fault != AxisFault::following_error && fault != AxisFault::stale && fault != AxisFault::node_lost,
          Fault::drive_fault, code, began);
    if (!joints_.valid) continue;
    const JointLimit& limit = limits_.joints[i];
    borne_rad_[i] = std::min(borne_rad_[i], excursion_rad(i));
    raise(excursion_rad(i) > borne_rad_[i] + position_tolerance_rad, Fault::joint_limit, code, began);
    raise(std::abs(joints_.velocity_rad_s[i]) > limit.max_speed_rad_s * speed_tolerance, Fault::overspeed, code, began);
    overload_ticks_[i] = std::abs(joints_.torque_nm[i]) > limit.max_torque_nm ? overload_ticks_[i] + 1 : 0;
    raise(overload_ticks_[i] > overload_ticks, Fault::overload, code, began);
  }
  bool outside = !tool_m.allFinite();
  for (std::size_t axis = 0; axis < 3 && !outside; ++axis) {
    const double x = tool_m[static_cast<Eigen::Index>(axis)];
    outside = x < limits_.workspace_min_m[axis] - workspace_tolerance_m || x > limits_.workspace_max_m[axis] + workspace_tolerance_m;
  }
  raise(joints_.valid && outside, Fault::workspace, 0, began);
}

}  // namespace lf::safety
