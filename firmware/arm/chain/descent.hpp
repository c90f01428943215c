// One descent of the numeric inverse kinematics: Levenberg and Marquardt's method from one start, an iteration at a time.
//
// The damping is in proportion to the squared error (Sugihara, IEEE T-RO 27(5), 2011), so that far from the target a step is a gradient's, near it
// Newton's. Joints weigh as in Chain::weights(), so that a slide takes part alike on an arm of any size. A joint that stands at its limit and is pushed outward leaves the step. A joint whose range holds a full turn runs free and is unwound
// at the end.
#pragma once

#include "firmware/arm/chain/ik_task.hpp"

namespace lf::chain {

class Descent {
 public:
  struct Rules {
    bool limited = true;         // false: joints may pass their limits
    double position_weight = 1;  // of the position's rows over the orientation's
    double fall = 4;             // what the error has to be divided by in six iterations
    // Damping in proportion to the error itself. Where an error is to remain its curvature outweighs the Jacobian's square, and steps without this
    // go to and fro about the least error.
    double remaining_damping = 0;
  };

  // Begins at `q`. O(joints).
  void start(const Chain& chain, const IkTask& task, const Rules& rules, const JointValues& q);
  // One iteration: one solution of a system of size() equations, one forward kinematics.
  void iterate(const Chain& chain, const IkTask& task);
  // The same, with a pull of strength `pull` to `q_near`: where the task leaves joints free they go there.
  void iterate_toward(const Chain& chain, const IkTask& task, const JointValues& q_near, double pull);

  const JointValues& q() const { return q_; }
  const ChainState& state() const { return state_; }
  double error() const { return error_; }  // the residual's square
  bool is_met() const { return residual_.is_met; }
  // True once the error has not fallen as the rules ask: this start leads nowhere.
  bool stalled() const { return stalled_; }
  // The rank of the Jacobian of the task, of at most min(constraints, joints), where it stands now.
  int rank(const Chain& chain) const;

 private:
  using Column = Eigen::Matrix<double, 6, 1>;

  void evaluate(const Chain& chain, const IkTask& task);
  void columns(const Chain& chain, std::array<Column, max_joints>& j) const;
  bool pushed_out(const Chain& chain, std::size_t i, double push) const;
  template <std::size_t N>
  void find_step(const Chain& chain, const JointValues& q_near, double pull, double damping, JointValues& d) const;
  void step(const Chain& chain, const IkTask& task, const JointValues& q_near, double pull, double damping);

  Rules rules_;
  JointValues q_ = JointValues::Zero();
  ChainState state_;
  TaskResidual residual_;
  double error_ = 0;
  double error_before_ = 0;  // at the last mark
  int since_mark_ = 0;
  bool stalled_ = false;
};

}  // namespace lf::chain
