#include "firmware/mission/manual.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/mission/workspace_way.hpp"

namespace lf::mission {

std::optional<double> jog_goal_rad(const Order& order, const Workbench& bench) {
  const std::size_t joint = order.joint;
  if (joint >= bench.config.arm.joint_count() || !std::isfinite(order.by_rad) || std::abs(order.by_rad) > largest_jog_rad)
    return std::nullopt;
  const bool arm = joint < bench.config.arm.arm_joints();
  // The arm would drag along what the jaw holds. A jog moves no joint but its own: the operator opens or closes the jaw first.
  if (arm && bench.jaw_may_hold()) return std::nullopt;
  const double from = arm ? bench.motion.target()[static_cast<Eigen::Index>(joint)] : bench.watch.joints().position_rad[joint];
  const double to = from + order.by_rad;
  const safety::JointLimit& limit = bench.config.mission_limits.joints[joint];
  const ArmModel::Joint& stroke = bench.config.arm.joint(joint);
  const double low = std::max(limit.min_rad, stroke.lower_rad), high = std::min(limit.max_rad, stroke.upper_rad);
  const bool inside = to >= low && to <= high;
  const bool toward_it = (from < low && to > from && to <= high) || (from > high && to < from && to >= low);
  if (!inside && !toward_it) return std::nullopt;
  if (!arm) return to;
  arm::JointVector goal = bench.motion.target();
  goal[static_cast<Eigen::Index>(joint)] = to;
  const bool keeps = keeps_to_workspace(bench.config.arm, bench.config.mission_limits, bench.motion.target(), goal);
  return keeps ? std::optional(to) : std::nullopt;
}

void Manual::begin(const StepTick& tick) {
  if (tick.step != Step::jog) return;
  Workbench& bench = tick.bench;
  bench.job.forget_tries(Step::jog);
  jaw_waits_ = jog_.joint == bench.config.arm.jaw_joint();
  arm::JointVector goal = bench.motion.target();
  if (!jaw_waits_) goal[static_cast<Eigen::Index>(jog_.joint)] = jog_.goal_rad;
  bench.motion.jog(goal, bench.room(jaw_waits_ ? jog_.goal_rad : bench.jaw_rad()), bench.jaw_rad(), jog_speed_fraction);
}

Progress Manual::run(const StepTick& tick) { return tick.step == Step::ready ? run_ready(tick) : run_jog(tick); }

// A jog that is barred moves nothing: the operator is told by what, and may order another one.
Progress Manual::run_jog(const StepTick& tick) {
  Workbench& bench = tick.bench;
  const Progress motion = bench.follow_motion();
  if (motion.kind == Progress::Kind::failed) {
    safety::FaultReport report{safety::Fault::step_failed, static_cast<std::int32_t>(motion.failure)};
    report.only_counted = true;
    tick.faults.report(report);
    return Progress::done();
  }
  if (!motion.is_done()) return motion;
  if (jaw_waits_) bench.gripper.turn_to(jog_.goal_rad);
  jaw_waits_ = false;
  const bool jaw_moves = jog_.joint == bench.config.arm.jaw_joint() && bench.gripper.state() == arm::GripperState::opening;
  return Progress::done_if(!jaw_moves);
}

Progress Manual::run_ready(const StepTick& tick) {
  Workbench& bench = tick.bench;
  if (bench.mailbox.take(Command::start)) {
    bench.watch.tolerate_excursion(false);
    return Progress::done();
  }
  const std::optional<WaitingOrder> jog = bench.mailbox.take(Command::jog);
  if (!jog) return Progress::running();
  jog_ = *jog;
  return Progress::other_way();
}

}  // namespace lf::mission
