#include <algorithm>
#include <cmath>

#include "firmware/arm/trajectory.hpp"

namespace lf::arm {
namespace {

// Wide enough that no limit speaks: the line checks the caller's limits itself.
constexpr double no_limit_margin_rad = -0.5;

// Of a joint between two checks. 20 mm from the slew axis a check's 2 mm turn the slew by 0.1 rad.
constexpr double max_step_rad = 0.3;

// First and second derivative of the joints with respect to the fraction of the way, for a tool point that moves by `way_m` and a roll by `turn_rad` in all.
struct Rates {
  JointVector first = JointVector::Zero();
  JointVector second = JointVector::Zero();
};

Mat3 position_jacobian(const JointVector& q_rad) { return jacobian(q_rad).topLeftCorner<3, 3>(); }

Rates rates(const JointVector& q_rad, const Vec3& way_m, double turn_rad) {
  Rates rates;
  rates.first[3] = turn_rad;
  if (way_m.squaredNorm() == 0) return rates;
  const Mat3 inverse = position_jacobian(q_rad).inverse();
  rates.first.head<3>() = inverse * way_m;
  // J q' = way is constant, so J q'' = -J' q'. J' by a central difference along q'; a step of 1e-5 rad leaves 1e-10 of it.
  JointVector step = JointVector::Zero();
  step.head<3>() = rates.first.head<3>();
  const double scale = 1e-5 / step.norm();
  const Mat3 change = (position_jacobian(q_rad + scale * step) - position_jacobian(q_rad - scale * step)) / (2 * scale);
  rates.second.head<3>() = -inverse * (change * rates.first.head<3>());
  return rates;
}

IkOutcome limit_passed(const JointVector& q_rad, const JointLimits& limits) {
  constexpr std::array<IkOutcome, arm_joint_count> reasons{IkOutcome::slew_limit, IkOutcome::shoulder_limit, IkOutcome::elbow_limit,
                                                           IkOutcome::roll_limit};
  for (std::size_t i = 0; i < arm_joint_count; ++i)
    if (q_rad[i] < limits.lower_rad[i] - 1e-9 || q_rad[i] > limits.upper_rad[i] + 1e-9) return reasons[i];
  return IkOutcome::ok;
}

// The fraction's own limits, drawn in so that every joint keeps to its own: half of each acceleration for the path's, half for its curvature.
struct FractionLimits {
  double velocity = HUGE_VAL, acceleration = HUGE_VAL, jerk = HUGE_VAL;

  void respect(const Rates& rates, const JointLimits& limits) {
    for (std::size_t i = 0; i < arm_joint_count; ++i) {
      const double second = std::abs(rates.second[i]);
      // The largest within half a step of this check, to second order.
      const double first = std::abs(rates.first[i]) + second / (2 * CartesianLine::checks);
      if (first > 0) {
        velocity = std::min(velocity, limits.velocity_rad_s[i] / first);
        acceleration = std::min(acceleration, limits.acceleration_rad_s2[i] / (2 * first));
        jerk = std::min(jerk, limits.jerk_rad_s3[i] / first);
      }
      if (second > 0) velocity = std::min(velocity, std::sqrt(limits.acceleration_rad_s2[i] / (2 * second)));
    }
  }
};

}  // namespace

LinePlan CartesianLine::plan(const JointVector& start_rad, const Vec3& goal_m, double goal_roll_rad, const LineLimits& line,
                             const JointLimits& limits) {
  LinePlan result;
  start_rad_ = start_rad;
  goal_roll_rad_ = start_rad[3];
  curve_ = SCurve();
  if (!start_rad.allFinite()) return result;
  start_m_ = goal_m_ = base_from_tool(start_rad).translation();
  const Vec3 way = goal_m - start_m_;
  const double turn = goal_roll_rad - start_rad[3];
  if (!way.allFinite() || !std::isfinite(turn)) return result;

  FractionLimits fraction_limits;
  const double length = way.norm();
  if (length > 0) fraction_limits = {line.speed_m_s / length, line.acceleration_m_s2 / length, line.jerk_m_s3 / length};
  JointVector last_rad = start_rad;
  for (int i = 0; i <= checks; ++i) {
    const double fraction = static_cast<double>(i) / checks;
    const IkResult ik = inverse_kinematics(start_m_ + fraction * way, start_rad[3] + fraction * turn, no_limit_margin_rad);
    result.fraction = fraction;
    result.ik = ik.ok() ? limit_passed(ik.q_rad, limits) : ik.outcome;
    result.outcome = PlanOutcome::unreachable;
    // The start is where the arm is: a motion may lead back inside from there.
    if (result.ik != IkOutcome::ok && (i > 0 || !ik.ok())) return result;
    // Past the slew axis the arm would have to turn about between two checks.
    result.ik = IkOutcome::slew_limit;
    if ((ik.q_rad - last_rad).head<3>().cwiseAbs().maxCoeff() > max_step_rad) return result;
    last_rad = ik.q_rad;
    const Rates rates_here = rates(ik.q_rad, way, turn);
    result.ik = IkOutcome::too_far;  // the stretched arm is singular
    if (!rates_here.first.allFinite() || !rates_here.second.allFinite()) return result;
    fraction_limits.respect(rates_here, limits);
  }
  result.ik = IkOutcome::ok;
  const bool moves = length > 0 || turn != 0;
  const bool planned = moves ? curve_.plan(1, fraction_limits.velocity, fraction_limits.acceleration, fraction_limits.jerk) : true;
  result.outcome = planned ? PlanOutcome::ok : PlanOutcome::not_a_number;
  if (!planned) return result;
  goal_m_ = start_m_ + way;
  goal_roll_rad_ = goal_roll_rad;
  result.speed_m_s = curve_.peak_velocity() * length;
  return result;
}

Vec3 CartesianLine::tool_m(double t_s) const { return start_m_ + curve_.sample(t_s).position * (goal_m_ - start_m_); }

JointState CartesianLine::sample(double t_s) const {
  JointState state{start_rad_, JointVector::Zero(), JointVector::Zero()};
  const PathState s = curve_.sample(t_s);
  if (curve_.duration_s() == 0 || s.position == 0) return state;
  const Vec3 way = goal_m_ - start_m_;
  const double turn = goal_roll_rad_ - start_rad_[3];
  const double roll = s.position < 1 ? start_rad_[3] + s.position * turn : goal_roll_rad_;
  state.q_rad = inverse_kinematics(start_m_ + s.position * way, roll, no_limit_margin_rad).q_rad;
  const Rates r = rates(state.q_rad, way, turn);
  state.qd_rad_s = s.velocity * r.first;
  state.qdd_rad_s2 = s.acceleration * r.first + s.velocity * s.velocity * r.second;
  return state;
}

}  // namespace lf::arm
