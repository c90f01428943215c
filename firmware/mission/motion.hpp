// What moves the arm: one motion at a time, planned a share a tick and then stepped once a control period, its target always defined.
//
// Every motion but a stop is looked at along its whole way, with the jaw at every opening it has on it, before it begins: see clear_route.hpp for how far it
// keeps off what. What bars it is its failure.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/arm/trajectory.hpp"
#include "firmware/mission/bar_turn.hpp"
#include "firmware/mission/clear_route.hpp"
#include "firmware/safety/limits.hpp"
#include "firmware/scan/sweep.hpp"
#include "firmware/telemetry.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::mission {

// By how much harder a straight line may press once what it meets is felt, until the arm stands, N: where nothing is meant to be met, and in a press. By their own estimate the
// ARM 5E's lines at their usual speeds come to 168 and 62 N. A stiffer arm, or one that brakes more slowly, goes more slowly.
inline constexpr double approach_push_n = 170, usual_push_n = 65;
// An arm of small levers pushes hard before it feels anything. In a press that and the rise after it are `most_press_n` at most, both by the arm's own estimate, but for a rise of
// `least_push_n`. Simulated presses come to up to 146 N.
inline constexpr double most_press_n = 85, least_push_n = 15;

class Motion {
 public:
  // `limits` bound every motion's positions and speeds. Motions keep clear of a panel of this layout and of the vehicle. Ways through free space may lead
  // by `park_rad`. Arm, layout and vehicle are known by their place.
  Motion(const arm::Arm& arm, const safety::Limits& limits, const PanelLayout& layout, const arm::VehicleShape& vehicle,
         const arm::JointVector& park_rad)
      : arm_(arm), limits_(limits), surroundings_(arm, layout, vehicle), route_(park_rad) {}
  Motion(arm::Arm&&, const safety::Limits&, const PanelLayout&, const arm::VehicleShape&, const arm::JointVector&) = delete;
  Motion(const arm::Arm&, const safety::Limits&, PanelLayout&&, const arm::VehicleShape&, const arm::JointVector&) = delete;
  Motion(const arm::Arm&, const safety::Limits&, const PanelLayout&, arm::VehicleShape&&, const arm::JointVector&) = delete;

  // Where the joints are when power comes on.
  void start_at(const arm::JointVector& q_rad);

  // Orders. Each is planned from the present target, at most 10 us of it a tick on a desktop, and begins when that is done. What cannot be planned
  // leaves the arm at rest where it is, with its reason in failure(). `jaw_rad` is where the jaw is now, one of the room's angles for it.
  void go(std::span<const arm::JointVector> points_rad, double speed_fraction);  // through these points, whatever is there
  // To one place; a joint that stands outside its limits may stay there, or come closer to them.
  void jog(const arm::JointVector& goal_rad, const Room& room, double jaw_rad, double speed_fraction);
  // Through free space.
  void go_clear(const arm::JointVector& goal_rad, const Room& room, double jaw_rad, double speed_fraction);
  // Of the tool.
  void line(const Vec3& goal_m, double goal_roll_rad, const Room& room, double jaw_rad, double speed_m_s, double push_n = approach_push_n);
  // Of the held bar on the room's panel. `pushed_rad`: what the arm gives way by meanwhile; its way is looked at from there.
  void turn(double from_rad, double to_rad, const Room& room, double jaw_rad, double speed_rad_s,
            const arm::JointVector& pushed_rad = arm::JointVector::Zero());
  // Plans a sweep and goes where it begins; `sweep` carries it out, with the jaw at rest where the way there leaves it.
  void go_to_sweep(const scan::SweepRequest& request, const LaserCalibration& laser, const Room& room, double jaw_rad,
                   double speed_fraction);
  void sweep();

  void stop();    // to rest, as fast as the joints' limits allow
  void freeze();  // the target stays as it is
  // To rest on the motion's own way, by stretching its time, and on again; what is still being planned waits. A motion that is ordered meanwhile is not held.
  void hold() { holding_ = true; }
  void resume() { holding_ = false; }

  void step(double dt_s);
  const arm::JointVector& target() const { return target_.q_rad; }
  bool done() const { return kind_ == Kind::rest; }
  bool planning() const { return kind_ >= Kind::plan_route; }
  StepFailure failure() const { return failure_; }  // of the last order
  bool paused() const { return rate_ == 0; }
  double elapsed_s() const { return t_s_; }
  double duration_s() const { return duration_s_; }
  std::uint32_t begun() const { return begun_; }                // motions, planning of them included
  double handle_rad() const { return turn_.handle_rad(t_s_); }  // the bar's angle now, in the turn under way or just over
  const scan::SweepPlan& sweep_plan() const { return sweep_planner_.plan(); }
  // The sweep is between its run-up and its run-out.
  bool cruising() const { return kind_ == Kind::sweep && t_s_ >= sweep_.cruise_start_s() && t_s_ <= sweep_.cruise_end_s(); }

  arm::JointLimits limits(double speed_fraction) const;

 private:
  enum class Kind : std::uint8_t {
    rest,
    path,
    line,
    sweep,
    turn,
    stop,
    plan_route,
    plan_line,
    plan_sweep,
    look_at_sweep,
    look_at_jog,
    look_at_turn
  };
  void begin(Kind kind, double duration_s);
  void refuse(StepFailure failure);
  void plan_route(const arm::JointVector& goal_rad);
  // Begins the way from here, to be looked at.
  void begin_way(const Room& room, double jaw_rad);
  void advance_plan();
  void advance_route();
  void advance_line();
  void advance_sweep();
  void advance_sweep_way();
  // Looks on along the way; begins the motion of this kind when all of it is clear.
  void advance_way(Kind then, double duration_s);

  const arm::Arm& arm_;
  safety::Limits limits_;
  Kind kind_ = Kind::rest;
  double t_s_ = 0;
  double duration_s_ = 0;
  bool holding_ = false;
  std::uint32_t begun_ = 0;
  double rate_ = 1;  // of the motion's time to the clock's
  arm::JointState target_;
  arm::JointPath path_;
  arm::CartesianLine line_;
  arm::ConstantSpeedSweep sweep_;
  BarTurn turn_;
  arm::JointStop stop_;
  arm::Surroundings surroundings_;
  ClearRoute route_;
  arm::ClearWay way_;  // of what is no way through free space
  scan::SweepPlanner sweep_planner_;
  // Of the order that is being planned.
  double jaw_rad_ = 0;
  double speed_fraction_ = 0;
  StepFailure failure_ = StepFailure::none;
};

}  // namespace lf::mission
