#include "firmware/mission/clear_route.hpp"

#include <algorithm>

namespace lf::mission {

namespace {

// Calibration and quantisation of where the arm stands.
constexpr double leeway_m = 0.001;

}  // namespace

void ClearRoute::begin(const arm::JointVector& from_rad, const arm::JointVector& to_rad, const Room& room) {
  from_rad_ = from_rad;
  room_ = room;
  points_ = {};
  via_[0] = park_rad_;
  via_[0][3] = to_rad[3];
  via_[1] = to_rad;
  const double here_m = panel_.clearance(arm::link_capsules(from_rad, room.jaw_rad), room.base_from_panel).distance_m;
  leaving_m_ = std::min(clearance_m, here_m - leeway_m);
  look_at(Leg::straight);
}

void ClearRoute::look_at(Leg leg) {
  leg_ = leg;
  const arm::JointVector& from = leg == Leg::from_park ? via_[0] : from_rad_;
  const arm::JointVector& to = leg == Leg::to_park ? via_[0] : via_[1];
  way_.begin(from, to, room_.jaw_rad, room_.base_from_panel, leg == Leg::from_park ? clearance_m : leaving_m_);
}

ClearRoute::State ClearRoute::advance() {
  const arm::ClearWay::State way = way_.advance(panel_, poses_a_share);
  if (way == arm::ClearWay::State::looking) return State::looking;
  const bool clear = way == arm::ClearWay::State::clear;
  switch (leg_) {
    case Leg::straight:
      if (clear) {
        points_ = std::span(via_).subspan(1);
        return State::found;
      }
      look_at(Leg::to_park);
      return State::looking;
    case Leg::to_park:
      if (!clear) return State::none;
      look_at(Leg::from_park);
      return State::looking;
    case Leg::from_park:
      if (clear) points_ = via_;
      return clear ? State::found : State::none;
  }
  return State::none;
}

}  // namespace lf::mission
