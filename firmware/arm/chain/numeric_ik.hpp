// Inverse kinematics of any chain: descents from the seed and from random starts, an iteration at a time.
//
// The method is that of the solvers which do best on random reachable poses (TRAC-IK, Beeson and Ames, Humanoids 2015; Sugihara, T-RO 2011): descend,
// notice early that a start leads nowhere, begin elsewhere. Theirs stop by the clock; this one counts, so that one input has one answer however
// slow the processor is and however the work is divided.
//
// Where the task leaves joints free (seven joints, or a task that asks for less than the joints give) the solution then slides along the free
// directions to where it is nearest to the seed.
//
// A target that no start reaches is explained by further searches: without limits, for the position alone, and with the position held firmly.
#pragma once

#include "firmware/arm/chain/descent.hpp"
#include "firmware/arm/chain/ik_result.hpp"

namespace lf::chain {

struct NumericIkConfig {
  // How much work is allowed, and nothing else. The hardest of 10,000 random poses on each of five arms needed 32 (`lanternfish bench chain`).
  // 0: one descent from the seed, and one for each reason. A descent takes steps of up to 1.5 rad, so that its answer, or a closed form's, may be on another
  // branch all the same: that is what `stay` is for.
  std::uint32_t max_restarts = 500;
  std::uint64_t random_seed = 1;
  bool search = true;   // false: it is known that there is no solution, only the reason is wanted
  bool explain = true;  // false: where the search finds nothing it has given up; the reason would take ten times as long
  // For following a path: only an answer within jump_rad of the seed, in Chain::travel_rad(), will do, else the outcome is jump_needed, or why there is none. So
  // near, postures of two branches are both continuous with the seed: they part only at a singular posture, and there either is a short motion.
  // Starts are made around the seed alone, 20 restarts at most. Where there are several closed forms the nearest is taken, as always.
  bool stay = false;
};

class NumericIk {
 public:
  // Takes on a task. Descents begin at the seed drawn into its limits. The travel is measured from the seed as it is given: from where the arm is. O(joints).
  void begin(const Chain& chain, const IkTask& task, const JointValues& seed, const NumericIkConfig& config = {});

  // Works on for at most `iterations`; the same chain as at begin(). An iteration is one forward kinematics and one linear system of size() equations, or a
  // start with two forward kinematics, or the change from one search to the next with at most four. However the iterations are divided into calls, the
  // answer is the same.
  IkStatus advance(const Chain& chain, std::uint32_t iterations);

  // begin() and advance() to the end. Bounded: see most_iterations().
  const IkResult& solve(const Chain& chain, const IkTask& task, const JointValues& seed, const NumericIkConfig& config = {});
  // No task takes more iterations than this; at most 10^6 restarts are made.
  static std::uint32_t most_iterations(const NumericIkConfig& config);

  IkStatus status() const { return status_; }
  // Complete once solved or failed.
  const IkResult& result() const { return result_; }

 private:
  enum class Stage : std::uint8_t {
    search,         // for a solution
    approach_seed,  // along the free directions
    beyond_limits,  // would it be reached without limits, and past which?
    approach_limits,
    position_beyond_limits,  // and the position alone?
    position,                // and with limits?
    orientation,             // how far can the tool be turned at the target?
    done,
  };

  Stage first_stage(const Chain& chain) const;
  void step(const Chain& chain);
  void enter(const Chain& chain, Stage stage);
  void next_start(const Chain& chain);
  void start(const Chain& chain, const JointValues& q);
  void start_at_random(const Chain& chain);
  void start_around(const Chain& chain, const JointValues& q);
  void keep_nearest();
  void arrived(const Chain& chain);
  void found(const Chain& chain);
  void exhausted(const Chain& chain);
  void slide(const Chain& chain);
  void slid(const Chain& chain);
  void keep_least_excess(const Chain& chain);
  void explain_single_descent(const Chain& chain);
  void explain_position(const Chain& chain);
  void finish_at_limit(const Chain& chain);
  void finish_out_of_reach(const Chain& chain);
  void finish(const Chain& chain, IkOutcome outcome, double excess);
  double uniform(double lower, double upper);

  NumericIkConfig config_;
  IkTask asked_;
  IkTask task_;                              // of the stage
  JointValues given_ = JointValues::Zero();  // the seed
  JointValues seed_ = JointValues::Zero();   // within the limits
  Descent::Rules rules_;
  Descent descent_;
  IkResult result_;
  std::uint64_t random_ = 0;
  Stage stage_ = Stage::done;
  Stage before_slide_ = Stage::done;
  IkStatus status_ = IkStatus::idle;
  bool started_near_ = false;        // the seed's error was small: look around it first
  std::uint32_t starts_ = 0;         // of the stage
  std::uint32_t start_limit_ = 0;    // of the stage
  std::uint32_t descent_steps_ = 0;  // of the present descent or slide
  std::uint32_t steps_since_met_ = 0;
  // Of the stage: where a descent came nearest to its task.
  JointValues nearest_ = JointValues::Zero();
  double nearest_error_ = 0;
  // Of the search: the same, kept for the stages after it.
  JointValues searched_ = JointValues::Zero();
  // Of the search, where the arm is to stay: the nearest solution that jumps.
  bool far_found_ = false;
  JointValues far_ = JointValues::Zero();
  double far_rad_ = 0;
  // Best of a slide.
  JointValues slide_best_ = JointValues::Zero();
  double slide_distance_ = 0;
  double slide_step_ = 0;
  double slide_bound_ = 0;  // what the next step has to come under
  // Of what is reached without limits: the posture that passes them least.
  bool beyond_found_ = false;
  JointValues least_ = JointValues::Zero();
  double least_excess_ = 0;
  int least_joint_ = -1;
};

}  // namespace lf::chain
