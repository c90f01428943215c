// Commissioning: what each drive's absolute encoder counts where the arm's own count is 0, and how its motor and gear rub.
//
// One joint after the other is powered, moved slowly against a stop with a third of its rated torque (a screw: two thirds), eased off until it only touches, read there, moved
// both ways at two speeds over a stretch that it has just passed, from which friction_fit.hpp has its friction, moved back to where it was, and released: the stop's angle is known from the arm's description.
// The jaw comes first and is closed: what it held is let go of, and what is still between its fingers would be dragged along, or meets them when the arm moves.
// Without it the arm's joints are moved only where the jaw is known to stand closed. A joint whose earlier zero was found elsewhere ends it in failure: its
// stop may have been something else. A joint that presses has wound up its gear: read under that torque the slew would be 0.4 deg off.
// The drives' own references are not touched. A plain object like the core, run by the control thread in the core's place: frames and the time in, frames
// out, no heap. It stands on the core's own network and axes.
//
// Whatever ends it early is an emergency stop of category 1 (firmware/safety/power.hpp), and of category 0 where another master sends set points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/arm/transmission.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/safety/power.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/vehicle/friction_fit.hpp"
#include "hal/vehicle/joint_set.hpp"
#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

class Commissioning {
 public:
  struct Config {
    arm::Arm arm = arm::arm5e();
    JointNames names;
    canopen::NetworkConfig network;
    JointSet joints = all_joints();
    PerJoint<double> backlash_rad{};  // of each gear, as the arm's description has it: the motor touches half of it beyond the stop
    PerJoint<arm::TransmissionSetup> transmissions;  // their friction, as far as it is known before
    // Known there or doubtful: compared with, beside the zero that is known in `network`.
    PerJoint<std::optional<std::int32_t>> zero_in_file;
    bool moved = false;           // its encoder or its stop was changed: its zero may be elsewhere
    bool here = false;            // the arm stands at its zero, in a jig: nothing is moved
    bool jaw_known = false;       // its zero in `network` is true, and its encoder is believed
    double speed_fraction = 0.3;  // of each drive's maximum: 0.13 rad/s of the slew, above its stiction of 0.06
    // Of the rated torque: free motion under water takes less than a fifth. At a stroke's end a screw has a third of its lever left: with less than two
    // thirds of the torque the arm's weight stops the shoulder short.
    std::uint16_t gear_permille = 350, screw_permille = 700;
    double slow_fraction = 0.2, fast_fraction = 0.4;  // of each drive's maximum speed, while its friction is found
    double ease_fraction = 0.02;                      // of each drive's maximum speed: 0.007 rad of winding take the slew a second
    Duration stall = Duration::from_ms(600);          // pressing without a count for so long is standing at the stop
    Duration longest = Duration::from_ms(150'000);    // of one joint; more where its stroke takes more, there and back
  };

  enum class State : std::uint8_t {
    booting,
    enabling,
    seeking,       // toward the stop
    easing,        // off it, until it only touches
    rubbing,       // both ways over a stretch, twice
    backing_off,   // to where the joint was; the jaw: closed
    releasing,     // the joint loses power
    halting,       // ended early: quick stop
    powering_off,  // and without power, as soon as it stands
    stopping,      // the nodes are told to stop
    done,
    failed
  };

  explicit Commissioning(const Config& config);
  Commissioning(const Commissioning&) = delete;  // what takes the power knows the arm by its place
  Commissioning& operator=(const Commissioning&) = delete;

  void on_frame(const CanFrame& frame, Time t) { network_.on_frame(frame, t); }
  const canopen::IoModule& io() const { return network_.io(); }
  // Before its first tick: its drive has lost its position, as somebody else has heard.
  void lose_zero(std::size_t joint) { network_.axis(joint).lose_zero(); }
  void tick(Time now, canopen::Outbox& outbox);
  // Stops what moves, takes the power, and ends as failed for this reason. The first reason holds.
  void stop(const char* why);
  void emergency_stop(const char* why);
  // By an order, the input, or the chain, at any time before the end: a reset has to come before anything else.
  bool emergency_stopped() const { return emergency_stopped_; }

  State state() const { return state_; }
  bool ended() const { return state_ == State::done || state_ == State::failed; }
  std::string_view failure() const { return failure_.data(); }
  // No drive that this one powered has power: each has said so since. A drive that is no longer heard counts as powered.
  bool without_power() const;
  std::size_t joint() const { return joint_; }  // under work
  // How long one joint may take.
  static Duration longest(const ArmModel::Joint& joint, const Config& config);
  const PerJoint<std::int32_t>& zero_counts() const { return zero_counts_; }
  const PerJoint<bool>& found() const { return found_; }
  // By how much a zero is off the one known in `network`, or the file's, whichever is farther, where it is more than told_move_rad; 0 otherwise.
  const PerJoint<double>& moved_rad() const { return moved_rad_; }
  // Joints whose drive said that it has lost its position, less those that were found after it.
  PerJoint<bool> zeros_lost() const;
  // Joints whose drive said that it has lost its position before they were found: no earlier zero of theirs means anything.
  PerJoint<bool> lost_before_found() const;
  // Where each zero is found: the joint's stop, in a jig 0.
  PerJoint<double> places_rad() const;
  // Not found for a joint that had too little way to its stop, or whose torques make no sense.
  const PerJoint<bool>& friction_found() const { return friction_found_; }
  const PerJoint<config::JointFriction>& friction() const { return friction_; }

 private:
  canopen::Axis& axis() { return network_.axis(joint_); }
  void go(State state, Time now);
  void fail(const char* why, Time now);
  void fail_joint(const char* why, Time now);
  void note_power(Time now);
  void watch(Time now);
  bool hear_set_points();
  bool presses_too_hard();
  void fail_pressing(Time now);
  void step(Time now);
  // Before the first: why none may be moved, if so.
  const char* why_not() const;
  void begin_work(Time now);
  void next_joint(Time now);
  void take_here(Time now);
  void take_zero(std::size_t joint, std::int32_t zero_counts);
  double off_earlier_rad(std::size_t joint) const;
  double stop_rad(std::size_t joint) const;
  double shut_rad() const;
  safety::JointStates joint_states(Time now) const;
  bool ends_elsewhere(std::size_t joint, Time now);
  void seek(Time now);
  void ease(Time now);
  double coulomb_permille();
  void begin_rubbing(Time now);
  void rub(Time now);
  void end_rubbing();
  void end_joint(Time now);
  void back_off(Time now);
  void reopen(Time now);  // the jaw, which met something on its way to being closed
  bool stands(Time now, bool pressing);
  std::size_t joint_count() const { return config_.arm.joint_count(); }
  bool is_jaw(std::size_t joint) const { return joint == config_.arm.jaw_joint(); }
  // The jaw first: what it held has then been let go of.
  std::size_t in_turn(std::size_t turn) const { return turn == 0 ? config_.arm.jaw_joint() : turn - 1; }
  // The jaw's lower stop may be met by what is between its fingers.
  double direction(std::size_t joint) const { return is_jaw(joint) ? 1 : -1; }
  double off_stop_counts() const;
  double started_off_stop() const;  // where it was, off the stop
  double goal_counts() const;       // where it is left

  Config config_;
  canopen::Network network_;
  safety::Power power_;
  State state_ = State::booting;
  bool booted_ = false;
  const char* stop_reason_ = nullptr;
  bool emergency_stopped_ = false;
  PerJoint<bool> powered_{};  // asked to take power, and not heard to be without it since
  std::array<char, 200> failure_{};
  std::size_t turn_ = 0;  // of the joints, in their order
  std::size_t joint_ = 0;
  PerJoint<std::int32_t> zero_counts_{};
  PerJoint<bool> found_{};
  PerJoint<double> moved_rad_{};
  PerJoint<std::uint32_t> losses_when_found_{};  // of each zero
  PerJoint<bool> friction_found_{};
  PerJoint<config::JointFriction> friction_{};
  Time since_;        // in this state
  Time joint_since_;  // with this joint
  Time moved_;        // when it last counted
  std::int32_t last_counts_ = 0;
  std::uint32_t foreign_frames_ = 0;  // of another master, before the boot was done
  std::uint32_t set_points_ = 0;      // RPDOs among them, so far
  double target_ = 0;                 // counts
  std::int32_t started_counts_ = 0;   // where it was powered
  double pressed_permille_ = 0;       // torque when it stood at the stop
  std::int32_t pressed_counts_ = 0;
  bool reopening_ = false;                     // the jaw met something on its way to being closed
  int too_hard_ticks_ = 0;                     // in a row
  double pressed_load_ = 0;                    // what of it the stop felt
  std::optional<std::int32_t> easing_counts_;  // where the load began to fall
  double easing_load_ = 0;                     // and the load there
  double stop_counts_ = 0;                     // where it only touches
  FrictionFit fit_;
  double rub_from_ = 0, rub_to_ = 0;  // the stretch, counts
  double rub_speed_ = 0;              // counts/s
  std::optional<std::size_t> pass_;   // of the fit's; none on the way to the stretch
};

const char* name(Commissioning::State state);

}  // namespace lf::hal
