#include "firmware/mission/way_home.hpp"

namespace lf::mission {

void WayHome::begin(const StepTick& tick) {
  Workbench& bench = tick.bench;
  switch (tick.step) {
    case Step::abandon:  // out of a contact: the jaw opens, whatever it holds, before the arm goes back
      bench.let_off_roll();
      return bench.gripper.open_to(bench.jaw_open_m());
    case Step::abandon_back: return bench.begin_back_off();
    case Step::stow: freed_ = stops_ = leaves_open_ = false; return bench.go_clear(bench.mission().park_rad, 0);
    case Step::shut_down: return begin_shut_down(tick);
    default: return;
  }
}

Progress WayHome::run(const StepTick& tick) {
  switch (tick.step) {
    case Step::abandon: return run_abandon(tick.bench);
    case Step::abandon_back: {
      const Progress motion = tick.bench.follow_back_off(tick);
      if (!motion.is_done()) return motion;
      return tick.bench.course == Course::retrying ? Progress::other_way() : Progress::done();
    }
    case Step::stow: return run_stow(tick.bench);
    case Step::shut_down: return Progress::done_if(tick.bench.power.off());
    default: return Progress::running();
  }
}

// Nothing goes back before the jaw is seen open: what it still holds would be dragged along.
Progress WayHome::run_abandon(const Workbench& bench) {
  const arm::GripperState jaw = bench.gripper.state();
  if (jaw == arm::GripperState::jammed) return Progress::failed(StepFailure::jaw_stuck);
  return Progress::done_if(jaw == arm::GripperState::open && bench.motion.done());
}

// The jaw closes on the way. What it has closed on is let go of, by an arm at rest: without power its screw would go on squeezing. The way is sought anew for
// a jaw that stays open.
Progress WayHome::run_stow(Workbench& bench) {
  const Progress motion = bench.follow_way();
  if (motion.kind == Progress::Kind::failed || bench.motion.planning()) return motion;
  switch (bench.gripper.state()) {
    case arm::GripperState::empty:
      if (!motion.is_done()) return motion;
      return bench.course == Course::giving_up ? Progress::other_way() : Progress::done();
    case arm::GripperState::open:
      if (!freed_ || !motion.is_done()) return Progress::running();
      if (leaves_open_) return Progress::failed(StepFailure::jaw_not_closed);
      leaves_open_ = true;
      bench.go_clear(bench.mission().park_rad, bench.jaw_open_m());
      return Progress::running();
    case arm::GripperState::held:
    case arm::GripperState::dropped:
    case arm::GripperState::jammed:
      if (freed_) return Progress::failed(StepFailure::jaw_stuck);
      if (!stops_) bench.motion.stop();
      stops_ = true;
      if (!bench.motion.done()) return Progress::running();
      freed_ = true;
      bench.gripper.open_to(bench.jaw_open_m());
      return Progress::running();
    default: return Progress::running();
  }
}

// The arm stands, unless a joint was just being homed. Drives that another master leads are its own; only an emergency stop takes their power, too.
void WayHome::begin_shut_down(const StepTick& tick) {
  Workbench& bench = tick.bench;
  if (bench.powered) {
    bench.power.lower(tick.now, tick.network);
    tick.clock.expect(safety::Power::longest_lowering(tick.network.config()));
  } else if (!tick.network.bus_is_anothers()) {
    bench.power.stop(tick.now, tick.network);
  }
  bench.motion.freeze();
  bench.powered = false;
}

}  // namespace lf::mission
