// What every step of the mission works with, and what outlives the steps: the joints, what moves them, the camera, what is known of the panel, the job.
#pragma once

#include <optional>

#include "firmware/arm/compliance.hpp"
#include "firmware/arm/gripper.hpp"
#include "firmware/arm/guarded_motion.hpp"
#include "firmware/arm/tool_place.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/config.hpp"
#include "firmware/mission/camera_work.hpp"
#include "firmware/mission/job.hpp"
#include "firmware/mission/motion.hpp"
#include "firmware/mission/order_mailbox.hpp"
#include "firmware/mission/panel_map.hpp"
#include "firmware/mission/progress.hpp"
#include "firmware/safety/fault_arbiter.hpp"
#include "firmware/safety/power.hpp"
#include "firmware/safety/watch.hpp"
#include "firmware/telemetry.hpp"

namespace lf::mission {

// What the mission is about to do.
enum class Course : std::uint8_t {
  working,    // on its job
  retrying,   // the task under way is taken again after the way back
  giving_up,  // the mission failed and is on its way to a safe end
};

// A contact in motion that may touch nothing: what free motion takes of torque is learned on the way; how much more is a contact, the limits say, and for
// a joint half of its own limit if that is less; so is seven tenths of that limit, however slowly it came. The overload is the watch's.
arm::GuardConfig free_motion_guard(const arm::Arm& arm, const safety::Limits& limits);
// Of a way on which touching what is meant begins: a smaller rise, since the pads may brush the bar.
arm::GuardConfig approach_guard(const arm::Arm& arm, const safety::Limits& limits);
// How an arm that grips gives way: the stronger the arm, the less for a newton metre.
arm::ComplianceConfig gripping_compliance(const arm::Arm& arm, const safety::Limits& limits);
// How many times stronger than the default arm this one is: what the limits take for a contact over the default's. The mission's rules have the default arm's torques, and
// multiply them by this. Joint by joint (of the roll: 1), and of the weakest joint that points the tool.
arm::JointVector strengths(const arm::Arm& arm, const safety::Limits& limits);
double strength(const arm::Arm& arm, const safety::Limits& limits);
// The rise of each joint's torque that says a button has bottomed: `press_torque_nm`, or what lies above a strong arm's friction and ringing.
arm::JointVector bottom_torques_nm(const arm::Arm& arm, const safety::Limits& limits, double press_torque_nm);
// By how much harder a press may push once it is felt, N, if it takes `felt_n` to be felt.
double press_push_n(double felt_n);

// A joint stays behind its target, and nothing holds it back: its encoder or its drive is not to be trusted.
bool lags_without_load(const arm::Arm& arm, const arm::GuardedMotion& guard);
// It pushes its joint away from the set-point: a drive that has run off. What is touched makes a drive push towards its set-point.
bool runs_off(const arm::GuardedMotion& guard);
// Its motor's torque is what moves it otherwise than its set-point: what is touched pushes against the motor. Or it leaves its set-point at a speed to which
// no contact drives a joint: a contact stops it.
bool drives_itself_off(const arm::Arm& arm, const arm::GuardedMotion& guard);
// Its torque rises while it stands where it should go: the motor or its gear has seized, or something leans on it and keeps it from beginning. A joint that
// meets something on its way winds up its gear.
bool has_seized(const arm::Arm& arm, const arm::GuardedMotion& guard);
// One of them: what was felt is the drive's own doing, and no contact.
bool does_not_follow(const arm::Arm& arm, const arm::GuardedMotion& guard);

// A guard that began under an overload, at a joint that pushes towards its target and is farther behind than a drive that follows.
bool was_behind_before(const arm::Arm& arm, const arm::GuardedMotion& guard);

struct StepTick;

struct Workbench {
  explicit Workbench(const ControllerConfig& told);
  Workbench(const Workbench&) = delete;  // much knows the arm and the layout by their place
  Workbench& operator=(const Workbench&) = delete;

  MissionSetup config;
  safety::Watch watch;
  CameraWork camera;
  Motion motion;
  PanelMap map;
  Job job;
  arm::Gripper gripper;           // of the job's task
  arm::Compliance compliance;     // of the arm while it grips
  arm::GuardedMotion grip_guard;  // of the same: what leaves its place by more than that gives way is driven off it
  arm::GuardedMotion back_guard;  // of the way out of a contact
  OrderMailbox mailbox;
  Course course = Course::working;
  safety::Power power;
  bool powered = false;            // the joints follow the motion
  Vec3 standoff_m = Vec3::Zero();  // where the straight motions of a task start, and where they return to
  double tool_roll_rad = 0;        // of the tool at the standoff
  double turn_goal_rad = 0;        // turn_valve: where the turn under way ends; short of the task's angle when another one follows

  bool turn_ended = false;  // the jaw has turned all the way there
  // A jaw that knows how thick the task's bar is.
  arm::Gripper new_gripper() const;
  // The bar of the task under way, or, where that is none, the panel's thickest; and how far the jaw opens to reach for it.
  double bar_m() const;
  double jaw_open_m() const { return arm::jaw_opening_m(jaw(), bar_m()); }
  // Tasks are not planned for every arm: of any other an operator homes and jogs the joints.
  bool may_work() const { return arm::can_work(config.arm); }
  // Something may be between the pads, the panel's thickest bar as well as the task's.
  bool jaw_may_hold() const;
  const MissionConfig& mission() const { return config.mission; }
  const ArmModel::Jaw& jaw() const { return config.arm.jaw(); }
  std::size_t roll() const { return config.arm.roll_joint(); }
  arm::JointVector measured_rad() const;
  arm::JointVector measured_rad_s() const;
  arm::JointTorques measured_nm() const;
  double jaw_rad() const { return watch.joints().position_rad[config.arm.jaw_joint()]; }
  // What is around the arm, as far as it is known, while the jaw goes from where it is to `jaw_goal_rad`. The fingers may touch the parts `meant`.
  Room room(double jaw_goal_rad, arm::PanelParts meant = 0) const;
  // What the fingers are to touch in the task under way: the handle with its stem, or the button, before the plate that its cap stands on.
  arm::PanelParts meant_parts() const;
  // Ways through free space: the jaw opens to this, or closes (0), on the way. It does not move before the way is found to be clear with it.
  void go_clear(const arm::JointVector& goal_rad, double jaw_opening_m);
  void go_to_sweep(scan::SweepRequest request);  // with the jaw closing, seen by the camera
  Progress follow_way();
  // A straight motion of the tool with the jaw as it is.
  void go_straight(const Vec3& goal_m, double roll_rad, double speed_m_s, arm::PanelParts meant);
  // The same into what is meant to stop it. It is felt at `felt_n`.
  void press_straight(const Vec3& goal_m, double roll_rad, double speed_m_s, double felt_n, arm::PanelParts meant);
  // Done when the motion is; failed when the motion could not be planned.
  Progress follow_motion() const;
  // The task under way is at its beginning again.
  void take_up_task();

  // The guard learns of the arm on its motion's way.
  void feel(arm::GuardedMotion& guard, Time t) const;
  // The first of slew, shoulder and elbow that may run off unseen.
  std::optional<std::size_t> unseen_joint() const;
  // Of what it has felt: the joint that makes it no contact, by its drive's own doing. One that may run off unseen may have pushed the arm so that another joint
  // feels it.
  std::optional<std::size_t> misled_joint(const arm::GuardedMotion& guard) const;
  // Reports what the guard has felt: a contact that is not meant, or a joint that does not follow.
  void report_touch(const arm::GuardedMotion& guard, safety::FaultArbiter& faults) const;

  // The motion's target and what the arm has given way by. Giving way ends at the joints' limits.
  arm::JointVector pushed_target() const;
  // The compliance offset becomes part of the target, so that the arm does not spring back.
  void stay_where_pushed();
  // The roll's target becomes its position: the torque that it has wound up against the handle is let off.
  void let_off_roll();
  // The arm's targets become its positions: it presses on nothing, and a drive whose encoder stands still is not driven on.
  void stay_where_measured();
  // Straight back to the stand-off, under guard: whoever leaves a contact may touch nothing new. After a press the arm is wound up against the button: what it
  // lets off on its first millimetres is no contact. A joint that does not follow is one, or a fault where no load holds it.
  void begin_back_off();
  Progress follow_back_off(const StepTick& tick);
  void watch_back_off_on_hold(const StepTick& tick);
  bool wound_up = false;  // against a button

 private:
  void expect_bar(arm::Gripper& of) const;
  Room room_on_the_way(double jaw_opening_m);
  void guard_back_off(Time now);
  std::optional<std::size_t> misled_on_the_way_back() const;
  Vec3 back_from_m_ = Vec3::Zero();
  std::optional<double> jaw_order_m_;  // what the jaw does once the way is clear
};

// One tick of one step: its surroundings.
struct StepTick {
  Time now;
  const Step& step;
  canopen::Network& network;
  ScanOrders& orders;
  Telemetry& telemetry;
  Workbench& bench;
  safety::FaultArbiter& faults;
  StepClock& clock;

  bool settled(bool condition, Duration for_how_long) const { return clock.settled(condition, for_how_long, now); }
  void event(Event::Kind kind, double value = 0, std::int32_t code = 0) const;
  // A scan order that finds no room is a port error.
  void send(const ScanCommand& command) const;
};

// What was felt: the contact of the joint that felt it, or, where there is one, the joint that does not follow.
void report_felt(std::optional<std::size_t> misled, std::size_t felt_by, safety::FaultArbiter& faults);

}  // namespace lf::mission
