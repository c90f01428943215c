#include "firmware/arm/chain/ik.hpp"

#include <cmath>

namespace lf::chain {
namespace {

constexpr int most_polishing = 8;        // two are enough but at the border of reach
constexpr double limit_rounding = 1e-6;  // what polishing may move a joint that stands at its limit
constexpr double no_posture = 1e-4;      // the residual's square: 1e-2 rad is not what few digits or the border of reach leave
constexpr double freeing_rad = 1e-3;     // a tolerance above it lets the numeric solver look where the exact pose is out of reach

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
  seed_ = seed;
  result_ = IkResult();
  status_ = IkStatus::running;
  closed_next_ = task.valid() && seed.allFinite() && closed_form_for(task);
  status_from_numeric_ = !closed_next_;
  if (!closed_next_) {
    numeric_.begin(chain_, task, seed, config);
    status_ = numeric_.status();
    return;
  }
  for (std::size_t i = 0; i < chain_.size(); ++i) seed_[i] -= chain_.excess(i, seed[i]);
}

IkStatus Ik::advance(std::uint32_t iterations) {
  if (status_ != IkStatus::running || iterations == 0) return status_;
  if (closed_next_) {
    closed_next_ = false;
    --iterations;
    if (solve_closed()) return status_;
    status_from_numeric_ = true;
    numeric_.begin(chain_, task_, seed_, config_);
  }
  status_ = numeric_.advance(chain_, iterations);
  return status_;
}

const IkResult& Ik::solve(const IkTask& task, const JointValues& seed, const NumericIkConfig& config) {
  begin(task, seed, config);
  advance(NumericIk::most_iterations(config) + 1);
  return result();
}

// Newton's steps on the true chain until the task is met.
bool Ik::polish(const JointValues& q, bool limited, JointValues& out) {
  Descent descent;
  Descent::Rules rules;
  rules.limited = limited;
  descent.start(chain_, task_, rules, q);
  if (descent.error() > no_posture) return false;
  for (int i = 0; i < most_polishing && !descent.is_met(); ++i) {
    descent.iterate(chain_, task_);
    ++result_.iterations;
  }
  out = descent.q();
  if (descent.is_met()) result_.error = task_error(task_, descent.state().tool, descent.state().tool_m);
  return descent.is_met();
}

// False where the numeric solver has to go on.
bool Ik::solve_closed() {
  result_.closed_form = true;
  Postures postures;
  closed_forms(geometry_, chain_.size(), task_, seed_, postures);
  std::array<double, Postures::capacity> travel{}, excess{};
  for (std::size_t k = 0; k < postures.count; ++k) {
    postures.q[k] = chain_.unwound(postures.q[k], seed_);
    worst_joint(chain_, postures.q[k], excess[k]);
    travel[k] = chain_.travel_rad(seed_, postures.q[k]);
  }
  // The nearest first; those that polishing refuses fall out.
  std::array<bool, Postures::capacity> refused{};
  for (std::size_t round = 0; round < postures.count; ++round) {
    std::size_t best = Postures::capacity;
    for (std::size_t k = 0; k < postures.count; ++k)
      if (!refused[k] && excess[k] <= limit_rounding && (best == Postures::capacity || travel[k] < travel[best])) best = k;
    if (best == Postures::capacity) break;
    refused[best] = true;
    JointValues q = postures.q[best];
    for (std::size_t i = 0; i < chain_.size(); ++i) q[i] -= chain_.excess(i, q[i]);
    JointValues polished;
    if (!polish(q, true, polished)) continue;
    finish(IkOutcome::solved, chain_.unwound(polished, seed_), -1, 0);
    return true;
  }
  if (postures.more || frees_joints(task_, chain_.length_m())) return false;
  config_.search = false;  // these were all
  double least = 0;
  JointValues nearest = JointValues::Zero();
  int joint = -1;
  for (std::size_t k = 0; k < postures.count; ++k) {
    JointValues polished;
    double past = 0;
    if (refused[k] || (joint >= 0 && excess[k] > least + limit_rounding) || !polish(postures.q[k], false, polished)) continue;
    const int worst = worst_joint(chain_, polished, past);
    if (worst < 0 || (joint >= 0 && past >= least)) continue;
    least = past;
    joint = worst;
    nearest = polished;
  }
  if (joint < 0) return false;
  polish(nearest, false, nearest);  // for its error
  finish(IkOutcome::joint_limit, nearest, joint, least);
  return true;
}

void Ik::finish(IkOutcome outcome, const JointValues& q, int joint, double excess) {
  result_.outcome = outcome;
  result_.q = q;
  result_.joint = joint;
  result_.excess = excess;
  result_.travel_rad = chain_.travel_rad(seed_, q);
  result_.jump = result_.travel_rad > jump_rad;
  status_ = outcome == IkOutcome::solved ? IkStatus::solved : IkStatus::failed;
}

}  // namespace lf::chain
