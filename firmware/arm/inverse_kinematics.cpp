#include "firmware/arm/inverse_kinematics.hpp"

#include <cmath>

#include "firmware/arm/planar_chain.hpp"

namespace lf::arm {
namespace {

constexpr double forearm_squared_m2 = a2_m * a2_m + d_m * d_m;
const double forearm_m = std::sqrt(forearm_squared_m2);  // elbow to tool point
// The tool point stands at this angle from the forearm's own x direction, seen from the elbow.
const double forearm_angle_rad = std::atan2(-d_m, a2_m);
// A joint angle counts as inside a limit that it passes by less than rounding can make of it.
constexpr double rounding_rad = 1e-12;

// How far `angle_rad` is past joint i's limits, and the angle drawn back by rounding. 0 when inside.
double excess(std::size_t i, double& angle_rad, double margin_rad) {
  const double lower = arm_geometry::joints[i].lower_rad + margin_rad;
  const double upper = arm_geometry::joints[i].upper_rad - margin_rad;
  if (angle_rad > upper) {
    if (angle_rad - upper > rounding_rad) return angle_rad - upper;
    angle_rad = upper;
  } else if (angle_rad < lower) {
    if (lower - angle_rad > rounding_rad) return lower - angle_rad;
    angle_rad = lower;
  }
  return 0;
}

bool check(std::size_t i, IkOutcome reason, double margin_rad, IkResult& result) {
  result.excess = excess(i, result.q_rad[i], margin_rad);
  result.outcome = result.excess > 0 ? reason : IkOutcome::ok;
  return result.ok();
}

// Slew facing the target or looking away from it. False, with the nearer miss, when neither is within the limits.
bool solve_slew(const Vec3& tool_m, double margin_rad, IkResult& result) {
  const double facing = std::atan2(tool_m.y(), tool_m.x()) - arm_geometry::mount_yaw_rad;
  double front = wrap(facing);
  double folded = wrap(facing + pi);
  const double front_excess = excess(0, front, margin_rad);
  const double folded_excess = excess(0, folded, margin_rad);
  result.branch = folded_excess <= front_excess ? IkBranch::folded : IkBranch::front;
  result.q_rad[0] = result.branch == IkBranch::folded ? folded : front;
  result.excess = std::min(front_excess, folded_excess);
  result.outcome = result.excess > 0 ? IkOutcome::slew_limit : IkOutcome::ok;
  return result.ok();
}

// Shoulder and elbow for a bend of the arm's triangle, either way.
bool solve_plane(double r_m, double z_m, double cos_bend, double sin_bend, double margin_rad, IkResult& result) {
  const double bend = std::atan2(sin_bend, cos_bend);
  result.q_rad[1] = wrap(std::atan2(z_m, r_m) - std::atan2(forearm_m * sin_bend, a1_m + forearm_m * cos_bend) - shoulder_offset_rad);
  result.q_rad[2] = wrap(bend - elbow_offset_rad - forearm_angle_rad);
  return check(1, IkOutcome::shoulder_limit, margin_rad, result) && check(2, IkOutcome::elbow_limit, margin_rad, result);
}

}  // namespace

const char* name(IkOutcome outcome) {
  switch (outcome) {
    case IkOutcome::ok: return "ok";
    case IkOutcome::not_a_number: return "not a number";
    case IkOutcome::too_far: return "too far";
    case IkOutcome::too_near: return "too near";
    case IkOutcome::slew_limit: return "slew limit";
    case IkOutcome::shoulder_limit: return "shoulder limit";
    case IkOutcome::elbow_limit: return "elbow limit";
    case IkOutcome::roll_limit: return "roll limit";
  }
  return "unknown";
}

IkResult inverse_kinematics(const Vec3& tool_m, double roll_rad, double limit_margin_rad) {
  IkResult result;
  const double radius_squared = tool_m.x() * tool_m.x() + tool_m.y() * tool_m.y();
  const double z_m = tool_m.z();
  if (!std::isfinite(radius_squared + z_m * z_m + roll_rad + limit_margin_rad)) return result;

  const bool slew_ok = solve_slew(tool_m, limit_margin_rad, result);
  const IkResult slew = result;
  const double r_m = (result.branch == IkBranch::front ? std::sqrt(radius_squared) : -std::sqrt(radius_squared)) - a0_m;
  const double distance_squared = r_m * r_m + z_m * z_m;
  const double cos_bend = (distance_squared - a1_m * a1_m - forearm_squared_m2) / (2 * a1_m * forearm_m);
  if (std::abs(cos_bend) > 1) {
    result.outcome = cos_bend > 1 ? IkOutcome::too_far : IkOutcome::too_near;
    const double distance = std::sqrt(distance_squared);
    result.excess = cos_bend > 1 ? distance - a1_m - forearm_m : std::abs(a1_m - forearm_m) - distance;
    return result;
  }
  const double sin_bend = std::sqrt((1 - cos_bend) * (1 + cos_bend));
  result.q_rad[3] = roll_rad;
  if (!solve_plane(r_m, z_m, cos_bend, sin_bend, limit_margin_rad, result)) {
    // The other bend is out of this arm's elbow limits everywhere; a URDF with wider ones has it.
    IkResult other = result;
    if (!solve_plane(r_m, z_m, cos_bend, -sin_bend, limit_margin_rad, other)) return slew_ok ? result : slew;
    result = other;
  }
  if (!slew_ok) {
    result.outcome = slew.outcome;
    result.excess = slew.excess;
    return result;
  }
  check(3, IkOutcome::roll_limit, limit_margin_rad, result);
  return result;
}

std::optional<BarRolls> rolls_for_bar(const JointVector& q_rad, const Vec3& bar) {
  const PlanarChain chain(q_rad);
  const double length = bar.norm();
  const double along_x = bar.dot(chain.tool_x());
  const double along_y = bar.dot(chain.across());
  const double square = std::hypot(along_x, along_y);
  constexpr double sin_min = 0.1987;  // 0.2 rad
  if (!std::isfinite(length) || !q_rad.head<3>().allFinite() || !(square > sin_min * length)) return std::nullopt;
  // At a roll of rho, tool y is (-sin rho, cos rho) in tool x and y at roll 0.
  const double roll = std::atan2(-along_x, along_y);
  return BarRolls{{roll, wrap(roll + pi)}, std::atan2(std::abs(bar.dot(chain.tool_z())), square)};
}

std::optional<double> roll_for_turn(const BarRolls& rolls, double turn_rad, double limit_margin_rad) {
  const double lower = arm_geometry::joints[3].lower_rad + limit_margin_rad;
  const double upper = arm_geometry::joints[3].upper_rad - limit_margin_rad;
  std::optional<double> best;
  double best_room = 0;
  for (const double roll : rolls.roll_rad) {
    const double room = std::min(upper - std::max(roll, roll + turn_rad), std::min(roll, roll + turn_rad) - lower);
    if (room >= 0 && (!best || room > best_room)) {
      best = roll;
      best_room = room;
    }
  }
  return best;
}

}  // namespace lf::arm
