#include "firmware/mission/bar_turn.hpp"

#include <cmath>
#include <limits>

namespace lf::mission {

double BarTurn::roll_at(double handle_rad, double near_rad) const {
  const Vec3 bar = base_from_panel_ * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  const std::optional<arm::BarRolls> rolls = arm::rolls_for_bar(*arm_, q_rad_, bar);
  if (!rolls) return std::numeric_limits<double>::quiet_NaN();
  return near_rad + wrap(rolls->roll_rad[0] - near_rad, pi / 2);
}

bool BarTurn::plan(const arm::Arm& arm, const arm::JointVector& start_rad, const Mat3& base_from_panel, double from_rad, double to_rad,
                   const Limits& limits, double roll_min_rad, double roll_max_rad) {
  arm_ = &arm;
  q_rad_ = start_rad;
  base_from_panel_ = base_from_panel;
  from_rad_ = from_rad;
  direction_ = to_rad < from_rad ? -1 : 1;
  if (!curve_.plan(std::abs(to_rad - from_rad), limits.speed_rad_s, limits.acceleration_rad_s2, limits.jerk_rad_s3)) return false;
  constexpr int checks = 64;  // a turn of 130 degrees in steps of 2: the roll's nearest branch cannot be missed
  double roll = start_rad[arm.roll_joint()];
  for (int i = 0; i <= checks; ++i) {
    roll = roll_at(from_rad + (to_rad - from_rad) * i / checks, roll);
    if (!(roll >= roll_min_rad && roll <= roll_max_rad)) return false;
  }
  goal_rad_ = start_rad;
  goal_rad_[arm.roll_joint()] = roll;
  return true;
}

double BarTurn::handle_rad(double t_s) const { return from_rad_ + direction_ * curve_.sample(t_s).position; }

arm::JointVector BarTurn::sample(double t_s) {
  double& roll = q_rad_[arm_->roll_joint()];
  if (const double next = roll_at(handle_rad(t_s), roll); std::isfinite(next)) roll = next;
  return q_rad_;
}

}  // namespace lf::mission
