// A way for the arm through free space, found a few poses a tick: straight where that keeps clear of everything, else by the park position. An arm of another form
// than the planar one has more ways to fold: of it the joints of the hand's side go first, or those of the base's side, from each joint on, and where that
// does not do, a posture in between is drawn at random, with a fixed seed.
//
// Clear is 10 mm between links, known to their capsules, and the panel, grown by what is not known of its place, the vehicle, and the arm itself, with the
// jaw at every opening it has on the way, and the tool keeps to its workspace. Where the arm stands nearer than that to one of them it may leave, but come no nearer to that one. A route that
// is not clear all along is none: nothing is risked for it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/arm/clear_way.hpp"
#include "firmware/mission/step_failure.hpp"
#include "firmware/safety/limits.hpp"

namespace lf::mission {

using arm::Room;

// Calibration, quantisation, and how far a drive lags behind on a bent way.
inline constexpr double clearance_m = 0.010;

// The clearance wanted of a motion that begins where the arm stands, with its jaw there.
arm::Distances wanted_from(const arm::JointVector& from_rad, double jaw_rad, const arm::Surroundings& surroundings);
inline constexpr arm::Distances wanted_everywhere{clearance_m, clearance_m, clearance_m};

// Why there is no way.
StepFailure failure_of(arm::Barrier barrier);

class ClearRoute {
 public:
  enum class State : std::uint8_t { looking, found, none };

  // 8 us a tick on a desktop.
  static constexpr int poses_a_share = 8;

  explicit ClearRoute(const arm::JointVector& park_rad) : park_rad_(park_rad) {}

  // `jaw_rad`: where it is now.
  void begin(const arm::JointVector& from_rad, const arm::JointVector& to_rad, double jaw_rad, const arm::Surroundings& surroundings);
  // `limits` of the mission: of the joints' positions, which a posture in between keeps, and of the tool's workspace.
  State advance(const arm::Surroundings& surroundings, const safety::Limits& limits);
  // Once found: where to go, after the start.
  std::span<const arm::JointVector> points_rad() const { return points_; }
  // What bars the straight way, when there is none.
  arm::Barrier barrier() const { return barrier_; }

 private:
  enum class Leg : std::uint8_t { straight, to_via, from_via };
  void look_at(Leg leg, const arm::Surroundings& surroundings);
  bool keeps_to_workspace(const arm::Arm& arm, const safety::Limits& limits) const;  // on this leg
  // Puts the next place to go by into via_[0]; false when there is no other.
  bool next_via(const arm::Arm& arm, const safety::Limits& limits);
  void draw_via(const arm::Arm& arm, const safety::Limits& limits);

  arm::JointVector park_rad_;
  arm::ClearWay way_;
  Leg leg_ = Leg::straight;
  std::uint32_t vias_ = 0;  // tried
  int looked_at_ = 0;       // poses, of all legs before this one
  arm::JointVector from_rad_ = arm::JointVector::Zero();
  arm::Distances leaving_;  // the clearance wanted of what begins at the start
  arm::Barrier barrier_ = arm::Barrier::none;
  std::array<arm::JointVector, 2> via_{arm::JointVector::Zero(), arm::JointVector::Zero()};  // place to go by, and goal
  std::span<const arm::JointVector> points_;
};

}  // namespace lf::mission
