#include "firmware/arm/clear_way.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/arm/planar_chain.hpp"

namespace lf::arm {
namespace {

// How far from each joint's axis any point of what it moves can be, at most, in whatever pose the joints after it are.
JointVector reach_m(double jaw_rad) {
  constexpr std::size_t forearm = 3, wrist = 4;  // scene::BodyId
  const LinkPoses links = base_from_links(JointVector::Zero(), jaw_rad);
  const Vec3 elbow = links[forearm - 1].translation();
  const Vec3 roll_axis = links[wrist - 1].linear().col(2);
  double from_roll_axis = 0, from_elbow = 0;
  for (const Capsule& capsule : link_capsules(JointVector::Zero(), jaw_rad)) {
    if (capsule.link < forearm) continue;
    for (const Vec3& end : {capsule.a_m, capsule.b_m}) {
      const double aside = (end - links[wrist - 1].translation()).cross(roll_axis).norm();
      if (capsule.link >= wrist) from_roll_axis = std::max(from_roll_axis, aside + capsule.radius_m);
      // The roll carries it round an axis that passes the elbow at a2.
      from_elbow = std::max(from_elbow, std::hypot(std::abs(a2_m) + aside, (end - elbow).dot(roll_axis)) + capsule.radius_m);
    }
  }
  const double from_shoulder = std::abs(a1_m) + from_elbow;
  return {std::abs(a0_m) + from_shoulder, from_shoulder, from_elbow, from_roll_axis};
}

}  // namespace

void ClearWay::begin(const JointVector& from_rad, const JointVector& to_rad, double jaw_rad, const Pose& base_from_panel, double wanted_m) {
  from_rad_ = from_rad;
  way_rad_ = to_rad - from_rad;
  jaw_rad_ = jaw_rad;
  base_from_panel_ = base_from_panel;
  wanted_m_ = wanted_m;
  longest_m_ = way_rad_.cwiseAbs().dot(reach_m(jaw_rad));
  fraction_ = 0;
  poses_ = 0;
  nearest_ = {HUGE_VAL, 0, PanelPart::none};
  state_ = std::isfinite(longest_m_ + jaw_rad + wanted_m) && base_from_panel.matrix().allFinite() ? State::looking : State::blocked;
}

ClearWay::State ClearWay::advance(const PanelShape& panel, int poses) {
  for (int i = 0; i < poses && state_ == State::looking; ++i) {
    const Clearance here = panel.clearance(link_capsules(from_rad_ + fraction_ * way_rad_, jaw_rad_), base_from_panel_);
    ++poses_;
    if (here.distance_m < nearest_.distance_m) nearest_ = here;
    if (!(here.distance_m >= wanted_m_) || poses_ >= max_poses) {
      state_ = State::blocked;
    } else if (fraction_ >= 1 || longest_m_ == 0) {
      state_ = State::clear;
    } else {
      fraction_ = std::min(1.0, fraction_ + std::max(here.distance_m - wanted_m_, resolution_m) / longest_m_);
    }
  }
  return state_;
}

}  // namespace lf::arm
