#include "firmware/arm/clear_way.hpp"

#include <algorithm>
#include <cmath>

namespace lf::arm {
namespace {

constexpr Distances nowhere_near{HUGE_VAL, HUGE_VAL, HUGE_VAL};

// The largest of all the jaw's angles: the fingers turn about axes of their own, so that what is farthest out at one end is not at the other.
JointVector reach_m(const Arm& arm, const JawSweep& jaw) {
  constexpr int angles = 4;
  JointVector most = arm.reach_m(jaw.high_rad);
  for (int i = 0; i < angles && jaw.low_rad < jaw.high_rad; ++i)
    most = most.cwiseMax(arm.reach_m(jaw.low_rad + (jaw.high_rad - jaw.low_rad) * i / angles));
  return most;
}

// From a finger's axis to its farthest point.
double jaw_reach_m(const Arm& arm) {
  double most = 0;
  for (const ArmModel::Capsule& n : arm.model().capsules) {
    if (n.link() <= arm.arm_joints()) continue;
    for (const Vec3& end : {n.a_m(), n.b_m()}) most = std::max(most, std::hypot(end.x(), end.z()) + n.radius_m());
  }
  return most;
}

}  // namespace

void ClearWay::begin(const JointVector& from_rad, const Surroundings& surroundings, const Distances& at_first, const Distances& wanted) {
  const Room& room = surroundings.room();
  *this = ClearWay();
  from_rad_ = from_rad;
  reach_m_ = reach_m(surroundings.arm(), room.jaw);
  jaw_reach_m_ = jaw_reach_m(surroundings.arm());
  jaw_rad_ = room.jaw.low_rad;
  at_first_ = kept_ = at_first;
  wanted_ = wanted;
  nearest_ = nowhere_near;
  least_slack_m_ = HUGE_VAL;
  const bool numbers = std::isfinite(room.jaw.low_rad + room.jaw.high_rad) && room.base_from_panel.matrix().allFinite() &&
                       std::isfinite(room.doubt.shift_m + room.doubt.turn_rad + room.doubt.spin_rad) && from_rad.allFinite();
  state_ = numbers && room.jaw.low_rad <= room.jaw.high_rad ? State::looking : State::blocked;
}

void ClearWay::add(const JointVector& to_rad) {
  if (state_ == State::blocked) return;
  from_rad_ += way_rad_;
  way_rad_ = to_rad - from_rad_;
  longest_m_ = way_rad_.cwiseAbs().dot(reach_m_);
  fraction_ = 0;
  state_ = std::isfinite(longest_m_) ? State::looking : State::blocked;
  if (state_ == State::looking && poses_ > 0) move_on();
}

// As far as what is left of the last pose's distance reaches.
void ClearWay::move_on() {
  const double left_m = (1 - fraction_) * longest_m_;
  if (budget_m_ >= left_m) {
    budget_m_ -= left_m;
    fraction_ = 1;
    state_ = State::clear;
    return;
  }
  fraction_ += budget_m_ / longest_m_;
  budget_m_ = 0;
}

double ClearWay::keep_half_of_what_is_gained() {
  double least_m = HUGE_VAL;
  const auto keep = [&](double Distances::*of) {
    const double half_gained_m = (at_first_.*of + nearest_.*of) / 2;
    kept_.*of = std::max(kept_.*of, std::min(wanted_.*of, half_gained_m));
    least_m = std::min(least_m, nearest_.*of - kept_.*of);
  };
  keep(&Distances::panel_m);
  keep(&Distances::vehicle_m);
  keep(&Distances::itself_m);
  nearest_ = nowhere_near;
  return least_m;
}

void ClearWay::look(const Surroundings& surroundings) {
  const Distances here = surroundings.distances(from_rad_ + fraction_ * way_rad_, jaw_rad_);
  ++poses_;
  const std::array<double, 3> slacks{here.panel_m - kept_.panel_m, here.vehicle_m - kept_.vehicle_m, here.itself_m - kept_.itself_m};
  const auto* least = std::min_element(slacks.begin(), slacks.end());
  if (*least < least_slack_m_ || std::isnan(*least)) {
    least_slack_m_ = *least;
    barrier_ = static_cast<Barrier>(1 + (least - slacks.begin()));
  }
  if (!(*least >= 0) || poses_ >= max_poses) {
    state_ = State::blocked;
    return;
  }
  nearest_ = {std::min(nearest_.panel_m, here.panel_m), std::min(nearest_.vehicle_m, here.vehicle_m),
              std::min(nearest_.itself_m, here.itself_m)};
  const double high_rad = surroundings.room().jaw.high_rad;
  if (jaw_rad_ < high_rad) {  // the jaw's next angle, for which half of this one's distance vouches
    jaw_rad_ = std::min(high_rad, jaw_rad_ + std::max(*least / 2, resolution_m) / jaw_reach_m_);
    return;
  }
  const bool swept = surroundings.room().jaw.low_rad < high_rad;
  const double slack_m = keep_half_of_what_is_gained();
  budget_m_ = std::max(swept ? slack_m / 2 : slack_m, resolution_m);
  jaw_rad_ = surroundings.room().jaw.low_rad;
  move_on();
}

ClearWay::State ClearWay::advance(const Surroundings& surroundings, int poses) {
  for (int i = 0; i < poses && state_ == State::looking; ++i) look(surroundings);
  return state_;
}

}  // namespace lf::arm
