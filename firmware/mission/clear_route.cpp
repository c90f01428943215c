#include "firmware/mission/clear_route.hpp"

#include <algorithm>

namespace lf::mission {

namespace {

// Of where the arm stands: its drives' last counts, and what the arm gives way by.
constexpr double leeway_m = 0.001;

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
  via_[0] = park_rad_;
  const std::size_t roll = surroundings.arm().roll_joint();
  via_[0][roll] = to_rad[roll];
  via_[1] = to_rad;
  leaving_ = wanted_from(from_rad, jaw_rad, surroundings);
  look_at(Leg::straight, surroundings);
}

void ClearRoute::look_at(Leg leg, const arm::Surroundings& surroundings) {
  leg_ = leg;
  way_.begin(leg == Leg::from_park ? via_[0] : from_rad_, surroundings, leg == Leg::from_park ? wanted_everywhere : leaving_,
             wanted_everywhere);
  way_.add(leg == Leg::to_park ? via_[0] : via_[1]);
}

ClearRoute::State ClearRoute::advance(const arm::Surroundings& surroundings) {
  const arm::ClearWay::State way = way_.advance(surroundings, poses_a_share);
  if (way == arm::ClearWay::State::looking) return State::looking;
  const bool clear = way == arm::ClearWay::State::clear;
  switch (leg_) {
    case Leg::straight:
      if (clear) {
        points_ = std::span(via_).subspan(1);
        return State::found;
      }
      barrier_ = way_.barrier();
      look_at(Leg::to_park, surroundings);
      return State::looking;
    case Leg::to_park:
      if (!clear) return State::none;
      look_at(Leg::from_park, surroundings);
      return State::looking;
    case Leg::from_park:
      if (clear) points_ = via_;
      return clear ? State::found : State::none;
  }
  return State::none;
}

}  // namespace lf::mission
