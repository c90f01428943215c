#include "firmware/mission/motion.hpp"

#include <algorithm>

namespace lf::mission {

namespace {

// From full speed to rest and back: 0.42 rad/s of the slew in half a second are 0.84 rad/s^2, within the joints' own accelerations.
constexpr double hold_ramp_s = 0.5;

}  // namespace

arm::JointLimits Motion::limits(double speed_fraction) const {
  arm::JointLimits limits = arm::joint_limits(0, speed_fraction);
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    limits.lower_rad[k] = std::max(limits.lower_rad[k], limits_.joints[i].min_rad);
    limits.upper_rad[k] = std::min(limits.upper_rad[k], limits_.joints[i].max_rad);
    limits.velocity_rad_s[k] = std::min(limits.velocity_rad_s[k], limits_.joints[i].max_speed_rad_s * speed_fraction);
  }
  return limits;
}

void Motion::start_at(const arm::JointVector& q_rad) {
  target_ = arm::JointState{};
  target_.q_rad = q_rad;
  kind_ = Kind::rest;
}

void Motion::begin(Kind kind, double duration_s) {
  kind_ = kind;
  holding_ = false;
  rate_ = 1;
  t_s_ = 0;
  duration_s_ = duration_s;
}

bool Motion::go(std::span<const arm::JointVector> points_rad, double speed_fraction) {
  if (path_.plan(target_.q_rad, points_rad, limits(speed_fraction)) != arm::PlanOutcome::ok) return false;
  begin(Kind::path, path_.duration_s());
  return true;
}

bool Motion::line(const Vec3& goal_m, double goal_roll_rad, double speed_m_s) {
  arm::LineLimits line;
  line.speed_m_s = speed_m_s;
  if (line_.plan(target_.q_rad, goal_m, goal_roll_rad, line, limits(1)).outcome != arm::PlanOutcome::ok) return false;
  begin(Kind::line, line_.duration_s());
  return true;
}

bool Motion::plan_sweep(const scan::SweepPlan& plan) {
  if (plan.outcome != scan::SweepOutcome::ok) return false;
  arm::JointVector from = target_.q_rad;
  arm::JointVector to = target_.q_rad;
  for (std::size_t i = 0; i < arm_joint_count; ++i) {
    from[static_cast<Eigen::Index>(i)] = plan.start_rad[i];
    to[static_cast<Eigen::Index>(i)] = plan.end_rad[i];
  }
  return sweep_.plan(from, to, plan.duration.s(), limits(1)) == arm::PlanOutcome::ok;
}

bool Motion::sweep() {
  begin(Kind::sweep, sweep_.duration_s());
  return true;
}

bool Motion::turn(const Mat3& base_from_panel, double from_rad, double to_rad, double speed_rad_s) {
  const arm::JointLimits limits = this->limits(1);
  BarTurn::Limits bar;
  bar.speed_rad_s = speed_rad_s;
  if (!turn_.plan(target_.q_rad, base_from_panel, from_rad, to_rad, bar, limits.lower_rad[3], limits.upper_rad[3])) return false;
  begin(Kind::turn, turn_.duration_s());
  return true;
}

void Motion::stop() {
  if (kind_ == Kind::rest) return;
  stop_ = arm::JointStop(target_, limits(1));
  begin(Kind::stop, stop_.duration_s());
}

void Motion::freeze() {
  kind_ = Kind::rest;
  holding_ = false;
  rate_ = 1;
  target_.qd_rad_s.setZero();
  target_.qdd_rad_s2.setZero();
}

void Motion::step(double dt_s) {
  if (kind_ == Kind::rest) return;
  const double rate_before = rate_;
  const double rate_change = dt_s / hold_ramp_s;
  rate_ = holding_ ? std::max(0.0, rate_ - rate_change) : std::min(1.0, rate_ + rate_change);
  t_s_ += dt_s * 0.5 * (rate_before + rate_);
  switch (kind_) {
    case Kind::path: target_ = path_.sample(t_s_); break;
    case Kind::line: target_ = line_.sample(t_s_); break;
    case Kind::sweep: target_ = sweep_.sample(t_s_); break;
    case Kind::turn: target_.q_rad = turn_.sample(t_s_); break;
    case Kind::stop: target_ = stop_.sample(t_s_); break;
    case Kind::rest: break;
  }
  // Chain rule of q(t(clock)); what the change of the rate adds is left out of the acceleration: it is what a stop from here would take off.
  target_.qd_rad_s *= rate_;
  target_.qdd_rad_s2 *= rate_ * rate_;
  if (t_s_ >= duration_s_) freeze();
}

}  // namespace lf::mission
