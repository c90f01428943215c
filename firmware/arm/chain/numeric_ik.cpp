#include "firmware/arm/chain/numeric_ik.hpp"

#include <algorithm>
#include <cmath>

#include "shared/random.hpp"

namespace lf::chain {
namespace {

constexpr std::uint32_t most_descent_steps = 40;  // 99 % of the descents that arrive do so within 25
constexpr std::uint32_t most_slide_steps = 40;    // nine tenths end within 16
constexpr std::uint32_t most_mending_steps = 6;
constexpr std::uint32_t most_restarts = 1'000'000;  // so that iterations can be counted in 32 bits
constexpr std::uint32_t most_explaining_steps = 120;
constexpr std::uint32_t explaining_starts = 12;
constexpr std::uint32_t starts_around_seed = 4;
constexpr std::uint32_t starts_staying = 20;
constexpr double around_rad = 0.3;
constexpr double near_error = 0.25;     // the residual's square: half a radian, or half the arm's length
constexpr double slide_step_rad = 0.7;  // what curvature makes of it is mended in one or two iterations
constexpr double shortest_slide_rad = 0.15;
constexpr double slide_pull = 1e-4;
// The share of the squared distance that a step has to save, for a step that goes all the way. Less than that is left where the way to the seed is
// within 13 degrees of square to the free directions.
constexpr double slide_gain = 0.1;
// For the searches that tell the error that remains as it is. A stretched arm's curvature is at most its length's, which is 1 here.
constexpr double curvature = 0.5;
constexpr double firm_position = 30;  // weight: at 0.1 rad of missing turn the position gives way by 1e-4 of the arm's length
constexpr double limit_rounding = 1e-9;

// The slide's measure: the sum of squared travels.
double distance(const Chain& chain, const JointValues& a, const JointValues& b) {
  return (a - b).cwiseProduct(chain.weights()).squaredNorm();
}

}  // namespace

std::uint32_t NumericIk::most_iterations(const NumericIkConfig& config) {
  constexpr std::uint32_t slide = most_slide_steps + most_mending_steps + 2;
  const std::uint32_t search = (std::min(config.max_restarts, most_restarts) + 1) * (most_descent_steps + 2 + slide);
  return search + explaining_starts * (4 * (most_explaining_steps + 2) + 2 * slide);
}

double NumericIk::uniform(double lower, double upper) {
  const double unit = static_cast<double>(splitmix64(random_) >> 11) * 0x1p-53;
  random_ += splitmix64_step;
  return lower + unit * (upper - lower);
}

void NumericIk::begin(const Chain& chain, const IkTask& task, const JointValues& seed, const NumericIkConfig& config) {
  config_ = config;
  config_.max_restarts = std::min(config.max_restarts, most_restarts);
  asked_ = task;
  random_ = config.random_seed;
  result_ = IkResult();
  beyond_found_ = false;
  status_ = IkStatus::running;
  given_ = seed;
  seed_ = searched_ = result_.q = result_.nearest = drawn_in(chain, seed);
  if (chain.size() == 0 || !task.valid() || !usable(seed)) {
    conclude(chain, given_, false, IkOutcome::not_a_number, 0, seed_, result_);
    status_ = IkStatus::failed;
    stage_ = Stage::done;
    return;
  }
  far_found_ = false;
  const Stage first = first_stage(chain);
  if (first == Stage::search || config_.explain) return enter(chain, first);
  start(chain, seed_);
  finish(chain, IkOutcome::gave_up, 0);
}

// A target beyond the chain's whole length needs no search, only the distance.
NumericIk::Stage NumericIk::first_stage(const Chain& chain) const {
  const Vec3 first_m = chain.joint(0).parent_from_joint.translation();
  const double away_m = (asked_.base_from_tool.translation() - first_m).norm();
  if (away_m > chain.length_m() + asked_.position_tolerance_m) return Stage::position_beyond_limits;
  return config_.search ? Stage::search : Stage::beyond_limits;
}

IkStatus NumericIk::advance(const Chain& chain, std::uint32_t iterations) {
  for (std::uint32_t i = 0; i < iterations && status_ == IkStatus::running; ++i) step(chain);
  return status_;
}

const IkResult& NumericIk::solve(const Chain& chain, const IkTask& task, const JointValues& seed, const NumericIkConfig& config) {
  begin(chain, task, seed, config);
  advance(chain, most_iterations(config));
  return result_;
}

// One iteration of whatever stage it is.
void NumericIk::step(const Chain& chain) {
  ++result_.iterations;
  if (stage_ == Stage::approach_seed || stage_ == Stage::approach_limits) {
    slide(chain);
    return;
  }
  if (descent_.is_met()) {
    arrived(chain);
    return;
  }
  const bool searching = stage_ == Stage::search;
  if (descent_.stalled() || descent_steps_ >= (searching ? most_descent_steps : most_explaining_steps)) {
    next_start(chain);
  } else {
    descent_.iterate(chain, task_);
    ++descent_steps_;
  }
  if (status_ == IkStatus::running) keep_nearest();
}

void NumericIk::enter(const Chain& chain, Stage stage) {
  stage_ = stage;
  task_ = asked_;
  rules_ = Descent::Rules();
  starts_ = 0;
  start_limit_ = (config_.stay ? std::min(config_.max_restarts, starts_staying) : config_.max_restarts) + 1;
  if (stage != Stage::search) {
    start_limit_ = config_.max_restarts == 0 ? 1 : explaining_starts;
    rules_.fall = 1.0001;
  }
  rules_.limited = stage != Stage::beyond_limits && stage != Stage::position_beyond_limits;
  if (stage == Stage::position_beyond_limits || stage == Stage::position) task_.axis = task_.roll = false;
  if (stage == Stage::position_beyond_limits) rules_.remaining_damping = curvature;
  if (stage == Stage::orientation) rules_.position_weight = firm_position;
  start(chain, stage == Stage::search ? seed_ : searched_);
  nearest_ = descent_.q();
  nearest_error_ = descent_.error();
  started_near_ = stage == Stage::search && descent_.error() < near_error;
}

void NumericIk::start(const Chain& chain, const JointValues& q) {
  ++starts_;
  descent_steps_ = 0;
  // In turns: a position at the border of reach is met without it, and one beyond the border comes nearer with it, 3 % in the mean of 103.
  if (stage_ == Stage::position) rules_.remaining_damping = starts_ % 2 == 0 ? curvature : 0;
  descent_.start(chain, task_, rules_, q);
}

void NumericIk::next_start(const Chain& chain) {
  if (starts_ >= start_limit_) {
    exhausted(chain);
    return;
  }
  if (stage_ == Stage::search) ++result_.restarts;
  const bool staying = stage_ == Stage::search && config_.stay;
  if (staying || (started_near_ && starts_ <= starts_around_seed))
    start_around(chain, seed_);
  else
    start_at_random(chain);
}

// The better of two random postures: a fifth fewer iterations on the whole than from the first.
void NumericIk::start_at_random(const Chain& chain) {
  Descent other;
  for (const bool first : {true, false}) {
    JointValues q = JointValues::Zero();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const ChainJoint& joint = chain.joint(i);
      q[i] = chain.full_turn(i) ? seed_[i] + uniform(-pi, pi) : uniform(joint.lower, joint.upper);
    }
    if (first)
      start(chain, q);
    else
      other.start(chain, task_, rules_, q);
  }
  if (other.error() < descent_.error()) descent_ = other;
}

void NumericIk::start_around(const Chain& chain, const JointValues& q) {
  JointValues around = q;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const double width = around_rad / chain.weights()[i];
    around[i] += uniform(-width, width);
  }
  start(chain, drawn_in(chain, around));
}

void NumericIk::keep_nearest() {
  if (!(descent_.error() < nearest_error_)) return;
  nearest_error_ = descent_.error();
  nearest_ = descent_.q();
}

// A descent has met the stage's task.
void NumericIk::arrived(const Chain& chain) {
  const bool free_joints = task_.constraints() < static_cast<int>(chain.size());
  if (stage_ == Stage::search || stage_ == Stage::beyond_limits || stage_ == Stage::position_beyond_limits) {
    if (stage_ == Stage::search && !free_joints) {
      found(chain);
      return;
    }
    if (free_joints) {
      before_slide_ = stage_;
      stage_ = stage_ == Stage::search ? Stage::approach_seed : Stage::approach_limits;
      descent_.start(chain, task_, rules_, chain.unwound(descent_.q(), given_));
      slide_best_ = descent_.q();
      slide_distance_ = slide_bound_ = 1e300;
      slide_step_ = slide_step_rad;
      descent_steps_ = steps_since_met_ = 0;
      return;
    }
    descent_.start(chain, task_, rules_, chain.unwound(descent_.q(), chain.middle()));
    keep_least_excess(chain);
    next_start(chain);
    return;
  }
  if (stage_ == Stage::position) {
    searched_ = descent_.q();
    enter(chain, Stage::orientation);
    return;
  }
  finish(chain, IkOutcome::solved, 0);  // the last stage found it after all
}

// A solution within the limits. Where the arm is to stay one that jumps is kept aside, the nearest of them, and the search goes on.
void NumericIk::found(const Chain& chain) {
  const double travel_rad = chain.travel_rad(given_, chain.unwound(descent_.q(), given_));
  if (!config_.stay || travel_rad <= jump_rad) {
    finish(chain, IkOutcome::solved, 0);
    return;
  }
  if (!far_found_ || travel_rad < far_rad_) {
    far_found_ = true;
    far_rad_ = travel_rad;
    far_ = descent_.q();
  }
  next_start(chain);
}

// One step along the free directions, or one that mends what the step before has bent.
void NumericIk::slide(const Chain& chain) {
  ++descent_steps_;
  if (!descent_.is_met() && steps_since_met_ < most_mending_steps) {
    descent_.iterate(chain, task_);
    ++steps_since_met_;
    return;
  }
  const JointValues here = descent_.q();
  const double away = distance(chain, here, stage_ == Stage::approach_seed ? seed_ : drawn_in(chain, here));
  const bool gained = descent_.is_met() && away < slide_bound_;
  if (descent_.is_met() && away < slide_distance_) {
    slide_distance_ = away;
    slide_best_ = here;
  }
  if (!gained) {  // too far for the curvature, or against a limit: a shorter step from where it was best
    slide_step_ /= 2;
    descent_.start(chain, task_, rules_, slide_best_);
  }
  const JointValues goal = stage_ == Stage::approach_seed ? seed_ : drawn_in(chain, slide_best_);
  const JointValues way = goal - slide_best_;
  const double longest = way.cwiseProduct(chain.weights()).cwiseAbs().maxCoeff();
  if (slide_step_ < shortest_slide_rad || longest < limit_rounding || descent_steps_ >= most_slide_steps) {
    slid(chain);
    return;
  }
  const double share = std::min(1.0, slide_step_ / longest);
  slide_bound_ = (1 - slide_gain * share) * slide_distance_;
  descent_.iterate_toward(chain, task_, slide_best_ + share * way, slide_pull);
  steps_since_met_ = 0;
  // Where the step itself gains nothing, its mending is spared.
  if (distance(chain, descent_.q(), goal) >= slide_bound_) slid(chain);
}

void NumericIk::slid(const Chain& chain) {
  const bool approached_seed = stage_ == Stage::approach_seed;
  descent_.start(chain, task_, rules_, approached_seed ? slide_best_ : chain.unwound(slide_best_, chain.middle()));
  stage_ = before_slide_;
  if (approached_seed && descent_.is_met()) {
    found(chain);
    return;
  }
  keep_least_excess(chain);
  next_start(chain);
}

// Of an unwound posture that meets the stage's task without limits: by how much does it pass them?
void NumericIk::keep_least_excess(const Chain& chain) {
  if (!descent_.is_met()) return;  // whole turns may have put it past the tolerance
  const JointValues& q = descent_.q();
  double most = 0;
  int joint = -1;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const double past = std::abs(chain.excess(i, q[i]));
    if (past <= most) continue;
    most = past;
    joint = static_cast<int>(i);
  }
  if (beyond_found_ && most >= least_excess_) return;
  beyond_found_ = true;
  least_ = q;
  least_excess_ = most;
  least_joint_ = joint;
}

// No start of the stage has met its task.
void NumericIk::exhausted(const Chain& chain) {
  switch (stage_) {
    case Stage::search:
      if (far_found_) {
        start(chain, far_);
        finish(chain, IkOutcome::solved, 0);  // and a jump, which conclude() refuses
        return;
      }
      searched_ = nearest_;
      if (config_.explain)
        enter(chain, Stage::beyond_limits);
      else
        finish(chain, IkOutcome::gave_up, 0);
      return;
    case Stage::beyond_limits:
      if (beyond_found_)
        finish_at_limit(chain);
      else if (config_.max_restarts == 0)
        explain_single_descent(chain);
      else
        enter(chain, Stage::position_beyond_limits);
      return;
    case Stage::position_beyond_limits:
      if (beyond_found_) {
        enter(chain, Stage::position);
        return;
      }
      finish_out_of_reach(chain);
      return;
    case Stage::position: explain_position(chain); return;
    case Stage::orientation: {
      start(chain, nearest_);
      const TaskError error = task_error(task_, descent_.state().tool, descent_.state().tool_m);
      const double axis = error.axis_rad - task_.axis_tolerance_rad;
      const double roll = error.roll_rad - task_.roll_tolerance_rad;
      finish(chain, IkOutcome::orientation_unreachable, std::max(axis, roll));
      return;
    }
    default: finish(chain, IkOutcome::gave_up, 0); return;
  }
}

// One descent from the seed has failed, and so has one without limits: is it the posture that holds it?
void NumericIk::explain_single_descent(const Chain& chain) {
  rules_.limited = true;
  start(chain, searched_);
  const int here = descent_.rank(chain);
  JointValues beside = searched_;
  for (std::size_t i = 0; i < chain.size(); ++i) beside[i] += 0.3 + 0.05 * static_cast<double>(i);
  start(chain, beside);
  const int elsewhere = descent_.rank(chain);
  start(chain, searched_);
  finish(chain, here < elsewhere ? IkOutcome::singular : IkOutcome::gave_up, 0);
}

// The position alone is met past the limits, and no descent within them has met it. That is one of three things.
void NumericIk::explain_position(const Chain& chain) {
  if (least_excess_ <= limit_rounding) {
    start(chain, drawn_in(chain, least_));
    if (descent_.is_met()) {
      searched_ = descent_.q();
      enter(chain, Stage::orientation);
      return;
    }
  }
  const IkTask position = task_;
  task_ = asked_;
  start(chain, least_);
  if (descent_.is_met()) {
    finish_at_limit(chain);
    return;
  }
  task_ = position;
  finish_out_of_reach(chain);
}

// `least_` does all that is asked. Where it passes the limits by rounding alone it is a solution, if it still does so drawn into them.
void NumericIk::finish_at_limit(const Chain& chain) {
  if (least_excess_ <= limit_rounding) {
    start(chain, drawn_in(chain, least_));
    if (descent_.is_met()) {
      finish(chain, IkOutcome::solved, 0);
      return;
    }
  }
  start(chain, least_);
  result_.joint = least_joint_;
  finish(chain, IkOutcome::joint_limit, least_excess_);
}

// Where the stage, which asked for the position alone, came nearest.
void NumericIk::finish_out_of_reach(const Chain& chain) {
  start(chain, nearest_);
  const TaskError error = task_error(task_, descent_.state().tool, descent_.state().tool_m);
  finish(chain, IkOutcome::out_of_reach, error.position_m - task_.position_tolerance_m);
}

// The descent stands at the answer.
void NumericIk::finish(const Chain& chain, IkOutcome outcome, double excess) {
  const JointValues posture = outcome == IkOutcome::joint_limit ? descent_.q() : chain.unwound(descent_.q(), given_);
  result_.error = task_error(asked_, descent_.state().tool, descent_.state().tool_m);
  conclude(chain, given_, config_.stay, outcome, excess, posture, result_);
  stage_ = Stage::done;
  status_ = result_.ok() ? IkStatus::solved : IkStatus::failed;
}

}  // namespace lf::chain
