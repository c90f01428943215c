#include "firmware/mission/look.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {

namespace {

// The last exposure may have been asked for as the arm came to rest, and acts a SYNC later.
constexpr Duration last_exposure = Duration::from_ms(20);
// The second sweep's margin around the handle: the panel's place is known to 3 mm, and two lines before and after the bar tell it from the plate.
constexpr double beyond_handle_m = 0.006;

// With room for the 6 mm, and no less than what a bar of today's panel takes.
scan::SweepRequest::Handle handle_of(const PanelLayout::Valve& valve) {
  constexpr double least_radius_m = 0.055, least_height_m = 0.107, over_bar_m = 0.0007;
  return {valve.at_m, std::max(least_radius_m, valve.swept_radius_m() + beyond_handle_m),
          std::max(least_height_m, valve.front_m() + over_bar_m)};
}

// The tallest of what stands on the panel.
double proud_m(const PanelLayout& layout) {
  double most_m = 0;
  for (const PanelLayout::Valve& valve : layout.valves) most_m = std::max(most_m, handle_of(valve).height_m);
  for (const PanelLayout::Button& button : layout.buttons) most_m = std::max(most_m, button.height_m);
  return most_m;
}

}  // namespace

scan::SweepRequest sweep_over_panel(const MissionConfig& mission) {
  const PanelLayout& layout = mission.layout;
  scan::SweepRequest request;
  request.base_from_panel = layout.nominal_base_from_panel();
  request.top_m = layout.plate_max_m.y();
  request.bottom_m = layout.plate_min_m.y();
  request.left_m = layout.plate_min_m.x();
  request.right_m = layout.plate_max_m.x();
  for (const PanelLayout::Valve& valve : layout.valves) (void)request.handles.push_back(handle_of(valve));
  request.proud_m = proud_m(layout);
  request.docking_shift_m = mission.docking.shift_m;
  request.docking_turn_rad = mission.docking.turn_rad;
  request.slowest_rad_s = mission.sweep_speed_rad_s;
  return request;
}

void Look::on_panel(const PanelResult& result) {
  if (result.id != sweep_) return;
  panel_ = result;
  panel_arrived_ = true;
}

void Look::begin(const StepTick& tick) {
  switch (tick.step) {
    case Step::deploy: return begin_deploy(tick);
    case Step::verify_reach: return begin_verify_reach(tick);
    case Step::scan:
    case Step::verify_scan: return begin_scan(tick);
    case Step::look:
    case Step::verify_look: return tick.bench.camera.set_mode(CameraWork::Mode::still, tick.now);
    case Step::perceive:
    case Step::verify: return begin_question(tick);
    default: return;
  }
}

Progress Look::run(const StepTick& tick) {
  switch (tick.step) {
    case Step::deploy: return tick.bench.follow_way();
    case Step::verify_reach: return run_verify_reach(tick.bench);
    case Step::scan:
    case Step::verify_scan: return run_scan(tick);
    case Step::look:
    case Step::verify_look: return Progress::done_if(tick.bench.camera.still_taken());
    case Step::perceive: return run_perceive(tick);
    case Step::verify: return run_verify(tick);
    default: return Progress::running();
  }
}

void Look::begin_deploy(const StepTick& tick) { tick.bench.go_to_sweep(sweep_over_panel(tick.bench.mission())); }

// The second look needs only the handle's surroundings, and knows where they are.
void Look::begin_verify_reach(const StepTick& tick) {
  Workbench& bench = tick.bench;
  scan::SweepRequest request;
  request.base_from_panel = bench.map.base_from_panel();
  // Over the whole handle at every angle, and no further than the plate.
  const PanelLayout& layout = bench.mission().layout;
  const PanelLayout::Valve& valve = layout.valves[bench.job.task().valve];
  const double band_m = std::max(bench.mission().verify_band_m, valve.handle_length_m / 2 + beyond_handle_m);
  request.top_m = std::min(valve.at_m.y() + band_m, layout.plate_max_m.y());
  request.bottom_m = std::max(valve.at_m.y() - band_m, layout.plate_min_m.y());
  request.left_m = layout.plate_min_m.x();
  request.right_m = layout.plate_max_m.x();
  (void)request.handles.push_back(handle_of(valve));
  request.proud_m = proud_m(layout);
  request.margin_m = 0.010;
  request.docking_shift_m = bench.map.doubt().shift_m;
  request.docking_turn_rad = bench.map.doubt().turn_rad + bench.map.doubt().spin_rad;
  request.slowest_rad_s = bench.mission().sweep_speed_rad_s;
  bench.go_to_sweep(request);
}

// The jaw closes on the way: what it has closed on is looked at before anything else.
Progress Look::run_verify_reach(Workbench& bench) {
  const Progress motion = bench.follow_way();
  if (!motion.is_done()) return motion;
  switch (bench.gripper.state()) {
    case arm::GripperState::empty: return Progress::done();
    case arm::GripperState::held:
    case arm::GripperState::dropped:
    case arm::GripperState::jammed: return Progress::failed_for_good(StepFailure::jaw_not_closed);
    default: return Progress::running();
  }
}

void Look::begin_scan(const StepTick& tick) {
  ++sweep_;
  before_sweep_ = stats_;
  send(tick, ScanCommand::Kind::begin_sweep);
  tick.bench.camera.set_mode(CameraWork::Mode::sweep, tick.now);
  tick.bench.motion.sweep();
}

Progress Look::run_scan(const StepTick& tick) {
  Workbench& bench = tick.bench;
  if (!bench.motion.done()) return Progress::running();
  if (bench.camera.mode() == CameraWork::Mode::sweep) bench.camera.set_mode(CameraWork::Mode::idle, tick.now);
  if (!tick.settled(true, bench.mission().image_due + last_exposure)) return Progress::running();
  send(tick, ScanCommand::Kind::end_sweep);
  return Progress::done();
}

void Look::begin_question(const StepTick& tick) {
  panel_arrived_ = false;
  send(tick, ScanCommand::Kind::analyse);
}

bool Look::answered(const StepTick& tick) {
  const Duration timeout = Duration::from_s(tick.bench.config.mission_limits.vision_timeout_s);
  tick.clock.expect(timeout);
  const bool late = tick.clock.elapsed(tick.now) > timeout;
  if (!panel_arrived_ && late) tick.faults.report(safety::Fault::vision_late);
  return panel_arrived_;
}

StepFailure Look::take_answer(Workbench& bench, PanelMap::Valves wanted) {
  PanelMap& map = bench.map;
  const StepFailure failure = map.update(panel_, wanted);
  sight_ = sight_of(panel_, before_sweep_, stats_, bench.mission().layout, map.told_valve(), bench.config.camera);
  sight_.fit = map.fit();
  return failure;
}

Progress Look::run_perceive(const StepTick& tick) {
  if (!answered(tick)) return Progress::running();
  PanelMap& map = tick.bench.map;
  const StepFailure failure = take_answer(tick.bench, tick.bench.job.valves());
  if (failure != StepFailure::none) return Progress::failed(failure);
  const PanelMap::Valves wanted = tick.bench.job.valves();
  for (std::size_t i = 0; i < PanelLayout::max_valves; ++i) {
    if ((wanted & PanelMap::bit(i)) != 0) tick.event(Event::Kind::located, map.handle_rad(i), static_cast<std::int32_t>(i));
  }
  if (wanted == 0) tick.event(Event::Kind::located, 0, -1);
  return Progress::done();
}

Progress Look::run_verify(const StepTick& tick) {
  if (!answered(tick)) return Progress::running();
  PanelMap& map = tick.bench.map;
  Job& job = tick.bench.job;
  const std::size_t valve = job.task().valve;
  const double left_at_rad = map.handle_rad(valve);  // where the jaw had the handle when it let go
  const StepFailure failure = take_answer(tick.bench, PanelMap::bit(valve));
  if (failure != StepFailure::none) return Progress::failed(failure);
  tick.event(Event::Kind::located, map.handle_rad(valve), static_cast<std::int32_t>(valve));
  TaskResult& result = job.result();
  result.reached_rad = map.handle_rad(valve);
  const double tolerance_rad = tick.bench.mission().valve_tolerance_rad;
  if (std::abs(map.handle_rad(valve) - job.task().to_rad) <= tolerance_rad) {
    result.done = true;
    tick.event(Event::Kind::task_done, result.reached_rad);
    return Progress::done();
  }
  const bool followed = !tick.bench.turn_ended || std::abs(map.handle_rad(valve) - left_at_rad) <= tolerance_rad;
  if (followed && tick.bench.turn_ended && tick.bench.turn_goal_rad != job.task().to_rad)
    return Progress::other_way();  // the rest of a turn in pieces
  const StepFailure why = followed ? StepFailure::wrong_angle : StepFailure::slipped;
  if (job.may_try_again(Step::reach_valve)) {
    // A turn that stalled was named when it did.
    safety::FaultReport report{safety::Fault::step_failed, static_cast<std::int32_t>(why)};
    report.only_counted = true;
    if (tick.bench.turn_ended) tick.faults.report(report);
    job.count_try(Step::reach_valve);
    return Progress::other_way();
  }
  tick.event(Event::Kind::task_failed, result.reached_rad);
  return Progress::failed_for_good(why);
}

void Look::send(const StepTick& tick, ScanCommand::Kind kind) const {
  ScanCommand command;
  command.kind = kind;
  command.sweep = sweep_;
  tick.send(command);
}

}  // namespace lf::mission
