#include "firmware/arm/trajectory.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

// The fastest travel of a fraction (0 to 1) during which no joint that moves by `way_rad` in all passes its limits.
bool plan_fraction(const JointVector& way_rad, const JointLimits& limits, SCurve& curve) {
  double longest = way_rad.cwiseAbs().maxCoeff();
  if (longest == 0) return curve.plan(0, 1, 1, 1);
  const JointVector way = way_rad.cwiseAbs() / longest;  // in radians of the joint that moves most, so that tiny ways divide nothing tiny
  double velocity = HUGE_VAL, acceleration = HUGE_VAL, jerk = HUGE_VAL;
  for (std::size_t i = 0; i < limits.joints; ++i) {
    if (way[i] == 0) continue;
    velocity = std::min(velocity, limits.velocity_rad_s[i] / way[i]);
    acceleration = std::min(acceleration, limits.acceleration_rad_s2[i] / way[i]);
    jerk = std::min(jerk, limits.jerk_rad_s3[i] / way[i]);
  }
  return curve.plan(1, velocity / longest, acceleration / longest, jerk / longest);
}

bool valid(const JointLimits& limits) {
  const auto joints = static_cast<Eigen::Index>(limits.joints);
  if (joints < 1 || joints > limits.velocity_rad_s.size()) return false;
  return limits.velocity_rad_s.allFinite() && limits.acceleration_rad_s2.allFinite() && limits.jerk_rad_s3.allFinite() &&
         limits.velocity_rad_s.head(joints).minCoeff() > 0 && limits.acceleration_rad_s2.head(joints).minCoeff() > 0 &&
         limits.jerk_rad_s3.head(joints).minCoeff() > 0 && limits.lower_rad.allFinite() && limits.upper_rad.allFinite();
}

// A position measured at a limit may lie past it by an encoder's tick: moving away from there must be possible.
bool inside(const JointVector& q_rad, const JointLimits& limits, double tolerance_rad = 1e-9) {
  return ((q_rad - limits.lower_rad).array() >= -tolerance_rad).all() && ((limits.upper_rad - q_rad).array() >= -tolerance_rad).all();
}

}  // namespace

PlanOutcome JointTrajectory::plan(const JointVector& start_rad, const JointVector& goal_rad, const JointLimits& limits) {
  start_rad_ = goal_rad_ = start_rad;
  curve_ = SCurve();
  if (!start_rad.allFinite() || !goal_rad.allFinite() || !valid(limits)) return PlanOutcome::not_a_number;
  if (!inside(goal_rad, limits)) return PlanOutcome::outside;
  if (!plan_fraction(goal_rad - start_rad, limits, curve_)) return PlanOutcome::not_a_number;
  goal_rad_ = goal_rad;
  return PlanOutcome::ok;
}

JointState JointTrajectory::sample(double t_s) const {
  const PathState s = curve_.sample(t_s);
  const JointVector way = goal_rad_ - start_rad_;
  if (t_s >= curve_.duration_s()) return {goal_rad_, JointVector::Zero(), JointVector::Zero()};
  return {start_rad_ + s.position * way, s.velocity * way, s.acceleration * way};
}

PlanOutcome JointPath::plan(const JointVector& start_rad, std::span<const JointVector> points_rad, const JointLimits& limits) {
  legs_.clear();
  duration_s_ = 0;
  if (points_rad.size() > max_points) return PlanOutcome::too_many;
  StaticVector<JointTrajectory, max_points> legs;
  double duration_s = 0;
  JointVector from = start_rad;
  for (const JointVector& to : points_rad) {
    JointTrajectory leg;
    const PlanOutcome outcome = leg.plan(from, to, limits);
    if (outcome != PlanOutcome::ok) return outcome;
    duration_s += leg.duration_s();
    (void)legs.push_back(leg);  // as many as fit, checked above
    from = to;
  }
  if (legs.empty()) {
    JointTrajectory stay;
    const PlanOutcome outcome = stay.plan(start_rad, start_rad, limits);
    if (outcome != PlanOutcome::ok) return outcome;
    (void)legs.push_back(stay);
  }
  legs_ = legs;
  duration_s_ = duration_s;
  return PlanOutcome::ok;
}

JointState JointPath::sample(double t_s) const {
  if (legs_.empty()) return {};
  double left = t_s;
  for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
    if (left < legs_[i].duration_s()) return legs_[i].sample(left);
    left -= legs_[i].duration_s();
  }
  return legs_.back().sample(left);
}

PlanOutcome ConstantSpeedSweep::plan(const JointVector& from_rad, const JointVector& to_rad, double cruise_s, const JointLimits& limits) {
  from_rad_ = to_rad_ = from_rad;
  cruise_s_ = ramp_s_ = jerk_time_s_ = 0;
  if (!from_rad.allFinite() || !to_rad.allFinite() || !std::isfinite(cruise_s) || cruise_s <= 0 || !valid(limits))
    return PlanOutcome::not_a_number;
  const JointVector speed = (to_rad - from_rad).cwiseAbs() / cruise_s;
  if (((limits.velocity_rad_s - speed).array() < 0).any()) return PlanOutcome::outside;
  // The ramp to full speed v with acceleration a and jerk j takes v/a + a/j, or 2 sqrt(v/j) when full acceleration is not reached.
  double jerk_time_s = 0;
  double ramp_s = 0;
  for (std::size_t i = 0; i < limits.joints; ++i) {
    jerk_time_s = std::max(jerk_time_s, limits.acceleration_rad_s2[i] / limits.jerk_rad_s3[i]);
    ramp_s = std::max({ramp_s, speed[i] / limits.acceleration_rad_s2[i], std::sqrt(speed[i] / limits.jerk_rad_s3[i])});
  }
  jerk_time_s = std::min(jerk_time_s, ramp_s);
  ramp_s += jerk_time_s;
  const JointVector run_up = (to_rad - from_rad) * (ramp_s / (2 * cruise_s));
  if (!inside(from_rad - run_up, limits) || !inside(to_rad + run_up, limits)) return PlanOutcome::outside;
  to_rad_ = to_rad;
  cruise_s_ = cruise_s;
  ramp_s_ = ramp_s;
  jerk_time_s_ = jerk_time_s;
  return PlanOutcome::ok;
}

PathState ConstantSpeedSweep::fraction(double t_s) const {
  if (cruise_s_ <= 0) return {};
  const double speed = 1 / cruise_s_;
  const bool backwards = t_s > duration_s() / 2;  // the second half mirrors the first
  const double t = std::max(0.0, backwards ? duration_s() - t_s : t_s);
  PathState state;
  if (t >= ramp_s_ || ramp_s_ == 0) {
    state = {(t - ramp_s_) * speed, speed, 0};
  } else {
    // The ramp is the first half of a motion that covers 2 x (speed ramp / 2) without cruising.
    const double tj = jerk_time_s_;
    const double jerk = speed / (tj * (ramp_s_ - tj));
    const double start = -speed * ramp_s_ / 2;
    const double rising = std::min(t, tj);
    const double steady = std::clamp(t - tj, 0.0, ramp_s_ - 2 * tj);
    const double falling = std::max(0.0, t - (ramp_s_ - tj));
    const double peak = jerk * rising;
    double velocity = peak * rising / 2;
    double position = start + peak * rising * rising / 6;
    position += steady * (velocity + peak * steady / 2);
    velocity += peak * steady;
    position += falling * (velocity + falling * (peak / 2 - jerk * falling / 6));
    velocity += falling * (peak - jerk * falling / 2);
    state = {position, velocity, peak - jerk * falling};
  }
  if (!backwards) return state;
  return {1 - state.position, state.velocity, -state.acceleration};
}

JointState ConstantSpeedSweep::sample(double t_s) const {
  const PathState s = fraction(t_s);
  const JointVector way = to_rad_ - from_rad_;
  return {from_rad_ + s.position * way, s.velocity * way, s.acceleration * way};
}

JointStop::JointStop(const JointState& from, const JointLimits& limits) {
  for (std::size_t i = 0; i < limits.joints; ++i) {
    PathState state{from.q_rad[i], from.qd_rad_s[i], from.qdd_rad_s2[i]};
    if (!std::isfinite(state.position)) state = {};
    if (!std::isfinite(state.velocity) || !std::isfinite(state.acceleration)) state = {state.position, 0, 0};
    // No motion is planned so fast: what says so is no speed of the arm.
    if (std::abs(state.velocity) > 2 * limits.velocity_rad_s[i]) state = {state.position, 0, 0};
    joints_[i] = StopCurve(state, limits.acceleration_rad_s2[i], limits.jerk_rad_s3[i]);
  }
}

double JointStop::duration_s() const {
  double longest = 0;
  for (const StopCurve& joint : joints_) longest = std::max(longest, joint.duration_s());
  return longest;
}

JointState JointStop::sample(double t_s) const {
  JointState state;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const PathState joint = joints_[i].sample(t_s);
    state.q_rad[i] = joint.position;
    state.qd_rad_s[i] = joint.velocity;
    state.qdd_rad_s2[i] = joint.acceleration;
  }
  return state;
}

}  // namespace lf::arm
