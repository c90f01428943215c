// What moves the arm: one planned motion at a time, stepped once a control period, its target always defined.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/arm/trajectory.hpp"
#include "firmware/mission/bar_turn.hpp"
#include "firmware/safety/limits.hpp"
#include "firmware/scan/sweep.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::mission {

class Motion {
 public:
  // `limits` bound every motion's positions and speeds.
  explicit Motion(const safety::Limits& limits) : limits_(limits) {}

  // Where the joints are when power comes on.
  void start_at(const arm::JointVector& q_rad);

  // Each plans from the present target and begins with the next step. False, and at rest where it is, when it cannot be planned.
  bool go(std::span<const arm::JointVector> points_rad, double speed_fraction);
  bool line(const Vec3& goal_m, double goal_roll_rad, double speed_m_s);
  // Plans the sweep; `sweep_start_rad` is where to go before, `sweep` carries it out.
  bool plan_sweep(const scan::SweepPlan& plan);
  arm::JointVector sweep_start_rad() const { return sweep_.start_rad(); }
  bool sweep();
  bool turn(const Mat3& base_from_panel, double from_rad, double to_rad, double speed_rad_s);

  void stop();    // to rest, as fast as the joints' limits allow
  void freeze();  // the target stays as it is
  // To rest on the motion's own way, by stretching its time, and on again. A motion that is begun meanwhile is not held.
  void hold() { holding_ = true; }
  void resume() { holding_ = false; }

  void step(double dt_s);
  const arm::JointVector& target() const { return target_.q_rad; }
  bool done() const { return kind_ == Kind::rest; }
  bool paused() const { return rate_ == 0; }
  double elapsed_s() const { return t_s_; }
  double duration_s() const { return duration_s_; }
  // The sweep is between its run-up and its run-out.
  bool cruising() const { return kind_ == Kind::sweep && t_s_ >= sweep_.cruise_start_s() && t_s_ <= sweep_.cruise_end_s(); }

  arm::JointLimits limits(double speed_fraction) const;

 private:
  enum class Kind : std::uint8_t { rest, path, line, sweep, turn, stop };
  void begin(Kind kind, double duration_s);

  safety::Limits limits_;
  Kind kind_ = Kind::rest;
  double t_s_ = 0;
  double duration_s_ = 0;
  bool holding_ = false;
  double rate_ = 1;  // of the motion's time to the clock's
  arm::JointState target_;
  arm::JointPath path_;
  arm::CartesianLine line_;
  arm::ConstantSpeedSweep sweep_;
  BarTurn turn_;
  arm::JointStop stop_;
};

}  // namespace lf::mission
