#include "firmware/arm/chain/ik.hpp"

#include <cmath>

namespace lf::chain {
namespace {

constexpr std::uint32_t most_polishing = 8;  // two are enough but at the border of reach
constexpr double limit_rounding = 1e-6;      // what polishing may move a joint that stands at its limit
constexpr double no_posture = 1e-4;          // the residual's square: 1e-2 rad is not what few digits or the border of reach leave
constexpr double freeing_rad = 1e-3;         // a tolerance above it lets the numeric solver look where the exact pose is out of reach

// The joint that passes its limits most, and by how much; -1 when all are within.
int worst_joint(const Chain& chain, const JointValues& q, double& excess) {
  int joint = -1;
  excess = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const double past = std::abs(chain.excess(i, q[i]));
    if (past <= excess) continue;
    excess = past;
    joint = static_cast<int>(i);
  }
  return joint;
}

bool frees_joints(const IkTask& task, double length_m) {
  return task.position_tolerance_m > freeing_rad * length_m || task.axis_tolerance_rad > freeing_rad ||
         task.roll_tolerance_rad > freeing_rad;
}

}  // namespace

void Ik::begin(const IkTask& task, const JointValues& seed, const NumericIkConfig& config) {
  task_ = task;
  config_ = config;
  given_ = seed;
  result_ = IkResult();
  result_.q = result_.nearest = drawn_in(chain_, seed);  // until there is an answer
  status_ = IkStatus::running;
  stage_ = Stage::form;
  owed_ = 0;
  if (!task.valid() || !usable(seed) || !closed_form_for(task)) begin_numeric();
}

void Ik::begin_numeric() {
  stage_ = Stage::numeric;
  numeric_.begin(chain_, task_, given_, config_);
  status_ = numeric_.status();
  if (status_ == IkStatus::failed) result_ = numeric_.result();
}

IkStatus Ik::advance(std::uint32_t iterations) {
  for (; iterations > 0 && status_ == IkStatus::running; --iterations) {
    if (owed_ > 0)
      --owed_;
    else if (stage_ != Stage::numeric)
      step();
    else
      break;
  }
  if (iterations == 0 || status_ != IkStatus::running) return status_;
  status_ = numeric_.advance(chain_, iterations);
  if (status_ == IkStatus::running) return status_;
  const std::uint32_t before = result_.iterations;
  result_ = numeric_.result();
  result_.iterations += before;
  return status_;
}

const IkResult& Ik::solve(const IkTask& task, const JointValues& seed, const NumericIkConfig& config) {
  begin(task, seed, config);
  advance(most_iterations(config));
  return result_;
}

std::uint32_t Ik::most_iterations(const NumericIkConfig& config) {
  constexpr std::uint32_t polishing = Postures::capacity * (1 + most_polishing);
  return form_iterations + 2 * polishing + NumericIk::most_iterations(config);  // within the limits, and beyond
}

void Ik::step() {
  if (stage_ == Stage::form)
    find_postures();
  else
    polish();
}

void Ik::find_postures() {
  result_.iterations += form_iterations;
  owed_ = form_iterations - 1;
  result_.closed_form = true;
  closed_forms(geometry_, chain_.size(), task_, drawn_in(chain_, given_), postures_);
  for (std::size_t k = 0; k < postures_.count; ++k) {
    postures_.q[k] = chain_.unwound(postures_.q[k], given_);
    worst_joint(chain_, postures_.q[k], excess_[k]);
    travel_rad_[k] = chain_.travel_rad(given_, postures_.q[k]);
  }
  tried_.fill(false);
  least_joint_ = -1;
  stage_ = Stage::within;
  next_posture();
}

void Ik::next_posture() {
  polish_steps_ = 0;
  if (stage_ == Stage::within)
    next_within();
  else
    next_beyond();
}

// The nearest of those within the limits.
void Ik::next_within() {
  posture_ = Postures::capacity;
  for (std::size_t k = 0; k < postures_.count; ++k) {
    const bool nearer = posture_ == Postures::capacity || travel_rad_[k] < travel_rad_[posture_];
    if (!tried_[k] && excess_[k] <= limit_rounding && nearer) posture_ = k;
  }
  if (posture_ != Postures::capacity) {
    tried_[posture_] = true;
    return;
  }
  if (postures_.more || frees_joints(task_, chain_.length_m())) {
    begin_numeric();
    return;
  }
  config_.search = false;  // these were all
  stage_ = Stage::beyond;
  next_beyond();
}

// Any that may pass its limits less than the best so far.
void Ik::next_beyond() {
  for (posture_ = 0; posture_ < postures_.count; ++posture_) {
    if (tried_[posture_] || (least_joint_ >= 0 && excess_[posture_] > least_excess_ + limit_rounding)) continue;
    tried_[posture_] = true;
    return;
  }
  if (least_joint_ < 0) {
    begin_numeric();
    return;
  }
  result_.joint = least_joint_;
  result_.error = least_error_;
  finish(IkOutcome::joint_limit, least_, least_excess_);
}

// The start, or one of Newton's steps on the true chain.
void Ik::polish() {
  ++result_.iterations;
  if (polish_steps_ == 0) {
    Descent::Rules rules;
    rules.limited = stage_ == Stage::within;
    const JointValues& q = postures_.q[posture_];
    polish_.start(chain_, task_, rules, rules.limited ? drawn_in(chain_, q) : q);
  } else {
    polish_.iterate(chain_, task_);
  }
  const bool is_one = polish_steps_ > 0 || polish_.error() <= no_posture;
  ++polish_steps_;
  if (is_one && polish_.is_met())
    polished();
  else if (!is_one || polish_steps_ > most_polishing)
    next_posture();
}

void Ik::polished() {
  if (stage_ == Stage::beyond) {
    keep_least_excess();
    return;
  }
  const JointValues q = chain_.unwound(polish_.q(), given_);
  // Of infinitely many another may be nearer.
  const bool too_far = config_.stay && chain_.travel_rad(given_, q) > jump_rad;
  if (too_far && (postures_.more || frees_joints(task_, chain_.length_m()))) {
    begin_numeric();
    return;
  }
  result_.error = task_error(task_, polish_.state().tool, polish_.state().tool_m);
  finish(IkOutcome::solved, q, 0);
}

void Ik::keep_least_excess() {
  double past = 0;
  const int worst = worst_joint(chain_, polish_.q(), past);
  const TaskError error = task_error(task_, polish_.state().tool, polish_.state().tool_m);
  if (worst < 0) {  // polishing brought it in
    result_.error = error;
    finish(IkOutcome::solved, polish_.q(), 0);
    return;
  }
  if (least_joint_ < 0 || past < least_excess_) {
    least_joint_ = worst;
    least_excess_ = past;
    least_ = polish_.q();
    least_error_ = error;
  }
  next_posture();
}

void Ik::finish(IkOutcome outcome, const JointValues& posture, double excess) {
  conclude(chain_, given_, config_.stay, outcome, excess, posture, result_);
  status_ = result_.ok() ? IkStatus::solved : IkStatus::failed;
}

}  // namespace lf::chain
