#include "firmware/mission/press_button.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/arm/give.hpp"

namespace lf::mission {

namespace {

constexpr double limit_margin_rad = 0.01;
// A stuck cap ends a press no deeper than this below where its face is believed to be, and a tenth of its stroke: the doubts of press_face_m, added in squares.
constexpr double deepest_stuck_m = 0.0036;
constexpr double stuck_share = 0.1;
// Of a press, until it goes at its speed.
constexpr double to_speed_m = 0.012;
// A press that works shows nearly its whole stroke, a stuck cap a tenth of a default one: what is felt late, and what the arm gives way by.
constexpr double least_travel = 0.5;
// By which a joint of the default arm in free motion may take more than at rest: its friction. 2.5 N m were seen in a press, and 12 to 14 where something pushed with 80 N.
constexpr double friction_nm = 8;
// A press lasts as long as a person's.
constexpr Duration press_time = Duration::from_ms(250);

// The tool point when the closed fingers' tip is at `tip_m`: behind it by the fingers' length along an approach axis that depends on the place itself.
// Two rounds settle it to 0.1 mm for the ARM 5E, whose axis turns by 2 degrees over the fingers' length. An arm that can point its tool points it `inward`. In the posture
// of `q_rad` as it comes in, or else in the one that is nearest to it.
bool tool_for_tip(const arm::Arm& arm, const Vec3& tip_m, const Vec3& inward, double tip_beyond_m, double roll_rad, bool keep_posture,
                  arm::JointVector& q_rad) {
  constexpr int least_rounds = 4, most_rounds = 12;
  constexpr double settled_m = 1e-4;
  Vec3 tool_m = arm.is_planar() ? tip_m : Vec3(tip_m - tip_beyond_m * inward);
  for (int round = 1; round <= most_rounds; ++round) {
    const bool beside = keep_posture || round > 1;
    const arm::IkResult result = beside ? arm::place_tool_beside(arm, q_rad, tool_m, inward, roll_rad, limit_margin_rad)
                                        : arm::place_tool(arm, tool_m, inward, roll_rad, limit_margin_rad, q_rad);
    switch (result.outcome) {
      case arm::IkOutcome::not_a_number:
      case arm::IkOutcome::too_far:
      case arm::IkOutcome::too_near: return false;
      default: break;
    }
    if (!arm.is_planar() && !result.ok()) return false;
    q_rad = result.q_rad;
    const Vec3 reached_m = tool_m + tip_beyond_m * arm.approach_axis(q_rad);
    if (round >= least_rounds && (reached_m - tip_m).norm() <= settled_m) return result.ok();
    tool_m = tip_m - tip_beyond_m * arm.approach_axis(q_rad);
  }
  return false;
}

// By how much at most a corner of fingers that come aslant touches before the middle of their tips. Round corners and caps touch later.
double corner_ahead_m(const arm::Arm& arm, const arm::JointVector& q_rad, const Vec3& normal, double button_width_m) {
  const double half_m = 0.5 * std::min(arm.jaw().pad_width_m, button_width_m);
  const Eigen::Matrix3d base_from_tool = arm.base_from_tool(q_rad).linear();
  return half_m * (std::abs(normal.dot(base_from_tool.col(0))) + std::abs(normal.dot(base_from_tool.col(1))));
}

arm::JointVector bottom_nm(const Workbench& bench) {
  return bottom_torques_nm(bench.config.arm, bench.config.mission_limits, bench.mission().press_torque_nm);
}

// Where touching is meant: of the arm's rules for its torques only what says that the button has bottomed. An overload is the watch's.
arm::GuardConfig press_guard(const Workbench& bench) {
  arm::GuardConfig config(bench.config.arm);
  config.contact_torque_nm = bottom_nm(bench);
  config.overload_torque_nm.setConstant(HUGE_VAL);
  return config;
}

const PanelLayout::Button& the_button(const Workbench& bench) { return bench.mission().layout.buttons[bench.job.task().button]; }

// A panel that is seen from far may stand deeper than it looks. The hand stays clear of it, and no press seeks its button farther off than this.
double deeper_m(const Workbench& bench) {
  constexpr double hand_m = 0.013;  // a corner of the fingers at 20 degrees of tilt, and the doubts of press_face_m
  constexpr double most_m = 0.004;  // with the overtravel 10 mm: an Oberon's looks were 7 mm off at worst
  const PanelLayout::Button& button = the_button(bench);
  const double room_m = button.height_m - button.stroke_m - bench.mission().press_overtravel_m - hand_m;
  return std::clamp(bench.map.deeper_m(), 0.0, std::clamp(room_m, 0.0, most_m));
}

double face_doubt_m(const Workbench& bench) { return press_face_m + deeper_m(bench); }

// The ARM 5E's is measured: what it stands on gives way, too.
ButtonFeel::Config feel_config(const Workbench& bench) {
  ButtonFeel::Config config;
  const arm::Arm& arm = bench.config.arm;
  if (!arm.is_planar()) config.stiffness_n_m = arm::tool_stiffness_n_m(arm, bench.motion.target(), bench.map.normal());
  return config;
}

double closed_tip_beyond_tool_m(const ArmModel::Jaw& jaw) { return arm::tip_beyond_tool_m(jaw, arm::jaw_from_gap(jaw, 0)); }

}  // namespace

Progress PressButton::begin(const StepTick& tick) {
  switch (tick.step) {
    case Step::reach_button: return begin_reach(tick.bench);
    case Step::press: return begin_press(tick.bench);
    case Step::button_back: tick.bench.begin_back_off(); break;
    default: break;
  }
  return Progress::running();
}

Progress PressButton::run(const StepTick& tick) {
  switch (tick.step) {
    case Step::reach_button: return run_reach(tick);
    case Step::press: return run_press(tick);
    case Step::button_back: return run_back(tick);
    default: return Progress::running();
  }
}

Progress PressButton::begin_reach(Workbench& bench) {
  bench.take_up_task();
  pressed_ = bench.wound_up = false;
  const std::optional<arm::JointVector> q = choose_roll(bench);
  if (!q) return barrier_ == StepFailure::none ? Progress::failed(StepFailure::unreachable) : Progress::failed_for_good(barrier_);
  bench.go_clear(*q, 0);
  bench.standoff_m = bench.config.arm.base_from_tool(*q).translation();
  return Progress::running();
}

std::optional<arm::JointVector> PressButton::choose_roll(Workbench& bench) {
  if (bench.job.tries(Step::reach_button) + bench.job.tries(Step::press) == 0) {
    barred_.fill(false);
    barrier_ = StepFailure::none;
  }
  const Vec3 tip = bench.map.button_m(bench.job.task().button) + bench.map.normal() * bench.mission().approach_distance_m;
  const arm::JointLimits limits = bench.motion.limits(1);
  const arm::Arm& arm = bench.config.arm;
  const std::size_t choices = arm.rolls() ? rolls_rad.size() : 1;
  for (std::size_t k = 0; k < choices; ++k) {
    arm::JointVector q = bench.measured_rad();
    const bool within = !arm.rolls() || (rolls_rad[k] >= arm.roll_rad(limits.lower_rad) && rolls_rad[k] <= arm.roll_rad(limits.upper_rad));
    if (barred_[k] || !within) continue;
    if (!tool_for_tip(arm, tip, -bench.map.normal(), closed_tip_beyond_tool_m(bench.jaw()), rolls_rad[k], false, q)) {
      if (arm.is_planar()) continue;
      return std::nullopt;  // where a pointed tool has no place at one roll it has none at another
    }
    roll_ = k;
    bench.tool_roll_rad = rolls_rad[k];
    return q;
  }
  return std::nullopt;
}

Progress PressButton::follow(Progress motion) {
  if (motion.kind != Progress::Kind::failed) return motion;
  switch (motion.failure) {
    case StepFailure::panel_in_the_way:
    case StepFailure::vehicle_in_the_way:
    case StepFailure::arm_in_its_own_way:
      barred_[roll_] = true;
      barrier_ = motion.failure;
      break;
    default: break;
  }
  return motion;
}

// The press reckons with the tip of closed fingers. Fingers that hold something end elsewhere, and what they hold would press the button.
Progress PressButton::run_reach(const StepTick& tick) {
  const Progress motion = follow(tick.bench.follow_way());
  if (motion.kind == Progress::Kind::failed || tick.bench.motion.planning()) return motion;
  switch (tick.bench.gripper.state()) {
    case arm::GripperState::empty: return motion;
    case arm::GripperState::closing:
    case arm::GripperState::lost: return Progress::running();  // a drive that is lost has a fault of its own
    default: return Progress::failed_for_good(StepFailure::jaw_not_closed);
  }
}

Progress PressButton::begin_press(Workbench& bench) {
  // Until the press has come to its speed: a gear's break-away may pass the press's torque for some milliseconds (8 N m were seen).
  arm::GuardConfig config = press_guard(bench);
  config.contact_torque_nm = free_motion_guard(bench.config.arm, bench.config.mission_limits).contact_torque_nm.cwiseMax(bottom_nm(bench));
  guard_ = arm::GuardedMotion(config);
  feel_ = ButtonFeel(feel_config(bench));
  learned_under_way_ = false;
  pushed_joint_.reset();
  rest_nm_.reset();
  bottom_m_ = 0;
  bench.job.result().failure = StepFailure::none;
  const double depth = the_button(bench).stroke_m + bench.mission().press_overtravel_m + deeper_m(bench);
  const Vec3 tip = bench.map.button_m(bench.job.task().button) - bench.map.normal() * depth;
  arm::JointVector q = bench.motion.target();
  if (!tool_for_tip(bench.config.arm, tip, -bench.map.normal(), closed_tip_beyond_tool_m(bench.jaw()), bench.tool_roll_rad, true, q))
    return Progress::failed(StepFailure::unreachable);
  // The ARM 5E's presses are measured at every torque that its key takes: at most 140 N.
  const bool measured = bench.config.arm.is_planar();
  const double felt_n = measured ? 0 : arm::least_felt_n(bench.config.arm, q, bench.map.normal(), bottom_nm(bench));
  bench.press_straight(bench.config.arm.base_from_tool(q).translation(), bench.tool_roll_rad, bench.mission().press_speed_m_s, felt_n,
                       bench.meant_parts());
  return Progress::running();
}

Progress PressButton::run_press(const StepTick& tick) {
  Workbench& bench = tick.bench;
  if (pressed_) return Progress::done_if(tick.settled(bench.motion.done(), press_time));
  if (bench.motion.planning()) return Progress::running();
  if (!met_something()) sense(tick);
  if (const std::optional<std::size_t> misled = misled_joint(bench)) {
    tick.faults.report(safety::Fault::following_error, static_cast<std::int32_t>(*misled));
    return Progress::running();
  }
  const Progress motion = follow(bench.follow_motion());
  bench.wound_up = bench.wound_up || met_something() || feel_.touched();
  if (!met_something() && !motion.is_done()) return motion;
  // At once: a stop along its ramp goes on for millimetres, and the bottom gives way by none.
  if (met_something()) bench.stay_where_measured();
  TaskResult& result = bench.job.result();
  result.travel_m = feel_.travel_m();
  result.click_felt = feel_.clicked();
  result.face_felt = feel_.touched();
  // Half: a corner touches somewhere between not at all and so much earlier.
  result.face_off_m =
      feel_.touch_depth_m() + 0.5 * corner_ahead_m(bench.config.arm, bench.measured_rad(), bench.map.normal(), the_button(bench).width_m);
  result.failure = judge(bench);
  if (result.failure == StepFailure::early_contact) return Progress::failed_by_touch(result.failure);
  // What may have gone in unfelt is not pressed again: nobody asked for two clicks.
  if (result.failure != StepFailure::none) return Progress::failed_for_good(result.failure);
  pressed_ = true;
  ++result.presses;
  return Progress::running();
}

void PressButton::sense(const StepTick& tick) {
  const Workbench& bench = tick.bench;
  learn_under_way(bench);
  bench.feel(guard_, tick.now);
  compare_with_rest(bench);
  // An arm that stands says nothing of a button's way.
  if (!bench.motion.paused()) feel(tick);
}

// What stops a finger before it has felt the button is not the button.
void PressButton::watch_on_hold(const StepTick& tick) {
  if (pressed_ || met_something()) return;
  sense(tick);
  const std::optional<std::size_t> misled = misled_joint(tick.bench);
  if (pushed_joint_) {
    tick.bench.stay_where_measured();
    return report_felt(misled, *pushed_joint_, tick.faults);
  }
  const bool meant = feel_.touched() && !misled;
  if (!meant) return tick.bench.report_touch(guard_, tick.faults);
  if (guard_.touched()) tick.bench.stay_where_measured();
}

// At rest a screw says little of its load. What free motion takes is learned anew once the press has come to its speed.
void PressButton::learn_under_way(const Workbench& bench) {
  const double gone_m = (bench.config.arm.base_from_tool(bench.motion.target()).translation() - bench.standoff_m).norm();
  if (learned_under_way_ || gone_m < to_speed_m) return;
  rest_nm_ = guard_.baseline_nm();
  guard_ = arm::GuardedMotion(press_guard(bench));
  learned_under_way_ = true;
}

// What presses on the arm by now would be learned for free motion, and pressed against.
void PressButton::compare_with_rest(const Workbench& bench) {
  if (!rest_nm_ || guard_.state() != arm::GuardState::free) return;
  Eigen::Index joint = 0;
  if ((guard_.baseline_nm() - *rest_nm_).cwiseAbs().maxCoeff(&joint) >
      friction_nm * strength(bench.config.arm, bench.config.mission_limits))
    pushed_joint_ = static_cast<std::size_t>(joint);
  rest_nm_.reset();
}

std::optional<std::size_t> PressButton::misled_joint(const Workbench& bench) const {
  const std::optional<std::size_t> unseen = pushed_joint_ ? bench.unseen_joint() : std::nullopt;
  return unseen ? unseen : bench.misled_joint(guard_);
}

// The drives' force along the press is the least-squares one for the torques of the joints: a roll has no part in it.
void PressButton::feel(const StepTick& tick) {
  const Workbench& bench = tick.bench;
  if (guard_.state() == arm::GuardState::learning || !bench.watch.joints().valid) return;
  const arm::JointVector q = bench.measured_rad();
  const Vec3 inward = -bench.map.normal();
  arm::JointVector along = (inward.transpose() * bench.config.arm.jacobian(q).topRows<3>()).transpose();
  bench.config.arm.set_roll(along, 0);
  const double force_n = along.dot(guard_.excess_torque_nm()) / along.squaredNorm();
  const Vec3 tip = bench.config.arm.base_from_tool(q) * Vec3(0, 0, closed_tip_beyond_tool_m(bench.jaw()));
  const double depth_m = (tip - bench.map.button_m(bench.job.task().button)).dot(inward);
  bottom_m_ = depth_m;
  // Far from the face a small force is the friction of the way, which the guard still learns; a large one is the guard's to notice.
  if (depth_m < -face_doubt_m(bench)) return;
  feel_.update(tick.network.config().sync_period.s(), force_n, depth_m);
}

StepFailure PressButton::judge(const Workbench& bench) const {
  if (pushed_joint_) return StepFailure::early_contact;
  const double stroke_m = the_button(bench).stroke_m;
  if (!feel_.touched()) return guard_.touched() ? StepFailure::early_contact : StepFailure::button_missing;
  if (feel_.touch_depth_m() < -face_doubt_m(bench)) return StepFailure::early_contact;
  if (feel_.touch_depth_m() > stroke_m + face_doubt_m(bench)) return StepFailure::button_missing;
  const bool moved = feel_.travel_m() >= least_travel * stroke_m;
  // Where the torque that says bottom is set high, a stuck cap holds the press up to the end of its way. The arm gives way by millimetres then: how deep its
  // joints say the tip is tells nothing, only the travel does.
  if (!guard_.touched()) return moved ? StepFailure::button_yields : StepFailure::button_stuck;
  // A strong spring, or a panel that is nearer than believed, hides the beginning of the way; the end of it is seen by the joints.
  const bool deep = bottom_m_ > deepest_stuck_m + deeper_m(bench) + stuck_share * stroke_m;
  return moved || deep ? StepFailure::none : StepFailure::button_stuck;
}

Progress PressButton::run_back(const StepTick& tick) {
  const Progress motion = tick.bench.follow_back_off(tick);
  if (!motion.is_done()) return motion;
  if (!pressed_) return Progress::other_way();
  TaskResult& result = tick.bench.job.result();
  result.done = true;
  tick.event(Event::Kind::task_done, result.presses);
  return Progress::done();
}

}  // namespace lf::mission
