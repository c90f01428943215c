#include <cmath>

#include "firmware/mission/mission.hpp"

namespace lf::mission {

namespace {

// The closest soft limits over the docking error are 0.019 rad away (shoulder, pressing); the drives' own software limits lie outside.
constexpr double limit_margin_rad = 0.01;
// After a turn the drives settle within their position loop's time constant of 50 ms.
constexpr Duration settle = Duration::from_ms(300);
// The bar is between the pads when this much of the way is done; touching before is running into something.
constexpr double contact_expected = 0.8;
// A free roll stands 0.018 rad behind its target, and the drive gives up at 0.15: what stays further behind for so long is held by something.
constexpr double stalled_rad = 0.08;
constexpr Duration stalled_for = Duration::from_ms(50);

}  // namespace

Mission::Status Mission::run_next_task(const Tick& tick) {
  tries_.fill(0);
  retrying_ = false;
  (void)tick;
  for (task_index_ = 0; task_index_ < tasks_.size() && tasks_[task_index_].done;) ++task_index_;
  if (task_index_ == tasks_.size()) {
    task_index_ = tasks_.empty() ? 0 : tasks_.size() - 1;
    return Status::end;
  }
  tasks_[task_index_].attempted = true;
  return task().kind == Task::Kind::turn_valve ? Status::done : Status::branch;
}

// To a stand-off in front of the handle, the jaw open and rolled to the bar, with room for the whole turn.
void Mission::begin_reach_valve() {
  retrying_ = false;
  failure_ = StepFailure::unreachable;  // until all of it is planned
  gripper_.open_to(config_.mission.jaw_open_m);
  const Vec3 centre = map_.handle_centre_m();
  standoff_m_ = centre + map_.normal() * config_.mission.approach_distance_m;
  const arm::IkResult at_bar = arm::inverse_kinematics(centre, 0, limit_margin_rad);
  if (!at_bar.ok()) return;
  const auto from = arm::rolls_for_bar(at_bar.q_rad, map_.bar(map_.handle_rad()));
  const auto to = arm::rolls_for_bar(at_bar.q_rad, map_.bar(task().to_rad));
  if (!from || !to) return;
  // Seen along the tool axis, into the panel, the handle turns the other way round.
  const double about = map_.handle_rad() - task().to_rad;
  const double turn = about + wrap(to->roll_rad[0] - from->roll_rad[0] - about, pi / 2);
  const auto roll = arm::roll_for_turn(*from, turn, limit_margin_rad);
  if (!roll) return;
  tool_roll_rad_ = *roll;
  const arm::IkResult start = arm::inverse_kinematics(standoff_m_, tool_roll_rad_, limit_margin_rad);
  if (!start.ok()) return;
  go_clear(start.q_rad);
  failure_ = StepFailure::none;
}

Mission::Status Mission::run_reach_valve() {
  if (gripper_.state() == arm::GripperState::jammed) return fail(StepFailure::not_gripped);
  const Status status = run_motion();
  if (status != Status::done) return status;
  return gripper_.state() == arm::GripperState::open ? Status::done : Status::running;
}

void Mission::begin_advance() {
  arm::GuardConfig config;
  config.contact_torque_nm = arm::JointVector(8, 8, 8, 3);  // 20 N at the tool; the pads may brush the bar
  guard_with(config);
  motion_.line(map_.handle_centre_m(), tool_roll_rad_, config_.mission.approach_speed_m_s);
}

Mission::Status Mission::run_advance(const Tick& tick) {
  const Status status = run_motion();
  if (status != Status::running || motion_.planning()) return status;
  guard_.update(tick.now, motion_.target(), measured_rad(), measured_nm());
  if (!guard_.touched()) return Status::running;
  motion_.stop();
  if (motion_.elapsed_s() < contact_expected * motion_.duration_s()) return fail(StepFailure::early_contact);
  return Status::done;
}

Mission::Status Mission::run_grip() {
  switch (gripper_.state()) {
    case arm::GripperState::held: return motion_.done() ? Status::done : Status::running;
    case arm::GripperState::empty:
    case arm::GripperState::dropped:
    case arm::GripperState::jammed: return fail(StepFailure::not_gripped);
    default: return Status::running;
  }
}

void Mission::begin_turn() {
  following_since_ = last_tick_;
  motion_.turn(map_.base_from_panel().linear(), map_.handle_rad(), task().to_rad, config_.mission.turn_speed_rad_s);
}

// A turn that ends early leaves the handle on its way: the jaw lets go, and the second look finds it.
Mission::Status Mission::run_turn(const Tick& tick) {
  const Status status = run_motion();
  if (status == Status::failed) return status;
  map_.expect_handle(motion_.handle_rad());
  if (gripper_.state() == arm::GripperState::dropped || gripper_.state() == arm::GripperState::empty) {
    raise(tick, safety::Fault::grip_lost, 0);
    return Status::running;
  }
  if (turn_stalled(tick.now)) return fail(StepFailure::stalled);
  return settled(status == Status::done, settle, tick.now) ? Status::done : Status::running;
}

bool Mission::turn_stalled(Time now) {
  if (std::abs(motion_.target()[3] - measured_rad()[3]) < stalled_rad) following_since_ = now;
  return now - following_since_ > stalled_for;
}

// What the roll has wound up against the handle.
void Mission::let_off_roll() {
  arm::JointVector rest_rad = motion_.target();
  rest_rad[3] = measured_rad()[3];
  motion_.start_at(rest_rad);
}

void Mission::begin_let_go() {
  let_off_roll();
  gripper_.open_to(config_.mission.jaw_open_m);
}

Mission::Status Mission::run_let_go() {
  if (gripper_.state() == arm::GripperState::jammed) return fail(StepFailure::not_gripped);
  return gripper_.state() == arm::GripperState::open ? Status::done : Status::running;
}

void Mission::begin_back_off() { motion_.line(standoff_m_, motion_.target()[3], config_.mission.approach_speed_m_s); }

}  // namespace lf::mission
