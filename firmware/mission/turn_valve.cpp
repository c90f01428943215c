#include "firmware/mission/turn_valve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lf::mission {

namespace {

// The closest soft limits over the docking error are 0.019 rad away (shoulder, pressing); the drives' own software limits lie outside.
constexpr double limit_margin_rad = 0.01;
// After a turn the drives settle within their position loop's time constant of 50 ms.
constexpr Duration settle = Duration::from_ms(300);
// A free roll stands 0.018 rad behind its target, and the drive gives up at 0.15: what stays further behind for so long is held by something.
constexpr double stalled_rad = 0.08;
constexpr Duration stalled_for = Duration::from_ms(50);

// The roll with which to take the bar so that the wrist can turn it from one angle to another.
std::optional<double> roll_for(const Workbench& bench, const arm::JointVector& q_rad, double from_rad, double to_rad) {
  const auto from = arm::rolls_for_bar(bench.config.arm, q_rad, bench.map.bar(from_rad));
  const auto to = arm::rolls_for_bar(bench.config.arm, q_rad, bench.map.bar(to_rad));
  if (!from || !to) return std::nullopt;
  // Seen along the tool axis, into the panel, the handle turns the other way round.
  const double about = from_rad - to_rad;
  const double turn = about + wrap(to->roll_rad[0] - from->roll_rad[0] - about, pi / 2);
  const arm::JointLimits limits = bench.motion.limits(1);
  return arm::roll_for_turn(*from, turn, limits.lower_rad[bench.roll()] + limit_margin_rad,
                            limits.upper_rad[bench.roll()] - limit_margin_rad);
}

// The whole way to the task's angle, or as much of it as the wrist can turn and the next look can tell apart: the rest comes after that look.
std::optional<double> choose_roll(Workbench& bench, const arm::JointVector& q_rad) {
  const double from_rad = bench.map.handle_rad(bench.job.task().valve);
  const double to_rad = bench.job.task().to_rad;
  for (const double share : {1.0, 0.5, 0.25}) {
    bench.turn_goal_rad = to_rad - (1 - share) * (to_rad - from_rad);
    if (std::abs(bench.turn_goal_rad - from_rad) > bench.map.longest_turn_rad(bench.job.task().valve)) continue;
    if (const auto roll = roll_for(bench, q_rad, from_rad, bench.turn_goal_rad)) return roll;
  }
  return std::nullopt;
}

// The jaw opens where the turn ends, wherever that is. Beside other handles there has to be room for it on the whole way; alone on its panel the valve was reached with the
// jaw open.
double jaw_after_rad(const Workbench& bench) {
  const bool alone = bench.mission().layout.valves.size() == 1;
  return alone ? bench.jaw_rad() : arm::jaw_from_gap(bench.jaw(), bench.jaw_open_m());
}

}  // namespace

Progress TurnValve::begin(const StepTick& tick) {
  switch (tick.step) {
    case Step::reach_valve: return begin_reach(tick.bench);
    case Step::advance: begin_advance(tick.bench); break;
    case Step::grip: tick.bench.gripper.close(); break;
    case Step::turn: begin_turn(tick); break;
    case Step::let_go: begin_let_go(tick.bench); break;
    case Step::back_off: tick.bench.begin_back_off(); break;
    default: break;
  }
  return Progress::running();
}

Progress TurnValve::run(const StepTick& tick) {
  switch (tick.step) {
    case Step::reach_valve: return run_reach(tick);
    case Step::advance: return run_advance(tick);
    case Step::grip: return run_grip(tick);
    case Step::turn: return run_turn(tick);
    case Step::let_go: return run_let_go(tick);
    case Step::back_off: return tick.bench.follow_back_off(tick);
    default: return Progress::running();
  }
}

// To a stand-off in front of the handle, the jaw open and rolled to the bar, with room for the turn.
Progress TurnValve::begin_reach(Workbench& bench) {
  const Progress unreachable = Progress::failed(StepFailure::unreachable);
  bench.take_up_task();
  bench.wound_up = false;
  const PanelMap& map = bench.map;
  const std::size_t valve = bench.job.task().valve;
  if (!map.handle_seen(valve)) return Progress::failed(StepFailure::no_handle);
  const Vec3 centre = map.handle_centre_m(valve);
  bench.standoff_m = centre + map.normal() * bench.mission().approach_distance_m;
  const Vec3 inward = -map.normal();
  const arm::IkResult at_bar = arm::place_tool(bench.config.arm, centre, inward, 0, limit_margin_rad, bench.measured_rad());
  if (!at_bar.ok()) return unreachable;
  const std::optional<double> roll = choose_roll(bench, at_bar.q_rad);
  if (!roll) return unreachable;
  bench.tool_roll_rad = *roll;
  const arm::IkResult start =
      arm::place_tool_beside(bench.config.arm, at_bar.q_rad, bench.standoff_m, inward, bench.tool_roll_rad, limit_margin_rad);
  if (!start.ok()) return unreachable;
  bench.go_clear(start.q_rad, bench.jaw_open_m());
  return Progress::running();
}

Progress TurnValve::run_reach(const StepTick& tick) {
  const Progress motion = tick.bench.follow_way();
  if (motion.kind == Progress::Kind::failed || tick.bench.motion.planning()) return motion;
  const arm::GripperState jaw = tick.bench.gripper.state();
  if (jaw == arm::GripperState::jammed) return Progress::failed_for_good(StepFailure::jaw_stuck);
  return motion.is_done() ? Progress::done_if(jaw == arm::GripperState::open) : motion;
}

void TurnValve::begin_advance(Workbench& bench) {
  guard_ = arm::GuardedMotion(approach_guard(bench.config.arm, bench.config.mission_limits));
  bench.go_straight(bench.map.handle_centre_m(bench.job.task().valve), bench.tool_roll_rad, bench.mission().approach_speed_m_s,
                    bench.meant_parts());
}

Progress TurnValve::run_advance(const StepTick& tick) {
  Workbench& bench = tick.bench;
  const Progress motion = bench.follow_motion();
  if (!motion.is_running() || bench.motion.planning()) return motion;
  bench.feel(guard_, tick.now);
  if (!guard_.touched()) return Progress::running();
  if (const std::optional<std::size_t> misled = bench.misled_joint(guard_)) {
    tick.faults.report(safety::Fault::following_error, static_cast<std::int32_t>(*misled));
    return Progress::running();
  }
  bench.stay_where_measured();
  return Progress::failed_by_touch(StepFailure::early_contact);
}

void TurnValve::watch_on_hold(const StepTick& tick) {
  const Workbench& bench = tick.bench;
  bench.feel(guard_, tick.now);
  bench.report_touch(guard_, tick.faults);
}

Progress TurnValve::run_grip(const StepTick& tick) {
  switch (tick.bench.gripper.state()) {
    case arm::GripperState::held: return Progress::done_if(tick.bench.motion.done());
    case arm::GripperState::empty:
    case arm::GripperState::dropped: return Progress::failed(StepFailure::not_gripped);
    // Thicker than the bar, or out of its place: it is not pinched again.
    case arm::GripperState::jammed: return Progress::failed_for_good(StepFailure::not_gripped);
    default: return Progress::running();
  }
}

void TurnValve::begin_turn(const StepTick& tick) {
  Workbench& bench = tick.bench;
  following_since_ = tick.now;
  bench.turn_ended = false;
  bench.motion.turn(bench.map.handle_rad(bench.job.task().valve), bench.turn_goal_rad,
                    bench.room(jaw_after_rad(bench), bench.meant_parts()), bench.jaw_rad(), bench.mission().turn_speed_rad_s,
                    bench.compliance.offset_rad());
}

// A turn that ends early leaves the handle on its way: the jaw lets go, and the second look finds it.
Progress TurnValve::run_turn(const StepTick& tick) {
  Workbench& bench = tick.bench;
  const Progress motion = bench.follow_motion();
  if (motion.kind == Progress::Kind::failed) return motion;
  bench.map.expect_handle(bench.job.task().valve, bench.motion.handle_rad());
  const arm::GripperState jaw = bench.gripper.state();
  if (jaw == arm::GripperState::dropped || jaw == arm::GripperState::empty) {
    tick.faults.report(safety::Fault::grip_lost);
    return Progress::running();
  }
  if (stalled(tick)) return Progress::failed(StepFailure::stalled);
  bench.turn_ended = tick.settled(motion.is_done(), settle);
  return Progress::done_if(bench.turn_ended);
}

bool TurnValve::stalled(const StepTick& tick) {
  const std::size_t roll = tick.bench.roll();
  if (std::abs(tick.bench.motion.target()[roll] - tick.bench.measured_rad()[roll]) < stalled_rad) following_since_ = tick.now;
  return tick.now - following_since_ > stalled_for;
}

void TurnValve::begin_let_go(Workbench& bench) {
  bench.let_off_roll();
  bench.gripper.open_to(bench.jaw_open_m());
}

Progress TurnValve::run_let_go(const StepTick& tick) {
  const arm::GripperState jaw = tick.bench.gripper.state();
  if (jaw == arm::GripperState::jammed) return Progress::failed(StepFailure::not_gripped);
  return Progress::done_if(jaw == arm::GripperState::open);
}

}  // namespace lf::mission
