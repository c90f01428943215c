#include "host_sim/devices/drive/gear_train.hpp"

#include <algorithm>
#include <cmath>

namespace lf::devices {

namespace {

constexpr double rounding = 1e-9;

}  // namespace

void GearTrain::reset() { load_nm_ = speed_rad_s_ = held_nm_ = 0; }

double GearTrain::coulomb_nm(double way, double motor_rad_s) const {
  const double slowness = motor_rad_s / stribeck_rad_s;
  return friction_.coulomb_nm * (1 + way * friction_.one_way) * (1 + (friction_.breakaway - 1) * std::exp(-slowness * slowness));
}

double GearTrain::turning_nm(double way, double load_nm) const {
  const bool raises = way * load_nm >= 0;
  return way * coulomb_nm(way, speed_rad_s_) + load_nm * (raises ? 1 / friction_.efficiency : friction_.back_efficiency);
}

double GearTrain::step(double joint_nm, double motor_rad_s, double ratio, double dt_s, double wound_nm) {
  const double share = std::min(1.0, dt_s / smoothing_s);
  load_nm_ += (joint_nm / ratio - load_nm_) * share;
  speed_rad_s_ += (motor_rad_s - speed_rad_s_) * share;
  const double forward_nm = turning_nm(1, load_nm_), backward_nm = turning_nm(-1, load_nm_);
  if (std::abs(speed_rad_s_) >= standing_rad_s) {
    held_nm_ = speed_rad_s_ > 0 ? forward_nm : backward_nm;
  } else {
    // A gear without friction has both equal, but for rounding.
    held_nm_ = std::max(std::min(held_nm_ + wound_nm, std::max(forward_nm, backward_nm)), std::min(forward_nm, backward_nm));
  }
  return held_nm_ + friction_.viscous_nm_s * speed_rad_s_;
}

bool GearTrain::breaks_away(double way, double limit_nm) const {
  const double turning = turning_nm(way, load_nm_);
  return std::abs(turning) <= limit_nm && way * held_nm_ >= way * turning - rounding * (std::abs(turning) + friction_.coulomb_nm);
}

double GearTrain::push_nm(double motor_nm, double motor_rad_s, double ratio) const {
  const double rubbing_nm = coulomb_nm(motor_rad_s < 0 ? -1 : 1, motor_rad_s) + friction_.viscous_nm_s * std::abs(motor_rad_s);
  return ratio * friction_.efficiency * std::max(0.0, motor_nm - rubbing_nm);
}

double GearTrain::hold_nm(double motor_nm, double ratio) const {
  if (friction_.back_efficiency <= 0) return breaking_nm;
  return std::min(breaking_nm, ratio * (motor_nm + std::min(coulomb_nm(1, 0), coulomb_nm(-1, 0))) / friction_.back_efficiency);
}

}  // namespace lf::devices
