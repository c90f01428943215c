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
  // Works on for at most `iterations` of NumericIk's size. A closed form's postures are computed in one piece that counts as form_iterations: a call may
  // run over by all but one of them, and the calls after it do so much less. To polish a posture counts one for its start and one a step. However the
  // iterations are divided into calls, the answer is the same.
  IkStatus advance(std::uint32_t iterations);
  const IkResult& solve(const IkTask& task, const JointValues& seed, const NumericIkConfig& config = {});
  // No task takes more iterations than this.
  static std::uint32_t most_iterations(const NumericIkConfig& config);
  static constexpr std::uint32_t form_iterations = 5;

  IkStatus status() const { return status_; }
  // Complete once solved or failed.
  const IkResult& result() const { return result_; }

 private:
  enum class Stage : std::uint8_t {
    form,    // all postures, by the closed form
    within,  // the nearest within the limits is polished, and so on
    beyond,  // none is: which passes its limits least?
    numeric,
  };

  void step();
  void find_postures();
  void next_posture();
  void next_within();
  void next_beyond();
  void polish();
  void polished();
  void keep_least_excess();
  void begin_numeric();
  void finish(IkOutcome outcome, const JointValues& posture, double excess);

  Chain chain_;
  AxisGeometry geometry_;
  NumericIk numeric_;
  IkTask task_;
  NumericIkConfig config_;
  JointValues given_ = JointValues::Zero();  // the seed
  IkResult result_;
  IkStatus status_ = IkStatus::idle;
  Stage stage_ = Stage::numeric;
  std::uint32_t owed_ = 0;  // iterations that a piece of work took beyond its call's
  // Of the closed form: its postures with their travel and what they pass limits by, those that were polished, and the one that is.
  Postures postures_;
  std::array<double, Postures::capacity> travel_rad_{}, excess_{};
  std::array<bool, Postures::capacity> tried_{};
  std::size_t posture_ = 0;
  Descent polish_;
  std::uint32_t polish_steps_ = 0;
  // Of those beyond the limits: the one that passes them least.
  int least_joint_ = -1;
  double least_excess_ = 0;
  JointValues least_ = JointValues::Zero();
  TaskError least_error_;
};

}  // namespace lf::chain
