#include "firmware/mission/motion.hpp"

#include <algorithm>
#include <array>

#include "firmware/mission/workspace_way.hpp"

namespace lf::mission {

namespace {

constexpr int line_checks_a_share = 16, pointed_checks_a_share = 6;  // an arm that points takes 5 us a check
// From full speed to rest and back: 0.42 rad/s of the slew in half a second are 0.84 rad/s^2, within the joints' own accelerations.
constexpr double hold_ramp_s = 0.5;

}  // namespace

arm::JointLimits Motion::limits(double speed_fraction) const {
  arm::JointLimits limits = arm_.limits(0, speed_fraction);
  for (std::size_t i = 0; i < limits.joints; ++i) {
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
  ++begun_;
  kind_ = kind;
  failure_ = StepFailure::none;
  holding_ = false;
  rate_ = 1;
  t_s_ = 0;
  duration_s_ = duration_s;
}

void Motion::refuse(StepFailure failure) {
  begin(Kind::rest, 0);
  failure_ = failure;
}

void Motion::go(std::span<const arm::JointVector> points_rad, double speed_fraction) {
  if (path_.plan(target_.q_rad, points_rad, limits(speed_fraction)) != arm::PlanOutcome::ok) return refuse(StepFailure::unreachable);
  begin(Kind::path, path_.duration_s());
}

void Motion::begin_way(const Room& room, double jaw_rad) {
  surroundings_.enter(room);
  way_.begin(target_.q_rad, surroundings_, wanted_from(target_.q_rad, jaw_rad, surroundings_), wanted_everywhere);
}

void Motion::advance_way(Kind then, double duration_s) {
  const arm::ClearWay::State way = way_.advance(surroundings_, ClearRoute::poses_a_share);
  if (way == arm::ClearWay::State::looking) return;
  if (way == arm::ClearWay::State::blocked) return refuse(failure_of(way_.barrier()));
  begin(then, duration_s);
}

void Motion::jog(const arm::JointVector& goal_rad, const Room& room, double jaw_rad, double speed_fraction) {
  arm::JointLimits widened = limits(speed_fraction);
  widened.lower_rad = widened.lower_rad.cwiseMin(target_.q_rad);
  widened.upper_rad = widened.upper_rad.cwiseMax(target_.q_rad);
  if (path_.plan(target_.q_rad, std::array{goal_rad}, widened) != arm::PlanOutcome::ok) return refuse(StepFailure::unreachable);
  begin_way(room, jaw_rad);
  way_.add(goal_rad);
  begin(Kind::look_at_jog, 0);
}

void Motion::go_clear(const arm::JointVector& goal_rad, const Room& room, double jaw_rad, double speed_fraction) {
  surroundings_.enter(room);
  jaw_rad_ = jaw_rad;
  speed_fraction_ = speed_fraction;
  plan_route(goal_rad);
}

void Motion::plan_route(const arm::JointVector& goal_rad) {
  route_.begin(target_.q_rad, goal_rad, jaw_rad_, surroundings_);
  begin(Kind::plan_route, 0);
}

void Motion::advance_route() {
  switch (route_.advance(surroundings_, limits_)) {
    case ClearRoute::State::looking: return;
    case ClearRoute::State::found: return go(route_.points_rad(), speed_fraction_);
    case ClearRoute::State::none: return refuse(failure_of(route_.barrier()));
  }
}

void Motion::line(const Vec3& goal_m, double goal_roll_rad, const Room& room, double jaw_rad, double speed_m_s, double push_n) {
  arm::LineLimits line;
  line.speed_m_s = speed_m_s;
  line.push_n = push_n;
  line_.begin(arm_, target_.q_rad, goal_m, goal_roll_rad, line, limits(1));
  begin_way(room, jaw_rad);
  begin(Kind::plan_line, 0);
}

// The line is looked at from check to check: 1.25 mm of 80 are as good as straight in joint space.
void Motion::advance_line() {
  const int looked_before = way_.poses();
  const int most_checks = arm_.is_planar() ? line_checks_a_share : pointed_checks_a_share;
  for (int checks = 0; checks < most_checks && way_.poses() - looked_before < ClearRoute::poses_a_share; ++checks) {
    const arm::ClearWay::State way = way_.advance(surroundings_, ClearRoute::poses_a_share + looked_before - way_.poses());
    if (way == arm::ClearWay::State::blocked) return refuse(failure_of(way_.barrier()));
    if (way == arm::ClearWay::State::looking) return;
    const bool planned = line_.planned();
    if (planned && line_.result().outcome != arm::PlanOutcome::ok) return refuse(StepFailure::unreachable);
    if (planned) return begin(Kind::line, line_.duration_s());
    if (!line_.advance(1) || line_.result().outcome == arm::PlanOutcome::ok) way_.add(line_.checked_rad());
  }
}

void Motion::go_to_sweep(const scan::SweepRequest& request, const LaserCalibration& laser, const Room& room, double jaw_rad,
                         double speed_fraction) {
  surroundings_.enter(room);
  jaw_rad_ = jaw_rad;
  speed_fraction_ = speed_fraction;
  sweep_planner_.begin(arm_, request, laser, target_.q_rad);
  begin(Kind::plan_sweep, 0);
}

void Motion::advance_sweep() {
  if (!sweep_planner_.advance(surroundings_)) return;
  const scan::SweepPlan& plan = sweep_planner_.plan();
  if (plan.outcome != scan::SweepOutcome::ok) return refuse(StepFailure::unreachable);
  const auto joints = [](const PerArmJoint<double>& q) { return arm::JointVector(q.data()); };
  const arm::PlanOutcome outcome = sweep_.plan(joints(plan.start_rad), joints(plan.end_rad), plan.duration.s(), limits(1));
  if (outcome != arm::PlanOutcome::ok || !keeps_to_workspace(arm_, limits_, joints(plan.start_rad), joints(plan.end_rad)))
    return refuse(StepFailure::unreachable);
  way_.begin(sweep_.start_rad(), surroundings_, wanted_everywhere);
  way_.add(sweep_.sample(sweep_.duration_s()).q_rad);
  begin(Kind::look_at_sweep, 0);
}

// The sweep itself first, then the way to its start.
void Motion::advance_sweep_way() {
  const arm::ClearWay::State way = way_.advance(surroundings_, ClearRoute::poses_a_share);
  if (way == arm::ClearWay::State::looking) return;
  if (way == arm::ClearWay::State::blocked) return refuse(failure_of(way_.barrier()));
  plan_route(sweep_.start_rad());
}

void Motion::sweep() { begin(Kind::sweep, sweep_.duration_s()); }

void Motion::turn(double from_rad, double to_rad, const Room& room, double jaw_rad, double speed_rad_s,
                  const arm::JointVector& pushed_rad) {
  if (!arm_.rolls()) return refuse(StepFailure::unreachable);  // such a task is refused before
  const arm::JointLimits limits = this->limits(1);
  const std::size_t roll = arm_.roll_joint();
  BarTurn::Limits bar;
  bar.speed_rad_s = std::min(speed_rad_s, limits.velocity_rad_s[static_cast<Eigen::Index>(roll)]);
  if (!turn_.plan(arm_, target_.q_rad, room.base_from_panel.linear(), from_rad, to_rad, bar, limits.lower_rad[roll],
                  limits.upper_rad[roll])) {
    return refuse(StepFailure::unreachable);
  }
  // The tool stays where it is: what is near stays near.
  surroundings_.enter(room);
  const arm::JointVector here_rad = target_.q_rad + pushed_rad;
  way_.begin(here_rad, surroundings_, wanted_from(here_rad, jaw_rad, surroundings_));
  way_.add(turn_.goal_rad() + pushed_rad);
  begin(Kind::look_at_turn, 0);
}

void Motion::stop() {
  if (kind_ == Kind::rest || planning()) return freeze();
  stop_ = arm::JointStop(target_, limits(1));
  begin(Kind::stop, stop_.duration_s());
}

void Motion::freeze() {
  kind_ = Kind::rest;
  failure_ = StepFailure::none;
  holding_ = false;
  rate_ = 1;
  target_.qd_rad_s.setZero();
  target_.qdd_rad_s2.setZero();
}

// Held, a plan waits: the motion that it leads to must not begin.
void Motion::advance_plan() {
  rate_ = holding_ ? 0 : 1;
  if (holding_) return;
  switch (kind_) {
    case Kind::plan_route: return advance_route();
    case Kind::plan_line: return advance_line();
    case Kind::plan_sweep: return advance_sweep();
    case Kind::look_at_sweep: return advance_sweep_way();
    case Kind::look_at_jog: return advance_way(Kind::path, path_.duration_s());
    case Kind::look_at_turn: return advance_way(Kind::turn, turn_.duration_s());
    default: return;
  }
}

void Motion::step(double dt_s) {
  if (planning()) return advance_plan();
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
    default: break;
  }
  // Chain rule of q(t(clock)); what the change of the rate adds is left out of the acceleration: it is what a stop from here would take off.
  target_.qd_rad_s *= rate_;
  target_.qdd_rad_s2 *= rate_ * rate_;
  if (t_s_ >= duration_s_) freeze();
}

}  // namespace lf::mission
