#include <cmath>

#include "firmware/arm/actuator.hpp"
#include "firmware/mission/mission.hpp"

namespace lf::mission {

using safety::Fault;

namespace {

// Drives leave power through every state of CiA 402 within their transition time-out; after half of it the rest is told to stop as it is.
constexpr Duration power_down = Duration::from_ms(1000);

}  // namespace

bool Mission::order(const Order& order, Time now) {
  if (!may(order.command, standing()) || (closing_ && order.command != Command::emergency_stop)) return false;
  switch (order.command) {
    case Command::start: return order_start();
    case Command::home: home_ordered_ = true; return true;
    case Command::hold: hold(now); return true;
    case Command::resume: resume(now); return true;
    case Command::jog: return order_jog(order);
    case Command::set_tasks: return set_tasks(order.tasks);
    case Command::abort: abort_ordered_ = true; return true;
    case Command::reset: reset_ordered_ = true; return true;
    case Command::shut_down: shut_down_ordered_ = closing_ = true; return true;
    case Command::emergency_stop: stop_ordered_ = true; return true;
    case Command::count: break;
  }
  return false;
}

// The motion halts on its own path, so that it can be gone on with from there; the laser and what it measures begin anew.
void Mission::hold(Time now) {
  on_hold_ = true;
  motion_.hold();
  held_camera_ = camera_.mode();
  camera_.set_mode(CameraWork::Mode::idle, now);
}

void Mission::resume(Time now) {
  on_hold_ = false;
  motion_.resume();
  camera_.set_mode(held_camera_, now);
}

// Time stands still for the step and the jaw.
void Mission::wait_on_hold(Duration period) {
  step_since_ = step_since_ + period;
  settled_since_ = settled_since_ + period;
  gripper_.wait(period);
}

// A job moves within the limits: a joint that was found outside of them is jogged back first.
bool Mission::order_start() {
  if (step_ == Step::ready && watch_.any_outside()) return false;
  start_ordered_ = true;
  return true;
}

// One at a time: what waits for the next tick is not replaced, and a jog is judged by where the one before has ended.
bool Mission::order_jog(const Order& order) {
  const auto joint = static_cast<std::size_t>(order.joint);
  if (jog_ordered_ || start_ordered_) return false;
  if (joint >= joint_count || !std::isfinite(order.by_rad) || std::abs(order.by_rad) > largest_jog_rad) return false;
  const bool arm = joint < arm_joint_count;
  const double from = arm ? motion_.target()[static_cast<Eigen::Index>(joint)] : watch_.joints().position_rad[joint];
  const double to = from + order.by_rad;
  const safety::JointLimit& limit = config_.mission_limits.joints[joint];
  const arm_geometry::JointNumbers& stroke = arm::numbers(order.joint);
  const double low = std::max(limit.min_rad, stroke.lower_rad), high = std::min(limit.max_rad, stroke.upper_rad);
  const bool inside = to >= low && to <= high;
  const bool toward_it = (from < low && to > from && to <= high) || (from > high && to < from && to >= low);
  if (!inside && !toward_it) return false;
  jog_joint_ = order.joint;
  jog_goal_rad_ = to;
  jog_ordered_ = true;
  return true;
}

void Mission::begin_jog() {
  tries_[static_cast<std::size_t>(Step::jog)] = 0;
  if (jog_joint_ == Joint::jaw) return gripper_.turn_to(jog_goal_rad_);
  arm::JointVector goal = motion_.target();
  goal[static_cast<Eigen::Index>(jog_joint_)] = jog_goal_rad_;
  motion_.jog(goal, jog_speed_fraction);
}

Mission::Status Mission::run_jog() {
  const bool jaw_moves = gripper_.state() == arm::GripperState::opening;
  return jog_joint_ == Joint::jaw && jaw_moves ? Status::running : run_motion();
}

Mission::Status Mission::run_ready() {
  if (start_ordered_) {
    start_ordered_ = false;
    watch_.bear_outside(false);
    return Status::done;
  }
  if (!jog_ordered_) return Status::running;
  jog_ordered_ = false;
  return Status::branch;
}

bool Mission::set_tasks(const Tasks& tasks) {
  if (tasks.empty()) return false;
  for (const Task& task : tasks) {
    const bool known = task.kind == Task::Kind::turn_valve || (task.kind == Task::Kind::press_button && task.button < 3);
    if (!known || !std::isfinite(task.to_rad) || std::abs(task.to_rad) > pi) return false;
  }
  config_.mission.tasks = tasks;
  list_tasks();
  return true;
}

void Mission::list_tasks() {
  tasks_.clear();
  for (const Task& task : config_.mission.tasks) {
    TaskResult result;
    result.task = task;
    if (!tasks_.push_back(result)) return;  // the same capacity on both sides
  }
}

// As new, but for what is counted and numbered from power-on. What still is wrong is raised again, since the watch begins anew as well.
void Mission::forget(const Tick& tick) {
  tick.network.disable_all();
  powered_ = on_hold_ = failing_ = retrying_ = false;
  start_ordered_ = home_ordered_ = jog_ordered_ = abort_ordered_ = stop_ordered_ = false;
  watch_ = safety::Watch(config_.mission_limits);
  gripper_ = arm::Gripper();
  compliance_.reset();
  map_ = PanelMap(config_.mission.layout, config_.marker, config_.camera);
  motion_.freeze();
  outcome_ = {};
  faults_after_end_.fill(0);
  tries_.fill(0);
  task_index_ = 0;
  list_tasks();
  enter(tick, Step::idle);
}

// What has ended without power only has its nodes stopped; the rest goes through a step of its own.
void Mission::take_shut_down(const Tick& tick) {
  if (reset_ordered_) forget(tick);
  reset_ordered_ = false;
  if (!shut_down_ordered_) return;
  shut_down_ordered_ = false;
  if (over()) return tick.network.shut_down();
  if (!is_end(step_)) give_up(Fault::aborted, 1);
  motion_.stop();
  enter(tick, Step::shut_down);
}

// Without power first: the gears lock themselves, and a drive that is stopped holds its current for ever.
void Mission::begin_shut_down(const Tick& tick) {
  tick.network.disable_all();
  motion_.freeze();
  powered_ = false;
}

Mission::Status Mission::run_shut_down(const Tick& tick) {
  bool down = true;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const canopen::AxisState state = tick.network.axis(static_cast<Joint>(i)).state();
    using canopen::AxisState;
    down = down && (state == AxisState::disabled || state == AxisState::offline || state == AxisState::fault);
  }
  if (!down && tick.now - step_since_ < power_down) return Status::running;
  tick.network.shut_down();
  return Status::done;
}

}  // namespace lf::mission
