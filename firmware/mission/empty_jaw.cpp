#include "firmware/mission/empty_jaw.hpp"

namespace lf::mission {

Progress EmptyJaw::begin(const StepTick& tick) {
  Workbench& bench = tick.bench;
  switch (tick.step) {
    case Step::check_jaw:
      bench.standoff_m = bench.config.arm.base_from_tool(bench.measured_rad()).translation();  // a retreat leads nowhere else
      bench.gripper.close();
      break;
    case Step::free_jaw: bench.gripper.open_to(bench.jaw_open_m()); break;
    case Step::back_out: return begin_back_out(bench);
    default: break;
  }
  return Progress::running();
}

Progress EmptyJaw::run(const StepTick& tick) {
  const arm::GripperState jaw = tick.bench.gripper.state();
  switch (tick.step) {
    case Step::check_jaw: return run_check(tick);
    case Step::free_jaw:
      if (jaw == arm::GripperState::jammed) return Progress::failed_for_good(StepFailure::jaw_stuck);
      return Progress::done_if(jaw == arm::GripperState::open);
    case Step::back_out: return tick.bench.follow_back_off(tick);
    default: return Progress::running();
  }
}

Progress EmptyJaw::run_check(const StepTick& tick) {
  switch (tick.bench.gripper.state()) {
    case arm::GripperState::empty:
      freed_ = false;
      return tick.bench.course == Course::giving_up ? Progress::nothing_left() : Progress::done();
    case arm::GripperState::held:
    case arm::GripperState::dropped:
    case arm::GripperState::jammed:
      if (freed_) return Progress::failed_for_good(StepFailure::jaw_stuck);
      freed_ = true;
      return Progress::other_way();
    default: return Progress::running();
  }
}

Progress EmptyJaw::begin_back_out(Workbench& bench) {
  const arm::JointVector here = bench.measured_rad();
  bench.standoff_m =
      bench.config.arm.base_from_tool(here).translation() - bench.mission().approach_distance_m * bench.config.arm.approach_axis(here);
  bench.wound_up = false;
  bench.begin_back_off();
  return Progress::running();
}

}  // namespace lf::mission
