// The jaw: opens, closes, and knows held from empty by where it stalls and by the torque it takes to stay there.
#pragma once

#include <cstdint>

#include "firmware/arm/transmission.hpp"
#include "shared/arm/arm_model.hpp"
#include "shared/messages/time.hpp"

namespace lf::arm {

// Distance between the pads' faces at their centres, m, negative where they would overlap; and the jaw angle for a distance (clamped to the limits).
// At jaw angle 0 the pads are parallel.
double gap_from_jaw(const ArmModel::Jaw& jaw, double jaw_rad);
double jaw_from_gap(const ArmModel::Jaw& jaw, double gap_m);
// Force of each pad, at its centre and square to its face, for a jaw torque that both fingers share, N. 20 N m of the ARM 5E give 101 N.
double pad_force_n(const ArmModel::Jaw& jaw, double jaw_torque_nm);
// How far the fingers reach beyond the tool point along the tool axis, m.
double tip_beyond_tool_m(const ArmModel::Jaw& jaw, double jaw_rad);

// The thinnest bar that a closed jaw is told from: at its stop 1.3 mm of the ARM 5E's stay open, and a stall within `bar_tolerance_m` of the bar counts as a grip.
inline constexpr double thinnest_bar_of_any_m = 0.008;
double thinnest_bar_m(const ArmModel::Jaw& jaw);
// Closed to its stop, which leaves no more than some millimetres. An angle beyond the stop is one of a false zero, and tells nothing.
bool stands_closed(const ArmModel::Jaw& jaw, double jaw_rad);
// The fingers hold nothing of a jaw that stands so: closed, or open for reaching for such a bar. Open, they may still stand around it.
bool stands_empty(const ArmModel::Jaw& jaw, double jaw_rad, double bar_m);
// How far the jaw opens to reach for a bar: to either side `reaching_room_m` more than the bar is thick.
double jaw_opening_m(const ArmModel::Jaw& jaw, double bar_m);
// The thickest bar that the jaw opens for.
double thickest_bar_m(const ArmModel::Jaw& jaw);

struct GripperConfig {
  double bar_m = 0.0126;                  // what is to be held: its thickness
  double bar_tolerance_m = 0.006;         // a stall within this of it is plausible: tilt, and the bar off the pads' middle
  double grip_torque_nm = 6.0;            // to be reached before a stall counts as a grip
  double hold_torque_nm = 2.0;            // less than this while holding, for `low_torque_samples`: nothing is between the pads
  std::uint32_t low_torque_samples = 25;  // 0.1 s: turning the handle unloads the pads for shorter
  double closing_speed_rad_s = 0.25;
  double opening_speed_rad_s = 0.4;
  double ramp_rad_s2 =
      2.0;  // to the speed, from rest: a drive that is told to stop meanwhile has no more to brake than what it has reached
  double lead_rad =
      0.05;  // the target runs ahead of the jaw by at most this: the squeeze while holding, and below the drive's following-error window
  double stall_rad = 0.002;  // less movement than this within `stall_time` is a stall; 4 encoder counts
  Duration stall_time = Duration::from_ms(150);
  Duration lost_time = Duration::from_ms(300);      // so long without an answer; the jaw may have gone 0.15 rad meanwhile
  double wrong_way_rad = 0.05;                      // farther from the goal than it was by this: the drive goes its own way
  double slip_rad = 0.03;                           // closing further than this from the grip while holding: it slipped out
  double snap_rad = 0.01;                           // the same, at once: faster than pads creep
  double creep_s = 0.3;                             // pads that creep by less than snap_rad in this time hold: 0.033 rad/s; 0.013 was seen
  Duration move_timeout = Duration::from_ms(8000);  // the full stroke takes 5.6 s at the closing speed
};

// Of a jaw with other speeds, torques, stroke or encoder than the ARM 5E's, whose numbers stand above: the same shares of its own.
GripperConfig gripper_config(const ArmModel::Joint& joint);

enum class GripperState : std::uint8_t {
  idle,     // holds its position
  opening,  // or on the way to an angle that turn_to() named
  open,     // at the wanted opening
  closing,
  held,     // stalled on something as thick as the bar
  empty,    // closed to its stop, nothing between the pads
  dropped,  // was held, and is no more
  jammed,   // stalled where it should not: on something thicker or thinner than the bar; or took too long
  // Its encoder or its drive is not to be trusted. Told to move, it stands without a load, pushes the other way, or goes the other way; or it presses though
  // it is open.
  lost,
};

class Gripper {
 public:
  explicit Gripper(const ArmModel::Jaw& jaw, const GripperConfig& config = {}) : jaw_(jaw), config_(config) {}

  // What is to be held from now on: its thickness, and within how much of it a stall is plausible.
  void expect_bar(double bar_m, double bar_tolerance_m) {
    config_.bar_m = bar_m;
    config_.bar_tolerance_m = bar_tolerance_m;
  }
  // Orders. The next update() begins them.
  void open_to(double gap_m);
  void turn_to(double jaw_rad);  // an angle, either way; ends as `open` there, or `jammed`
  void close();
  void stay();  // idle at the present position
  // `d` passes without update() being called, and does not count for stalls and time-outs: the operator holds the arm.
  void wait(Duration d);

  // One SYNC: the jaw's measured angle and torque in; the angle to command out. A grip is believed when the torque surely reaches it, a loss when the
  // torque surely is less. A sample that is not a number, or not later than the one before,
  // is refused and counted, and the last target stands.
  double update(Time t, double jaw_rad, const TorqueEstimate& torque);
  double update(Time t, double jaw_rad, double exact_nm) { return update(t, jaw_rad, TorqueEstimate{exact_nm, exact_nm, exact_nm}); }

  // An order that waits for its update() counts as begun: who asks in between must not take the last one's end for its own.
  GripperState state() const;
  // Something may be between the pads: the jaw stands neither closed nor open, or it is in doubt.
  bool may_hold(double jaw_rad) const;
  // A reset makes a new gripper, and does not free the jaw: where the old one was in doubt the new one is, too, until the jaw is seen to move.
  void doubt() { doubted_ = true; }
  bool doubted() const;  // also while it closes, and where the last order ended held, dropped, jammed or lost
  double target_rad() const { return target_rad_; }
  double grip_gap_m() const { return grip_gap_m_; }  // at which it stalled; 0 before
  std::uint32_t refused() const { return refused_; }

 private:
  enum class Order : std::uint8_t { none, stay, open, close };

  void begin(Time t, double jaw_rad);
  void move(Time t, double jaw_rad, const TorqueEstimate& torque, double dt_s);
  void stalled(double jaw_rad, const TorqueEstimate& torque);
  void hold(double jaw_rad, const TorqueEstimate& torque, double dt_s);
  void rest(Time t, double jaw_rad, const TorqueEstimate& torque);

  ArmModel::Jaw jaw_;
  GripperConfig config_;
  GripperState state_ = GripperState::idle;
  Order order_ = Order::stay;
  double goal_rad_ = 0;
  double target_rad_ = 0;
  double grip_rad_ = 0;
  double crept_rad_ = 0;  // where the jaw holds, less what is fast
  double grip_gap_m_ = 0;
  double nearest_rad_ = 0;                      // to the goal, since the order
  double still_rad_ = 0;                        // where the jaw was when it last moved
  Time still_since_, began_, last_, unloaded_;  // the last: when nothing pressed on the open jaw
  bool started_ = false;
  bool doubted_ = false;
  double doubted_rad_ = 0;  // where the jaw was first seen in doubt
  std::uint32_t low_torque_run_ = 0;
  std::uint32_t refused_ = 0;
};

}  // namespace lf::arm
