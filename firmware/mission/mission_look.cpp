#include "firmware/mission/mission.hpp"

namespace lf::mission {

namespace {

// The last image is on its way for up to a tenth of a second after the arm has stopped.
constexpr Duration last_image = Duration::from_ms(120);

}  // namespace

Room Mission::room() const {
  Room room;
  room.base_from_panel = map_.known() ? map_.base_from_panel() : config_.mission.layout.nominal_base_from_panel();
  room.jaw_rad = watch_.joints().position_rad[static_cast<std::size_t>(Joint::jaw)];
  return room;
}

void Mission::go_clear(const arm::JointVector& goal_rad) { motion_.go_clear(goal_rad, room(), config_.mission.move_speed_fraction); }

void Mission::go_to_sweep(scan::SweepRequest request) {
  request.slowest_rad_s = config_.mission.sweep_speed_rad_s;
  motion_.go_to_sweep(request, config_.laser, room(), config_.mission.move_speed_fraction);
}

void Mission::order(const Tick& tick, ScanCommand::Kind kind) {
  ScanCommand command;
  command.kind = kind;
  command.sweep = sweep_;
  if (!tick.orders.push_back(command)) raise(tick, safety::Fault::port_error, static_cast<std::int32_t>(Port::scan_ring));
}

void Mission::begin_deploy() {
  gripper_.close();
  scan::SweepRequest request;
  request.base_from_panel = config_.mission.layout.nominal_base_from_panel();
  go_to_sweep(request);
}

// The second look needs only the handle's surroundings, and knows where they are.
void Mission::begin_verify_reach() {
  gripper_.close();
  scan::SweepRequest request;
  request.base_from_panel = map_.base_from_panel();
  request.top_m = config_.mission.verify_band_m;
  request.bottom_m = -config_.mission.verify_band_m;
  request.margin_m = 0.010;
  request.docking_shift_m = 0.003;    // thrice the valve base's usual error
  request.docking_turn_rad = 0.0035;  // 0.2 degrees
  go_to_sweep(request);
}

void Mission::begin_scan(const Tick& tick) {
  ++sweep_;
  order(tick, ScanCommand::Kind::begin_sweep);
  camera_.set_mode(CameraWork::Mode::sweep, tick.now);
  motion_.sweep();
}

Mission::Status Mission::run_scan(const Tick& tick) {
  if (!motion_.done()) return Status::running;
  if (camera_.mode() == CameraWork::Mode::sweep) camera_.set_mode(CameraWork::Mode::idle, tick.now);
  if (!settled(true, last_image, tick.now)) return Status::running;
  order(tick, ScanCommand::Kind::end_sweep);
  return Status::done;
}

Mission::Status Mission::run_look() { return camera_.still_taken() ? Status::done : Status::running; }

Mission::Status Mission::run_perceive(const Tick& tick) {
  if (!panel_arrived_) {
    if (tick.now - step_since_ > Duration::from_s(config_.mission_limits.vision_timeout_s)) raise(tick, safety::Fault::vision_late, 0);
    return Status::running;
  }
  const StepFailure failure = map_.update(panel_, 0);
  if (failure != StepFailure::none) return fail(failure);
  event(tick, Event::Kind::located, map_.handle_rad());
  return Status::done;
}

Mission::Status Mission::run_verify(const Tick& tick) {
  if (!panel_arrived_) {
    if (tick.now - step_since_ > Duration::from_s(config_.mission_limits.vision_timeout_s)) raise(tick, safety::Fault::vision_late, 0);
    return Status::running;
  }
  const StepFailure failure = map_.update(panel_, map_.handle_rad());
  if (failure != StepFailure::none) return fail(failure);
  event(tick, Event::Kind::located, map_.handle_rad());
  TaskResult& result = tasks_[task_index_];
  result.reached_rad = map_.handle_rad();
  if (std::abs(map_.handle_rad() - task().to_rad) <= config_.mission.valve_tolerance_rad) {
    result.done = true;
    event(tick, Event::Kind::task_done, result.reached_rad);
    return Status::done;
  }
  std::uint32_t& tries = tries_[static_cast<std::size_t>(Step::reach_valve)];
  if (tries + 1 < config_.mission.tries) {
    ++tries;
    return Status::branch;
  }
  event(tick, Event::Kind::task_failed, result.reached_rad);
  give_up(safety::Fault::step_failed, static_cast<std::int32_t>(StepFailure::wrong_angle));
  react(tick, safety::Reaction::retreat);
  return Status::running;
}

}  // namespace lf::mission
