#include "firmware/mission/mission.hpp"

namespace lf::mission {

namespace {

constexpr double limit_margin_rad = 0.01;
// The face is where the layout says to a few millimetres; what is touched farther out is something else.
constexpr double early_m = 0.012;
// A press lasts as long as a person's.
constexpr Duration press_time = Duration::from_ms(250);

}  // namespace

// The tool point when the closed fingers' tip is at `tip_m`: behind it by the fingers' length along an approach axis that depends on the place itself.
// Two rounds settle it to 0.1 mm, since the axis turns by 2 degrees over the fingers' length.
static bool tool_for_tip(const Vec3& tip_m, double tip_beyond_m, double roll_rad, arm::JointVector& q_rad) {
  Vec3 tool_m = tip_m;
  for (int round = 0; round < 4; ++round) {
    const arm::IkResult result = arm::inverse_kinematics(tool_m, roll_rad, limit_margin_rad);
    if (result.outcome == arm::IkOutcome::not_a_number || result.outcome == arm::IkOutcome::too_far) return false;
    q_rad = result.q_rad;
    if (round == 3) return result.ok();
    tool_m = tip_m - tip_beyond_m * arm::approach_axis(q_rad);
  }
  return false;
}

void Mission::begin_reach_button() {
  retrying_ = false;
  pressed_ = false;
  gripper_.close();
  tool_roll_rad_ = 0;
  const Vec3 tip = map_.button_m(task().button) + map_.normal() * config_.mission.approach_distance_m;
  arm::JointVector q;
  const double tip_beyond = arm::tip_beyond_tool_m(arm::jaw_from_gap(0));
  if (!tool_for_tip(tip, tip_beyond, tool_roll_rad_, q)) {
    failure_ = StepFailure::unreachable;
    return;
  }
  go_clear(q);
  standoff_m_ = arm::base_from_tool(q).translation();
}

Mission::Status Mission::run_reach_button() {
  const Status status = run_motion();
  if (status != Status::done) return status;
  const arm::GripperState jaw = gripper_.state();
  return jaw == arm::GripperState::closing || jaw == arm::GripperState::opening ? Status::running : Status::done;
}

void Mission::begin_press() {
  arm::GuardConfig config;
  const double torque = config_.mission.press_torque_nm;
  config.contact_torque_nm = arm::JointVector(torque, torque, torque, torque);
  guard_with(config);
  const double depth = config_.mission.layout.button_stroke_m + config_.mission.press_overtravel_m;
  arm::JointVector q;
  const double tip_beyond = arm::tip_beyond_tool_m(arm::jaw_from_gap(0));
  const bool reachable = tool_for_tip(map_.button_m(task().button) - map_.normal() * depth, tip_beyond, tool_roll_rad_, q);
  if (!reachable) {
    failure_ = StepFailure::unreachable;
    return;
  }
  motion_.line(arm::base_from_tool(q).translation(), tool_roll_rad_, config_.mission.press_speed_m_s);
}

Mission::Status Mission::run_press(const Tick& tick) {
  if (pressed_) return settled(motion_.done(), press_time, tick.now) ? Status::done : Status::running;
  if (motion_.planning()) return Status::running;
  guard_.update(tick.now, motion_.target(), measured_rad(), measured_nm());
  if (guard_.touched()) {
    motion_.stop();
    const Pose base_from_tool = arm::base_from_tool(measured_rad());
    const Vec3 tip = base_from_tool * Vec3(0, 0, arm::tip_beyond_tool_m(arm::jaw_from_gap(0)));
    const double above_face_m = (tip - map_.button_m(task().button)).dot(map_.normal());
    if (above_face_m > early_m) return fail(StepFailure::early_contact);
    pressed_ = true;
    ++tasks_[task_index_].presses;
    return Status::running;
  }
  const Status status = run_motion();
  return status == Status::done ? fail(StepFailure::no_contact) : status;
}

void Mission::begin_button_back() { begin_back_off(); }

Mission::Status Mission::run_button_back(const Tick& tick) {
  const Status status = run_motion();
  if (status != Status::done) return status;
  if (!pressed_) return Status::branch;
  tasks_[task_index_].done = true;
  event(tick, Event::Kind::task_done, tasks_[task_index_].presses);
  return Status::done;
}

}  // namespace lf::mission
