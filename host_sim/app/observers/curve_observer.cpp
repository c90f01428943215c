#include "host_sim/app/observers/curve_observer.hpp"

#include <string>

#include "shared/can/can_map.hpp"

namespace lf::app {

CurveObserver::CurveObserver(RunFiles& files, const BusObserver& bus, const JointNames& joints)
    : files_(files), bus_(bus), joints_(joints) {
  if (files_.wanted()) joint_log_.emplace(files_.path("joints.csv"), joints);
}

void CurveObserver::on_telemetry(const Telemetry& telemetry) {
  if (ticks_++ % ticks_a_sample != 0) return;
  if (joint_log_ && !joint_log_->write(telemetry)) files_.lost(joint_log_->sink().error());
  t_s_.push_back(telemetry.t.s());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const auto known = [&](double value) { return telemetry.joints_valid ? value : record::unknown; };
    target_rad_[i].push_back(known(telemetry.target_rad[i]));
    actual_rad_[i].push_back(known(telemetry.actual_rad[i]));
    torque_nm_[i].push_back(known(telemetry.torque_nm[i]));
  }
  const double window_s = ticks_a_sample * can_map::sync_period.s();
  bus_load_percent_.push_back(100.0 * static_cast<double>(bus_.bits() - bits_before_) / (window_s * can_map::bitrate));
  bits_before_ = bus_.bits();
}

void CurveObserver::finish() {
  if (joint_log_ && !joint_log_->close()) files_.lost(joint_log_->sink().error());
}

std::vector<record::ReportChart> CurveObserver::joint_charts(const safety::Limits& limits) const {
  record::ReportChart positions{"Joint positions, measured and asked", "rad", {}},
      torques{"Motor torques at the joints, measured", "N m", {}};
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const safety::JointLimit& limit = limits.joints[i];
    positions.series.push_back({joints_[i], t_s_, actual_rad_[i], false, {limit.min_rad, limit.max_rad}});
    positions.series.push_back({joints_[i] + ", asked", t_s_, target_rad_[i], true});
    torques.series.push_back({joints_[i], t_s_, torque_nm_[i], false, {-limit.max_torque_nm, limit.max_torque_nm}});
  }
  return {positions, torques};
}

record::ReportChart CurveObserver::bus_chart() const {
  return {"Bus load, stuff bits included", "%", {{"can0", t_s_, bus_load_percent_, false}}};
}

}  // namespace lf::app
