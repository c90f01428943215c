#include "firmware/mission/clear_route.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/mission/workspace_way.hpp"
#include "shared/random.hpp"

namespace lf::mission {

namespace {

// Of where the arm stands: its drives' last counts, and what the arm gives way by.
constexpr double leeway_m = 0.001;

// Postures drawn at random: every other one from the room between start, goal and park, the rest from all that the joints can.
constexpr Eigen::Index most_drawn = 64;
// Of all ways that are looked at for one route: 8 s of ticks, within what a step waits for its plan.
constexpr int most_poses = 16'000;

// `q_rad` drawn into what the mission allows this joint.
double drawn_in(const arm::Arm& arm, const safety::Limits& limits, std::size_t joint, double q_rad) {
  const safety::JointLimit& limit = limits.joints[joint];
  const double at_most_rad = std::min({q_rad, limit.max_rad, arm.joint(joint).upper_rad});
  return std::max({at_most_rad, limit.min_rad, arm.joint(joint).lower_rad});
}

}  // namespace

arm::Distances wanted_from(const arm::JointVector& from_rad, double jaw_rad, const arm::Surroundings& surroundings) {
  const arm::Distances here = surroundings.distances(from_rad, jaw_rad);
  const auto wanted = [](double here_m) { return std::min(clearance_m, here_m - leeway_m); };
  return {wanted(here.panel_m), wanted(here.vehicle_m), wanted(here.itself_m)};
}

StepFailure failure_of(arm::Barrier barrier) {
  switch (barrier) {
    case arm::Barrier::panel: return StepFailure::panel_in_the_way;
    case arm::Barrier::vehicle: return StepFailure::vehicle_in_the_way;
    case arm::Barrier::itself: return StepFailure::arm_in_its_own_way;
    case arm::Barrier::none: break;
  }
  return StepFailure::no_motion;
}

void ClearRoute::begin(const arm::JointVector& from_rad, const arm::JointVector& to_rad, double jaw_rad,
                       const arm::Surroundings& surroundings) {
  from_rad_ = from_rad;
  points_ = {};
  barrier_ = arm::Barrier::none;
  vias_ = 0;
  looked_at_ = 0;
  via_[1] = to_rad;
  leaving_ = wanted_from(from_rad, jaw_rad, surroundings);
  look_at(Leg::straight, surroundings);
}

void ClearRoute::look_at(Leg leg, const arm::Surroundings& surroundings) {
  leg_ = leg;
  way_.begin(leg == Leg::from_via ? via_[0] : from_rad_, surroundings, leg == Leg::from_via ? wanted_everywhere : leaving_,
             wanted_everywhere);
  way_.add(leg == Leg::to_via ? via_[0] : via_[1]);
}

bool ClearRoute::next_via(const arm::Arm& arm, const safety::Limits& limits) {
  const auto joints = static_cast<Eigen::Index>(arm.arm_joints());
  const auto tried = static_cast<Eigen::Index>(vias_++);
  if (tried == 0) {
    via_[0] = park_rad_;
    via_[0][joints - 1] = via_[1][joints - 1];
    return true;
  }
  if (arm.is_planar() || tried > 2 * (joints - 1) + most_drawn) return false;
  if (tried > 2 * (joints - 1)) {
    draw_via(arm, limits);
    return true;
  }
  // The joints from `split` on go first, and at the next try those before it.
  const Eigen::Index split = joints - (tried + 1) / 2;
  const bool hand_first = tried % 2 == 1;
  for (Eigen::Index i = 0; i < joints; ++i)
    via_[0][i] = drawn_in(arm, limits, static_cast<std::size_t>(i), (i >= split) == hand_first ? via_[1][i] : from_rad_[i]);
  return true;
}

void ClearRoute::draw_via(const arm::Arm& arm, const safety::Limits& limits) {
  const bool between = vias_ % 2 == 0;
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto [low_rad, high_rad] =
        between ? std::minmax({from_rad_[k], via_[1][k], park_rad_[k]}) : std::pair(arm.joint(i).lower_rad, arm.joint(i).upper_rad);
    const std::uint64_t draw = splitmix64((std::uint64_t{vias_} << 8) + i);
    via_[0][k] =
        std::lerp(drawn_in(arm, limits, i, low_rad), drawn_in(arm, limits, i, high_rad), static_cast<double>(draw >> 11) * 0x1p-53);
  }
}

bool ClearRoute::keeps_to_workspace(const arm::Arm& arm, const safety::Limits& limits) const {
  return mission::keeps_to_workspace(arm, limits, leg_ == Leg::from_via ? via_[0] : from_rad_, leg_ == Leg::to_via ? via_[0] : via_[1]);
}

ClearRoute::State ClearRoute::advance(const arm::Surroundings& surroundings, const safety::Limits& limits) {
  const arm::ClearWay::State way = way_.advance(surroundings, poses_a_share);
  if (way == arm::ClearWay::State::looking) return State::looking;
  looked_at_ += way_.poses();
  const bool clear = way == arm::ClearWay::State::clear && keeps_to_workspace(surroundings.arm(), limits);
  if (leg_ == Leg::straight) barrier_ = clear ? arm::Barrier::none : way_.barrier();
  if (clear && leg_ != Leg::to_via) {
    points_ = leg_ == Leg::straight ? std::span(via_).subspan(1) : std::span(via_);
    return State::found;
  }
  if (clear) {
    look_at(Leg::from_via, surroundings);
    return State::looking;
  }
  if (looked_at_ > most_poses || !next_via(surroundings.arm(), limits)) return State::none;
  look_at(Leg::to_via, surroundings);
  return State::looking;
}

}  // namespace lf::mission
