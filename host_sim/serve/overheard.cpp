#include "host_sim/serve/overheard.hpp"

#include <algorithm>

#include "firmware/arm/actuator.hpp"
#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"
#include "shared/can/can_map.hpp"

namespace lf::serve {

namespace {

constexpr double gain_per_s = 20;      // of the drives' own position loops: what is behind the motor, the joint's compliance, takes no more
constexpr double new_share = 0.2;      // of the newest difference in the speed: 16 ms of smoothing
constexpr double longest_gap_s = 0.1;  // reports further apart say nothing of the speed

}  // namespace

void OverheardDrives::hear(const CanFrame& frame, Time t) {
  if (frame.length < can_map::drive_tpdo1::length) return;
  for (std::size_t i = 0; i < can_map::drive_nodes.size(); ++i) {
    if (frame.id != canopen::cob_id::tpdo1 + can_map::drive_nodes[i]) continue;
    Report& report = reports_[i];
    const std::int64_t counts = std::int64_t{canopen::get<std::int32_t>(frame, can_map::drive_tpdo1::position)} - zero_counts_[i];
    const double position = arm::rad_from_counts(arm_.joints[i], static_cast<std::int32_t>(counts));
    const double gap_s = (t - report.t).s();
    if (report.heard && gap_s > 0 && gap_s < longest_gap_s) {
      report.velocity_rad_s += new_share * ((position - report.position_rad) / gap_s - report.velocity_rad_s);
    } else {
      report.velocity_rad_s = 0;
    }
    report.position_rad = position;
    report.t = t;
    report.heard = true;
  }
}

std::optional<double> OverheardDrives::position_rad(std::size_t joint) const {
  if (!reports_[joint].heard) return std::nullopt;
  return reports_[joint].position_rad;
}

JointDrive OverheardDrives::follow(std::size_t joint, double motor_rad) const {
  const ArmModel::Joint& numbers = arm_.joints[joint];
  const Report& report = reports_[joint];
  JointDrive drive;
  drive.torque_limit_nm = numbers.effort_nm;
  if (!report.heard) return drive;
  const double wanted = report.velocity_rad_s + gain_per_s * (report.position_rad - motor_rad);
  drive.velocity_rad_s = std::clamp(wanted, -numbers.velocity_rad_s, numbers.velocity_rad_s);
  return drive;
}

void OverheardOutputs::hear(const CanFrame& frame, Time t) {
  using canopen::get;
  if (frame.id == canopen::cob_id::sync) return on_sync(t);
  if (frame.id == canopen::cob_id::tpdo1 + can_map::io_node && frame.length >= can_map::io_tpdo1::length) {
    interlock_closed_ = (get<std::uint8_t>(frame, can_map::io_tpdo1::inputs) & can_map::input_interlock_closed) != 0;
    if (!known_) last_counter_ = get<std::uint8_t>(frame, can_map::io_tpdo1::last_trigger_counter);
    known_ = true;
  }
  if (frame.id == canopen::cob_id::rpdo1 + can_map::io_node && frame.length >= can_map::io_rpdo1::length) {
    outputs_ = get<std::uint8_t>(frame, can_map::io_rpdo1::outputs);
    counter_ = get<std::uint8_t>(frame, can_map::io_rpdo1::trigger_counter);
    exposure_us_ = get<std::uint16_t>(frame, can_map::io_rpdo1::exposure);
    asked_ = true;
  }
}

void OverheardOutputs::on_sync(Time t) {
  if (!known_ || !asked_) return;
  asked_ = false;
  if (counter_ == last_counter_) return;
  last_counter_ = counter_;
  if (exposure_us_ == 0) return;
  exposures_.push_back({t, Duration::from_us(exposure_us_), counter_, laser_on(), lamps_on()});
}

bool OverheardOutputs::laser_on() const { return (outputs_ & can_map::output_laser) != 0 && interlock_closed_; }
bool OverheardOutputs::lamps_on() const { return (outputs_ & can_map::output_lamps) != 0; }

std::optional<devices::Exposure> OverheardOutputs::take_exposure() {
  if (exposures_.empty()) return std::nullopt;
  const devices::Exposure oldest = exposures_.front();
  exposures_.erase(exposures_.begin());
  return oldest;
}

}  // namespace lf::serve
