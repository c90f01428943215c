#include <algorithm>
#include <cmath>

#include "firmware/arm/give.hpp"
#include "firmware/arm/planar_chain.hpp"
#include "firmware/arm/pointing.hpp"
#include "firmware/arm/tool_place.hpp"
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

// Of the planar form. The tool's place in the arm's plane is r e(psi) + z k. A straight way gives r', psi' and z' by its parts along e, across it and along k; that it is
// straight, so that nothing of it changes, gives the second derivatives.
Rates planar_rates(const Arm& arm, const JointVector& q_rad, const Vec3& way_m) {
  Rates rates;
  const PlanarChain chain(arm.planar(), q_rad);
  const double r1 = chain.elbow_r_m - arm.planar().a0_m, z1 = chain.elbow_z_m;                // shoulder to elbow
  const double r2 = chain.tool_r_m - chain.elbow_r_m, z2 = chain.tool_z_m - chain.elbow_z_m;  // elbow to tool
  const double determinant = r1 * z2 - r2 * z1;
  // The angles beta of the upper arm and gamma of the forearm that change r and z by so much: (r, z)' = beta' (-z1, r1) + gamma' (-z2, r2).
  const auto solve = [&](double r, double z, double& beta, double& gamma) {
    beta = (r * r2 + z * z2) / determinant;
    gamma = -(r * r1 + z * z1) / determinant;
  };
  const double along = way_m.x() * chain.cos_psi + way_m.y() * chain.sin_psi;
  const double across = way_m.y() * chain.cos_psi - way_m.x() * chain.sin_psi;
  const double psi = across / chain.tool_r_m;
  double beta = 0, gamma = 0;
  solve(along, way_m.z(), beta, gamma);
  rates.first.head<3>() = Vec3(psi, beta, gamma - beta);

  double beta2 = 0, gamma2 = 0;
  solve(chain.tool_r_m * psi * psi + r1 * beta * beta + r2 * gamma * gamma, z1 * beta * beta + z2 * gamma * gamma, beta2, gamma2);
  rates.second.head<3>() = Vec3(-2 * along * psi / chain.tool_r_m, beta2, gamma2 - beta2);
  return rates;
}

// The rates' own change, over a thousandth of the way.
Rates pointing_rates(const Arm& arm, const JointVector& q_rad, const Vec3& way_m) {
  constexpr double share = 1e-3;
  Rates rates;
  rates.first = tool_rates(arm, q_rad, way_m);
  rates.second = (tool_rates(arm, q_rad + share * rates.first, way_m) - rates.first) / share;
  return rates;
}

Rates rates(const Arm& arm, const JointVector& q_rad, const Vec3& way_m, double turn_rad) {
  Rates rates;
  if (way_m.squaredNorm() > 0) rates = arm.is_planar() ? planar_rates(arm, q_rad, way_m) : pointing_rates(arm, q_rad, way_m);
  arm.set_roll(rates.first, turn_rad);
  return rates;
}

IkOutcome limit_passed(const Arm& arm, const JointVector& q_rad, const JointLimits& limits) {
  constexpr std::array of_planar_form{IkOutcome::slew_limit, IkOutcome::shoulder_limit, IkOutcome::elbow_limit, IkOutcome::roll_limit};
  for (std::size_t i = 0; i < limits.joints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (q_rad[k] < limits.lower_rad[k] - 1e-9 || q_rad[k] > limits.upper_rad[k] + 1e-9)
      return arm.is_planar() ? of_planar_form[i] : IkOutcome::joint_limit;
  }
  return IkOutcome::ok;
}

// Lowers the fraction's own limits so that every joint keeps to its own: half of each acceleration for the path's, half for its curvature.
void respect(const Rates& rates, const JointLimits& limits, double& velocity, double& acceleration, double& jerk) {
  for (std::size_t i = 0; i < limits.joints; ++i) {
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

}  // namespace

LinePlan CartesianLine::plan(const Arm& arm, const JointVector& start_rad, const Vec3& goal_m, double goal_roll_rad, const LineLimits& line,
                             const JointLimits& limits) {
  begin(arm, start_rad, goal_m, goal_roll_rad, line, limits);
  (void)advance(checks + 1);
  return result_;
}

void CartesianLine::begin(const Arm& arm, const JointVector& start_rad, const Vec3& goal_m, double goal_roll_rad, const LineLimits& line,
                          const JointLimits& limits) {
  *this = CartesianLine();
  arm_ = &arm;
  start_rad_ = start_rad;
  goal_roll_rad_ = arm.roll_rad(start_rad);
  if (!can_work(arm)) result_.ik = IkOutcome::other_form;
  if (!can_work(arm) || !start_rad.allFinite()) return;
  start_m_ = goal_m_ = arm.base_from_tool(start_rad).translation();
  way_m_ = goal_m - start_m_;
  if (!way_m_.allFinite() || !std::isfinite(goal_roll_rad - goal_roll_rad_)) return;
  if (arm.rolls()) goal_roll_rad_ = goal_roll_rad;
  const double length = way_m_.norm();
  velocity_ = length > 0 ? line.speed_m_s / length : HUGE_VAL;
  acceleration_ = length > 0 ? line.acceleration_m_s2 / length : HUGE_VAL;
  jerk_ = length > 0 ? line.jerk_m_s3 / length : HUGE_VAL;
  push_n_ = line.push_n;
  gentle_velocity_ = HUGE_VAL;
  result_.speed_m_s = line.speed_m_s;
  posture_ = posture_of(arm, start_rad);
  limits_ = limits;
  last_rad_ = start_rad;
  planned_ = false;
}

bool CartesianLine::advance(int checks_now) {
  for (int i = 0; i < checks_now && !planned_; ++i) planned_ = check();
  return planned_;
}

bool CartesianLine::finish(PlanOutcome outcome, IkOutcome ik) {
  result_.outcome = outcome;
  result_.ik = ik;
  return true;
}

// At a fraction of the way, in the posture of the start: in closed form, or led there from the last point.
IkResult CartesianLine::at(double fraction, double roll_rad) const {
  const Vec3 tool_m = start_m_ + fraction * way_m_;
  if (arm_->is_planar()) return inverse_kinematics(*arm_, posture_, tool_m, roll_rad, no_limit_margin_rad);
  IkResult led;
  led.q_rad = fraction * checks < 1 ? start_rad_ : last_rad_;  // the last check was at the goal
  led.outcome = move_tool(*arm_, tool_m, arm_->approach_axis(start_rad_), led.q_rad) ? IkOutcome::ok : IkOutcome::too_far;
  arm_->set_roll(led.q_rad, roll_rad);
  return led;
}

// Looks at one point of the way. True when the plan has ended with it.
bool CartesianLine::check() {
  const int i = next_check_++;
  const double fraction = static_cast<double>(i) / checks;
  const double start_roll_rad = arm_->roll_rad(start_rad_), turn = goal_roll_rad_ - start_roll_rad;
  result_.fraction = fraction;
  const IkResult ik = at(fraction, start_roll_rad + fraction * turn);
  const IkOutcome reached = ik.ok() ? limit_passed(*arm_, ik.q_rad, limits_) : ik.outcome;
  // The start is where the arm is: a motion may lead back inside from there.
  if (reached != IkOutcome::ok && (i > 0 || !ik.ok())) return finish(PlanOutcome::unreachable, reached);
  // Past the slew axis the arm would have to turn about between two checks; so would one that points past a singular posture.
  if ((ik.q_rad - last_rad_).head(static_cast<Eigen::Index>(arm_->pointing_joints())).cwiseAbs().maxCoeff() > max_step_rad)
    return finish(PlanOutcome::unreachable, arm_->is_planar() ? IkOutcome::slew_limit : IkOutcome::turned_away);
  last_rad_ = ik.q_rad;
  if (!arm_->is_planar() && is_singular(*arm_, ik.q_rad)) return finish(PlanOutcome::unreachable, IkOutcome::turned_away);
  const Rates here = rates(*arm_, ik.q_rad, way_m_, turn);
  // The stretched arm is singular.
  if (!here.first.allFinite() || !here.second.allFinite()) return finish(PlanOutcome::unreachable, IkOutcome::too_far);
  respect(here, limits_, velocity_, acceleration_, jerk_);
  const double length = way_m_.norm();
  if (std::isfinite(push_n_) && length > 0) {
    const double gentle_m_s = gentle_speed_m_s(*arm_, ik.q_rad, here.first / length, way_m_ / length, limits_, push_n_);
    gentle_velocity_ = std::min(gentle_velocity_, gentle_m_s / length);
  }
  if (i < checks) return false;

  // Beside a singular posture the tool creeps while the joints turn: no step waits for that.
  constexpr double slowest = 0.25;  // of the speed that was asked for
  if (!arm_->is_planar() && length > 0 && velocity_ * length < slowest * result_.speed_m_s)
    return finish(PlanOutcome::unreachable, IkOutcome::turned_away);
  velocity_ = std::min(velocity_, gentle_velocity_);
  if ((length > 0 || turn != 0) && !curve_.plan(1, velocity_, acceleration_, jerk_))
    return finish(PlanOutcome::not_a_number, IkOutcome::ok);
  goal_m_ = start_m_ + way_m_;
  way_m_ = goal_m_ - start_m_;  // as rounding leaves it: the line ends at its goal
  result_.speed_m_s = curve_.peak_velocity() * length;
  return finish(PlanOutcome::ok, IkOutcome::ok);
}

Vec3 CartesianLine::tool_m(double t_s) const { return start_m_ + curve_.sample(t_s).position * (goal_m_ - start_m_); }

// A way that grazes a place which no posture reaches, between two of its checks, waits before it.
JointVector CartesianLine::solved(double fraction, double roll_rad) {
  constexpr int steps = 8;
  for (int back = 0; back < steps; ++back) {
    const IkResult ik = at(std::max(0.0, fraction - static_cast<double>(back) / (steps * checks)), roll_rad);
    if (ik.outcome == IkOutcome::too_far || ik.outcome == IkOutcome::too_near || ik.outcome == IkOutcome::not_a_number) continue;
    // An arm that is led never jumps: it stands, and what follows it says so.
    if (!arm_->is_planar() && fraction * checks >= 1 && (ik.q_rad - last_rad_).cwiseAbs().maxCoeff() > max_step_rad) continue;
    last_rad_ = ik.q_rad;
    return ik.q_rad;
  }
  return arm_->is_planar() ? start_rad_ : last_rad_;
}

JointState CartesianLine::sample(double t_s) {
  JointState state{start_rad_, JointVector::Zero(), JointVector::Zero()};
  const PathState s = curve_.sample(t_s);
  if (curve_.duration_s() == 0 || s.position == 0) return state;
  const double from = arm_->roll_rad(start_rad_), turn = goal_roll_rad_ - from;
  const double roll = s.position < 1 ? from + s.position * turn : goal_roll_rad_;
  state.q_rad = solved(s.position, roll);
  const Rates r = rates(*arm_, state.q_rad, way_m_, turn);
  state.qd_rad_s = s.velocity * r.first;
  state.qdd_rad_s2 = s.acceleration * r.first + s.velocity * s.velocity * r.second;
  return state;
}

}  // namespace lf::arm
