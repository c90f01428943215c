#include "firmware/arm/chain/descent.hpp"

#include <algorithm>
#include <cmath>

namespace lf::chain {
namespace {

constexpr double damping_per_error = 0.02;  // the fewest iterations on the five arms of the tests, 2026-11-27
constexpr double least_damping = 1e-13;     // keeps a singular system solvable, and Newton's step within 1e-13 of itself
constexpr double largest_step_rad = 1.5;
constexpr int mark_iterations = 6;

// A symmetric positive definite system of N equations. Its size is known to the compiler, which halves an iteration's time.
template <std::size_t N>
struct System {
  double a[N][N];  // the lower triangle
  double b[N];     // becomes the solution

  // By LDL', in place.
  void solve() {
    double diagonal[N];
    double inverse[N];
    for (std::size_t j = 0; j < N; ++j) {
      double scaled[N] = {};  // row j times the diagonal
      double d = a[j][j];
      for (std::size_t k = 0; k < j; ++k) {
        scaled[k] = a[j][k] * diagonal[k];
        d -= a[j][k] * scaled[k];
      }
      diagonal[j] = d;
      inverse[j] = 1 / d;
      for (std::size_t i = j + 1; i < N; ++i) {
        double s = a[i][j];
        for (std::size_t k = 0; k < j; ++k) s -= a[i][k] * scaled[k];
        a[i][j] = s * inverse[j];
      }
    }
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    for (std::size_t i = 0; i < N; ++i) b[i] *= inverse[i];
    for (std::size_t i = N; i-- > 0;)
      for (std::size_t k = i + 1; k < N; ++k) b[i] -= a[k][i] * b[k];
  }
};

}  // namespace

void Descent::start(const Chain& chain, const IkTask& task, const Rules& rules, const JointValues& q) {
  rules_ = rules;
  q_ = q;
  evaluate(chain, task);
  error_before_ = error_;
  since_mark_ = 0;
  stalled_ = false;
}

void Descent::evaluate(const Chain& chain, const IkTask& task) {
  chain.evaluate(q_, state_);
  residual(task, state_, chain.length_m(), rules_.position_weight, residual_);
  error_ = residual_.value.squaredNorm();
}

void Descent::columns(const Chain& chain, std::array<Column, max_joints>& j) const {
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vec3& axis = state_.axis[i];
    if (chain.joint(i).kind == JointKind::prismatic) {
      j[i].head<3>() = residual_.from_linear * axis;
      j[i].tail<3>().setZero();
      continue;
    }
    const Vec3 linear = axis.cross(state_.tool_m - state_.point_m[i]);
    j[i].head<3>() = residual_.from_linear * linear;
    j[i].tail<3>() = residual_.from_angular * axis;
  }
}

bool Descent::pushed_out(const Chain& chain, std::size_t i, double push) const {
  const ChainJoint& joint = chain.joint(i);
  if (!rules_.limited || chain.full_turn(i)) return false;
  return (q_[i] >= joint.upper && push > 0) || (q_[i] <= joint.lower && push < 0);
}

// The step of N >= size() joints; those past the chain's and those that are pushed outward at their limit stand still.
template <std::size_t N>
void Descent::find_step(const Chain& chain, const JointValues& q_near, double pull, double damping, JointValues& d) const {
  std::array<Column, max_joints> j;
  columns(chain, j);
  for (std::size_t i = chain.size(); i < N; ++i) j[i].setZero();
  System<N> system;
  for (std::size_t i = 0; i < N; ++i) {
    const double square = chain.weights()[i] * chain.weights()[i];
    const double push = j[i].dot(residual_.value) + pull * square * (q_near[i] - q_[i]);
    const bool still = i >= chain.size() || pushed_out(chain, i, push);
    if (still) j[i].setZero();
    system.b[i] = still ? 0 : push;
    for (std::size_t c = 0; c <= i; ++c) system.a[i][c] = j[i].dot(j[c]);
    system.a[i][i] += still ? 1 : (damping + pull) * square;
  }
  system.solve();
  for (std::size_t i = 0; i < N; ++i) d[i] = system.b[i];
}

void Descent::step(const Chain& chain, const IkTask& task, const JointValues& q_near, double pull, double damping) {
  JointValues d = JointValues::Zero();
  switch (chain.size()) {
    case 5: find_step<5>(chain, q_near, pull, damping, d); break;
    case 6: find_step<6>(chain, q_near, pull, damping, d); break;
    case 7: find_step<7>(chain, q_near, pull, damping, d); break;
    case 8: find_step<8>(chain, q_near, pull, damping, d); break;
    default: find_step<4>(chain, q_near, pull, damping, d); break;
  }
  const double largest = d.cwiseProduct(chain.weights()).cwiseAbs().maxCoeff();
  if (largest > largest_step_rad) d *= largest_step_rad / largest;
  q_ += d;
  if (rules_.limited) {
    for (std::size_t i = 0; i < chain.size(); ++i)
      if (!chain.full_turn(i)) q_[i] = std::clamp(q_[i], chain.joint(i).lower, chain.joint(i).upper);
  }
  evaluate(chain, task);
}

void Descent::iterate(const Chain& chain, const IkTask& task) {
  step(chain, task, q_, 0, damping_per_error * error_ + rules_.remaining_damping * std::sqrt(error_) + least_damping);
  if (++since_mark_ < mark_iterations) return;
  stalled_ = !(error_ < error_before_ / rules_.fall);
  error_before_ = error_;
  since_mark_ = 0;
}

void Descent::iterate_toward(const Chain& chain, const IkTask& task, const JointValues& q_near, double pull) {
  step(chain, task, q_near, pull, least_damping);
}

int Descent::rank(const Chain& chain) const {
  std::array<Column, max_joints> j;
  columns(chain, j);
  for (std::size_t i = 0; i < chain.size(); ++i) j[i] /= chain.weights()[i];
  // Gram and Schmidt, the longest column first.
  int rank = 0;
  std::array<bool, max_joints> used{};
  for (std::size_t turn = 0; turn < chain.size(); ++turn) {
    std::size_t best = max_joints;
    double longest = 1e-4;  // rad of tool per rad of joint: less is no motion to speak of
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (used[i] || !(j[i].norm() > longest)) continue;
      longest = j[i].norm();
      best = i;
    }
    if (best == max_joints) break;
    used[best] = true;
    ++rank;
    const Column unit = j[best].normalized();
    for (std::size_t i = 0; i < chain.size(); ++i) j[i] -= unit * unit.dot(j[i]);
  }
  return rank;
}

}  // namespace lf::chain
