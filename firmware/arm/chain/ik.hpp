// Inverse kinematics of one arm: the closed form that its axes allow, chosen when the arm is loaded, or the numeric solver; one call for all.
//
// Of a closed form's postures the one nearest to the seed is taken that is within the limits. It is polished on the chain as it is, because
// descriptions write angles with few digits. Where a task has no closed form on this arm, or a target none of its postures, the numeric solver goes on.
#pragma once

#include "firmware/arm/chain/closed_forms.hpp"
#include "firmware/arm/chain/numeric_ik.hpp"

namespace lf::chain {

class Ik {
 public:
  Ik() = default;
  explicit Ik(const Chain& chain) : chain_(chain), geometry_(classify(chain)) {}

  const Chain& chain() const { return chain_; }
  Family family() const { return geometry_.family; }
  const char* reason() const { return geometry_.reason; }
  bool closed_form_for(const IkTask& task) const { return has_closed_form(geometry_, chain_.size(), task); }

  // Takes on a task; as NumericIk::begin().
  void begin(const IkTask& task, const JointValues& seed, const NumericIkConfig& config = {});
  // Works on for at most `iterations`, which are the numeric solver's; all of a closed form with its polishing counts as one, and takes the time of
  // five. However the iterations are divided into calls, the answer is the same.
  IkStatus advance(std::uint32_t iterations);
  const IkResult& solve(const IkTask& task, const JointValues& seed, const NumericIkConfig& config = {});

  IkStatus status() const { return status_; }
  const IkResult& result() const { return status_from_numeric_ ? numeric_.result() : result_; }

 private:
  bool solve_closed();
  bool polish(const JointValues& q, bool limited, JointValues& out);
  void finish(IkOutcome outcome, const JointValues& q, int joint, double excess);

  Chain chain_;
  AxisGeometry geometry_;
  NumericIk numeric_;
  IkTask task_;
  NumericIkConfig config_;
  JointValues seed_ = JointValues::Zero();
  IkResult result_;
  IkStatus status_ = IkStatus::idle;
  bool closed_next_ = false;
  bool status_from_numeric_ = false;
};

}  // namespace lf::chain
