#include "firmware/arm/compliance.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {

void Compliance::update(Time t, const JointTorques& torque) {
  if (!torque.finite() || (samples_ > 0 && t <= last_)) {
    ++refused_;
    return;
  }
  const double dt_s = samples_ > 0 ? std::min((t - last_).s(), config_.largest_step_s) : 0;
  last_ = t;
  ++samples_;
  if (samples_ == 1) filtered_ = torque;
  filtered_.follow(torque, dt_s / (dt_s + config_.filter_s));
  if (samples_ <= config_.learning) {
    baseline_nm_ += (torque.nm - baseline_nm_) / samples_;
    return;
  }
  for (Eigen::Index i = 0; i < offset_rad_.size(); ++i) {
    const double excess_nm = filtered_.sure_excess_nm(i, baseline_nm_[i]);
    const double push_nm = std::copysign(std::max(0.0, std::abs(excess_nm) - config_.dead_nm), excess_nm);
    // The drive holds against the push: the joint gives way against the drive's torque.
    const double speed_rad_s = std::clamp(-config_.give_rad_s_nm[i] * push_nm, -config_.largest_rad_s, config_.largest_rad_s);
    offset_rad_[i] = std::clamp(offset_rad_[i] + speed_rad_s * dt_s, -config_.largest_rad, config_.largest_rad);
  }
}

}  // namespace lf::arm
