#include "firmware/arm/s_curve.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

PathState advance(const PathState& from, double jerk, double t_s) {
  return {from.position + t_s * (from.velocity + t_s * (from.acceleration / 2 + t_s * jerk / 6)),
          from.velocity + t_s * (from.acceleration + t_s * jerk / 2), from.acceleration + t_s * jerk};
}

}  // namespace

bool SCurve::plan(double distance, double max_velocity, double max_acceleration, double max_jerk) {
  *this = SCurve();
  const bool valid = std::isfinite(distance + max_velocity + max_acceleration + max_jerk) && distance >= 0 && max_velocity > 0 &&
                     max_acceleration > 0 && max_jerk > 0;
  if (!valid) return false;
  if (distance == 0) return true;
  // Shapes from the longest motion to the shortest: with cruise; without it but at full acceleration; at full jerk only.
  double velocity = max_velocity;
  double tj = std::min(max_acceleration / max_jerk, std::sqrt(velocity / max_jerk));
  double ta = velocity / (max_jerk * tj);  // ramp's length less one jerk phase
  double tc = distance / velocity - (ta + tj);
  if (tc < 0) {
    tc = 0;
    tj = max_acceleration / max_jerk;
    // Without cruise the way is peak velocity x ramp time: a (T - tj) T = distance.
    const double ramp = (tj + std::sqrt(tj * tj + 4 * distance / max_acceleration)) / 2;
    ta = ramp - tj;
    if (ta < tj) {
      tj = std::cbrt(distance / (2 * max_jerk));
      ta = tj;
    }
  }
  distance_ = distance;
  jerk_time_s_ = tj;
  acceleration_time_s_ = ta;
  cruise_time_s_ = tc;
  // Rounding in the times must not leave the end beside the goal: the jerk is what covers the distance exactly.
  jerk_ = distance / (tj * ta * (ta + tj + tc));
  duration_s_ = 2 * (ta + tj) + tc;
  return true;
}

PathState SCurve::sample(double t_s) const {
  if (!(t_s > 0)) return {};
  if (t_s >= duration_s_) return {distance_, 0, 0};
  // The second half is the first one backwards.
  const bool backwards = t_s > duration_s_ / 2;
  double left = backwards ? duration_s_ - t_s : t_s;
  PathState state;
  const std::array<double, 4> lengths{jerk_time_s_, std::max(0.0, acceleration_time_s_ - jerk_time_s_), jerk_time_s_, cruise_time_s_};
  const std::array<double, 4> jerks{jerk_, 0, -jerk_, 0};
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double step = std::min(left, lengths[i]);
    state = advance(state, jerks[i], step);
    left -= step;
  }
  if (!backwards) return state;
  return {distance_ - state.position, state.velocity, -state.acceleration};
}

StopCurve::StopCurve(const PathState& from, double max_acceleration, double max_jerk) : from_(from) {
  // The velocity left when the present acceleration is brought straight to zero says which way to brake.
  const double rest_velocity = from.velocity + from.acceleration * std::abs(from.acceleration) / (2 * max_jerk);
  const double sign = rest_velocity > 0 ? -1 : 1;
  const double a0 = sign * from.acceleration;
  const double change = -sign * from.velocity;  // of the velocity, in the direction of braking
  const double limit = std::max(max_acceleration, std::abs(a0));
  double peak = std::sqrt(std::max(0.0, max_jerk * change + a0 * a0 / 2));
  double hold = 0;
  if (peak > limit) {
    peak = limit;
    hold = (change - (2 * peak * peak - a0 * a0) / (2 * max_jerk)) / peak;
  }
  segment_s_ = {std::max(0.0, (peak - a0) / max_jerk), std::max(0.0, hold), peak / max_jerk};
  jerk_ = {sign * max_jerk, 0, -sign * max_jerk};
}

PathState StopCurve::sample(double t_s) const {
  if (!(t_s > 0)) return from_;
  PathState state = from_;
  double left = t_s;
  for (std::size_t i = 0; i < segment_s_.size(); ++i) {
    const double step = std::min(left, segment_s_[i]);
    state = advance(state, jerk_[i], step);
    left -= step;
  }
  if (t_s >= duration_s()) state.velocity = state.acceleration = 0;
  return state;
}

}  // namespace lf::arm
