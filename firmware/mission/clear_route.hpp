// A way for the arm through free space, found a few poses a tick: straight where that keeps clear of the panel, else by the park position.
//
// Between links, known to their capsules, and the panel, known before the first look to the docking error of 20 mm, 15 mm stay free. Where the arm
// stands nearer than that it may leave, but come no nearer. A route that is not clear all along is none: nothing is risked for it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/arm/clear_way.hpp"

namespace lf::mission {

// What the arm has to keep clear of, and how wide it is.
struct Room {
  Pose base_from_panel = Pose::Identity();
  double jaw_rad = 0;
};

class ClearRoute {
 public:
  enum class State : std::uint8_t { looking, found, none };

  static constexpr double clearance_m = 0.015;
  // 3 us a tick on a desktop.
  static constexpr int poses_a_share = 3;

  ClearRoute(const PanelLayout& layout, const arm::JointVector& park_rad) : panel_(layout), park_rad_(park_rad) {}

  void begin(const arm::JointVector& from_rad, const arm::JointVector& to_rad, const Room& room);
  State advance();
  // Once found: where to go, after the start.
  std::span<const arm::JointVector> points_rad() const { return points_; }

 private:
  enum class Leg : std::uint8_t { straight, to_park, from_park };
  void look_at(Leg leg);

  arm::PanelShape panel_;
  arm::JointVector park_rad_;
  arm::ClearWay way_;
  Room room_;
  Leg leg_ = Leg::straight;
  arm::JointVector from_rad_ = arm::JointVector::Zero();
  double leaving_m_ = 0;  // the clearance wanted of what begins at the start
  std::array<arm::JointVector, 2> via_{arm::JointVector::Zero(), arm::JointVector::Zero()};  // park and goal
  std::span<const arm::JointVector> points_;
};

}  // namespace lf::mission
