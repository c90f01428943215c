// What an operator's orders do to the mission.
#include "firmware/mission/mission.hpp"

namespace lf::mission {

bool Mission::order(const Order& order, Time now) {
  OrderMailbox& mailbox = bench_.mailbox;
  if (order.command >= Command::count || !may(order.command, standing())) return false;
  const bool stop = order.command == Command::emergency_stop;
  const bool never_late = stop || order.command == Command::shut_down;  // obeyed however late they come
  if ((mailbox.closed() && !stop) || (now > order.expires && !never_late)) return false;
  WaitingOrder waiting;
  waiting.command = order.command;
  waiting.arrived = now;
  waiting.expires = never_late ? Order::never : order.expires;
  switch (order.command) {
    case Command::hold: hold(now); return true;
    case Command::resume: resume(now); return true;
    case Command::set_tasks:
      if (!bench_.may_work() || !Job::makes_sense(order.tasks, bench_.mission().layout)) return false;
      bench_.job.set(order.tasks);
      return true;
    case Command::start:
      if (bench_.job.results().empty() || !bench_.may_work()) return false;
      // A job moves within the limits: a joint that was found outside of them is jogged back first.
      if (step_ == Step::ready && bench_.watch.any_outside()) return false;
      break;
    case Command::jog: {
      // One at a time: a jog is judged by where the one before has ended.
      if (mailbox.waiting(Command::jog) || mailbox.waiting(Command::start)) return false;
      const std::optional<double> goal_rad = jog_goal_rad(order, bench_);
      if (!goal_rad) return false;
      waiting.joint = order.joint;
      waiting.goal_rad = *goal_rad;
      break;
    }
    case Command::shut_down: mailbox.close(); break;
    default: break;
  }
  mailbox.put(waiting);
  return true;
}

// The motion halts on its own path, so that it can be gone on with from there; the laser and what it measures begin anew.
void Mission::hold(Time now) {
  hold_ = bench_.camera.mode();
  bench_.motion.hold();
  bench_.camera.set_mode(CameraWork::Mode::idle, now);
}

void Mission::resume(Time now) {
  bench_.motion.resume();
  bench_.camera.set_mode(*hold_, now);
  hold_.reset();
}

void Mission::take_reset(const StepTick& tick) {
  if (bench_.mailbox.take(Command::reset)) forget(tick);
}

// As new, but for what is counted and numbered from power-on. What still is wrong is reported again, since the watch begins anew as well.
void Mission::forget(const StepTick& tick) {
  // A held arm loses its power; any other end is without power already, or about to be.
  if (!bench_.power.off()) bench_.power.stop(tick.now, tick.network);
  bench_.powered = false;
  bench_.course = Course::working;
  // A stop or a shut-down that came with the reset still has to be taken.
  const std::optional<WaitingOrder> stop = bench_.mailbox.take(Command::emergency_stop);
  const std::optional<WaitingOrder> shut_down = bench_.mailbox.take(Command::shut_down);
  bench_.mailbox.clear();
  if (stop) bench_.mailbox.put(*stop);
  if (shut_down) bench_.mailbox.put(*shut_down);
  const MissionSetup& config = bench_.config;
  bench_.watch = safety::Watch(config.arm, config.mission_limits, config.transmissions, tick.network.foreign());
  const bool doubtful_jaw = bench_.gripper.doubted();
  bench_.gripper = bench_.new_gripper();
  if (doubtful_jaw) bench_.gripper.doubt();
  bench_.compliance.reset();
  bench_.map = PanelMap(config.mission.layout, config.markers, config.camera, config.arm.pointing_joints());
  bench_.motion.freeze();
  bench_.job.begin_anew();
  empty_jaw_ = EmptyJaw();
  outcome_ = {};
  faults_after_end_.fill(0);
  enter(tick, Step::idle);
}

// What has ended loses its power anyway; the rest goes through a step of its own. The nodes are stopped when the power is off.
void Mission::take_shut_down(const StepTick& tick) {
  if (!bench_.mailbox.take(Command::shut_down) || ended()) return;
  if (step_ != Step::held) give_up({safety::Fault::aborted, 1});
  bench_.motion.stop();
  enter(tick, Step::shut_down);
}

}  // namespace lf::mission
