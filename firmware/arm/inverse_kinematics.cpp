#include "firmware/arm/inverse_kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/arm/planar_chain.hpp"

namespace lf::arm {
namespace {

IkResult no_form() {
  IkResult none;
  none.outcome = IkOutcome::other_form;
  return none;
}

// A joint angle counts as inside a limit that it passes by less than rounding can make of it.
constexpr double rounding_rad = 1e-12;

// How far `angle_rad` is past joint i's limits, and the angle drawn back by rounding. 0 when inside.
double excess(const Arm& arm, std::size_t i, double& angle_rad, double margin_rad) {
  const double lower = arm.model().joints[i].lower_rad + margin_rad;
  const double upper = arm.model().joints[i].upper_rad - margin_rad;
  if (angle_rad > upper) {
    if (angle_rad - upper > rounding_rad) return angle_rad - upper;
    angle_rad = upper;
  } else if (angle_rad < lower) {
    if (lower - angle_rad > rounding_rad) return lower - angle_rad;
    angle_rad = lower;
  }
  return 0;
}

bool check(const Arm& arm, std::size_t i, IkOutcome reason, double margin_rad, IkResult& result) {
  result.excess = excess(arm, i, result.q_rad[static_cast<Eigen::Index>(i)], margin_rad);
  result.outcome = result.excess > 0 ? reason : IkOutcome::ok;
  return result.ok();
}

// The slew faces the target, or looks away from it.
struct Facing {
  IkBranch branch = IkBranch::folded;
  double slew_rad = 0;
  double excess_rad = 0;  // past the slew's limits
};

Facing facing(const Arm& arm, IkBranch branch, const Vec3& tool_m, double margin_rad) {
  const double facing_rad = std::atan2(tool_m.y(), tool_m.x()) - arm.planar().mount_yaw_rad;
  Facing one{branch, wrap(branch == IkBranch::front ? facing_rad : facing_rad + pi), 0};
  one.excess_rad = excess(arm, 0, one.slew_rad, margin_rad);
  return one;
}

// Slew, shoulder and elbow for one way of facing the target, by the triangle of upper arm and forearm: bent one way, and the other.
std::array<IkResult, 2> solve(const Arm& arm, const Vec3& tool_m, const Facing& facing, double margin_rad) {
  const double upper_arm_m = arm.planar().a1_m, forearm_m = arm.forearm().length_m;
  IkResult result;
  result.posture.branch = facing.branch;
  result.q_rad[0] = facing.slew_rad;
  const double radius_m = std::sqrt(tool_m.x() * tool_m.x() + tool_m.y() * tool_m.y());
  const double r_m = (facing.branch == IkBranch::front ? radius_m : -radius_m) - arm.planar().a0_m, z_m = tool_m.z();
  const double distance_squared = r_m * r_m + z_m * z_m;
  const double cos_bend = (distance_squared - upper_arm_m * upper_arm_m - arm.forearm().length_squared_m2) / (2 * upper_arm_m * forearm_m);
  if (std::abs(cos_bend) > 1) {
    result.outcome = cos_bend > 1 ? IkOutcome::too_far : IkOutcome::too_near;
    const double distance = std::sqrt(distance_squared);
    result.excess = cos_bend > 1 ? distance - upper_arm_m - forearm_m : std::abs(upper_arm_m - forearm_m) - distance;
    return {result, result};
  }
  const double sin_bend = std::sqrt((1 - cos_bend) * (1 + cos_bend)), bend_rad = std::atan2(sin_bend, cos_bend);
  const double tool_rad = std::atan2(z_m, r_m), across_rad = std::atan2(forearm_m * sin_bend, upper_arm_m + forearm_m * cos_bend);
  std::array<IkResult, 2> both{result, result};
  for (const int way : {0, 1}) {
    IkResult& one = both[static_cast<std::size_t>(way)];
    one.posture.bent_back = way == 1;
    one.q_rad[1] = wrap(tool_rad - (way == 0 ? across_rad : -across_rad) - arm.planar().shoulder_offset_rad);
    one.q_rad[2] = wrap((way == 0 ? bend_rad : -bend_rad) - arm.planar().elbow_offset_rad - arm.forearm().angle_rad);
    (void)(check(arm, 1, IkOutcome::shoulder_limit, margin_rad, one) && check(arm, 2, IkOutcome::elbow_limit, margin_rad, one));
  }
  return both;
}

// With the roll, and the slew's limit as the reason where that is one.
IkResult with_roll(const Arm& arm, IkResult result, double slew_excess_rad, double roll_rad, double margin_rad) {
  if (result.outcome == IkOutcome::too_far || result.outcome == IkOutcome::too_near) return result;
  result.q_rad[3] = roll_rad;
  if (slew_excess_rad > 0) {
    result.outcome = IkOutcome::slew_limit;
    result.excess = slew_excess_rad;
  }
  if (result.ok()) check(arm, 3, IkOutcome::roll_limit, margin_rad, result);
  return result;
}

// The largest travel of slew, shoulder or elbow.
double travel_rad(const JointVector& a, const JointVector& b) { return (a - b).head<3>().cwiseAbs().maxCoeff(); }

// How near slew, shoulder or elbow comes to a limit, less the nearer the better.
double room_rad(const Arm& arm, const JointVector& q_rad) {
  double room = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    const double q = q_rad[static_cast<Eigen::Index>(i)];
    room = std::min({room, q - arm.model().joints[i].lower_rad, arm.model().joints[i].upper_rad - q});
  }
  return room;
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
    case IkOutcome::joint_limit: return "joint limit";
    case IkOutcome::turned_away: return "turned away";
    case IkOutcome::not_found: return "no posture found";
    case IkOutcome::other_form: return "arm of another form";
  }
  return "unknown";
}

IkPosture posture_of(const Arm& arm, const JointVector& q_rad) {
  if (!arm.is_planar()) return {};
  const PlanarChain chain(arm.planar(), q_rad);
  const double bend_rad = wrap(q_rad[2] + arm.planar().elbow_offset_rad + arm.forearm().angle_rad);
  return {chain.tool_r_m >= 0 ? IkBranch::front : IkBranch::folded, bend_rad < 0};
}

IkResult inverse_kinematics(const Arm& arm, const Vec3& tool_m, double roll_rad, double limit_margin_rad,
                            const std::optional<JointVector>& near_rad) {
  if (!arm.is_planar()) return no_form();
  if (!std::isfinite(tool_m.squaredNorm() + roll_rad + limit_margin_rad)) return {};
  std::array<Facing, 2> facings{facing(arm, IkBranch::folded, tool_m, limit_margin_rad),
                                facing(arm, IkBranch::front, tool_m, limit_margin_rad)};
  if (facings[1].excess_rad < facings[0].excess_rad) std::swap(facings[0], facings[1]);

  IkResult result;
  std::optional<IkResult> best;
  double best_cost = 0;
  for (const Facing& each : facings) {
    const bool first = &each == &facings[0], within = each.excess_rad == 0;
    if (!first && !within) continue;
    const std::array<IkResult, 2> both = solve(arm, tool_m, each, limit_margin_rad);
    if (first) result = both[0];  // the reason, where nothing is within the limits
    for (const IkResult& one : both) {
      if (!within || !one.ok()) continue;
      const double cost = near_rad ? travel_rad(one.q_rad, *near_rad) : -room_rad(arm, one.q_rad);
      if (best && cost >= best_cost) continue;
      best = one;
      best_cost = cost;
    }
  }
  return best ? with_roll(arm, *best, 0, roll_rad, limit_margin_rad)
              : with_roll(arm, result, facings[0].excess_rad, roll_rad, limit_margin_rad);
}

IkResult inverse_kinematics(const Arm& arm, IkPosture posture, const Vec3& tool_m, double roll_rad, double limit_margin_rad) {
  if (!arm.is_planar()) return no_form();
  if (!std::isfinite(tool_m.squaredNorm() + roll_rad + limit_margin_rad)) return {};
  const Facing one = facing(arm, posture.branch, tool_m, limit_margin_rad);
  return with_roll(arm, solve(arm, tool_m, one, limit_margin_rad)[posture.bent_back ? 1 : 0], one.excess_rad, roll_rad, limit_margin_rad);
}

std::optional<BarRolls> rolls_for_bar(const Arm& arm, const JointVector& q_rad, const Vec3& bar) {
  const Mat3 tool = arm.base_from_unrolled_tool(q_rad).linear();
  const double length = bar.norm();
  const double along_x = bar.dot(tool.col(0));
  const double along_y = bar.dot(tool.col(1));
  const double square = std::hypot(along_x, along_y);
  constexpr double sin_min = 0.1987;  // 0.2 rad
  if (!std::isfinite(length) || !tool.allFinite() || !(square > sin_min * length)) return std::nullopt;
  // At a roll of rho, tool y is (-sin rho, cos rho) in tool x and y at roll 0.
  const double roll = std::atan2(-along_x, along_y);
  return BarRolls{{roll, wrap(roll + pi)}, std::atan2(std::abs(bar.dot(tool.col(2))), square)};
}

std::optional<double> roll_for_turn(const BarRolls& rolls, double turn_rad, double lower_rad, double upper_rad) {
  std::optional<double> best;
  double best_room = 0;
  for (const double roll : rolls.roll_rad) {
    const double room = std::min(upper_rad - std::max(roll, roll + turn_rad), std::min(roll, roll + turn_rad) - lower_rad);
    if (room >= 0 && (!best || room > best_room)) {
      best = roll;
      best_room = room;
    }
  }
  return best;
}

}  // namespace lf::arm
