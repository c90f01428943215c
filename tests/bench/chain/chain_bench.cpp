#include "tests/bench/chain/chain_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <kdl/chainiksolverpos_lma.hpp>

#include "tests/unit/arm_chain/plain_kinematics.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/random_arms.hpp"

namespace lf::bench {
namespace {

using namespace lf::chain;

constexpr int poses = 10'000;
constexpr int peer_poses = 1'000;                    // KDL takes 0.2 ms a pose: the whole is to take seconds
constexpr int random_arms = 400, random_poses = 50;  // of each make, on each arm
constexpr int rounds = 3;                            // of each, in turns: the best mean of a round counts
// KDL's LMA ends at this norm of all six errors, equally weighted: m and rad.
constexpr double peer_precision = 1e-5;
constexpr std::uint64_t seed = 20261127;

double microseconds() { return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Mean and 99th percentile of a round's times.
struct Times {
  double mean_us = 1e300, p99_us = 0;

  void take_better(std::vector<double>& round_us) {
    double sum = 0;
    for (const double one : round_us) sum += one;
    const double mean = sum / static_cast<double>(round_us.size());
    if (mean >= mean_us) return;
    mean_us = mean;
    const auto p99 = round_us.begin() + static_cast<std::ptrdiff_t>(round_us.size() * 99 / 100);
    std::nth_element(round_us.begin(), p99, round_us.end());
    p99_us = *p99;
  }
};

struct Case {
  std::string name;
  const RealArm& arm;
  Mask mask;
  double near_rad;  // 0: from the middle of the limits
  bool closed;
};

KDL::Frame frame_of(const Pose& pose) {
  const Mat3& r = pose.linear();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          KDL::Vector(pose.translation().x(), pose.translation().y(), pose.translation().z())};
}

struct Target {
  IkTask task;
  JointValues start;
  KDL::Frame frame;  // the same for the peer
  KDL::JntArray from;
};

std::vector<Target> targets_of(const Case& c, const Chain& chain, Referee& kdl) {
  RandomPostures random(chain, seed);
  std::vector<Target> targets;
  for (int k = 0; k < poses; ++k) {
    const JointValues q = random.next();
    const JointValues start = c.near_rad > 0 ? random.near(q, c.near_rad) : chain.middle();
    targets.push_back({task_of(c.mask, kdl.tool(q)), start, frame_of(kdl.raw_tool(q)), kdl.joints(start)});
  }
  return targets;
}

Row run(const Case& c) {
  const Chain chain = chain_of(c.arm);
  Referee kdl(c.arm);
  const std::vector<Target> targets = targets_of(c, chain, kdl);
  Ik ik(chain);
  NumericIk numeric;
  KDL::ChainIkSolverPos_LMA peer(kdl.chain(), Eigen::Matrix<double, 6, 1>::Ones(), peer_precision);

  Times ours, theirs;
  std::vector<IkResult> results(targets.size());
  std::vector<JointValues> peer_results(peer_poses, JointValues::Constant(1e9));
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> round_us;
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const double begin = microseconds();
      const IkResult& result =
          c.closed ? ik.solve(targets[k].task, targets[k].start) : numeric.solve(chain, targets[k].task, targets[k].start);
      round_us.push_back(microseconds() - begin);
      results[k] = result;
    }
    ours.take_better(round_us);
    round_us.clear();
    KDL::JntArray found(kdl.chain().getNrOfJoints());
    for (std::size_t k = 0; k < peer_poses; ++k) {
      const double begin = microseconds();
      const int outcome = peer.CartToJnt(targets[k].from, targets[k].frame, found);
      round_us.push_back(microseconds() - begin);
      if (outcome < 0) continue;
      peer_results[k].setZero();
      peer_results[k].head(found.data.size()) = found.data;
    }
    theirs.take_better(round_us);
  }

  int solved = 0, wrong = 0, peer_solved = 0, peer_inside = 0;
  std::uint32_t most_restarts = 0;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    most_restarts = std::max(most_restarts, results[k].restarts);
    if (!results[k].ok()) continue;
    ++solved;
    wrong += kdl.fulfils(targets[k].task, results[k].q) && within_limits(chain, results[k].q) ? 0 : 1;
  }
  for (std::size_t k = 0; k < peer_poses; ++k) {
    if (peer_results[k][0] > 1e8 || !kdl.fulfils(targets[k].task, peer_results[k], 2 * peer_precision)) continue;
    ++peer_solved;
    peer_inside += within_limits(chain, chain.unwound(peer_results[k], targets[k].start)) ? 1 : 0;
  }
  char note[200];
  std::snprintf(note, sizeof note, "solved %d of %d, %d wrong, p99 %.1f us, restarts at most %u; peer %.1f %%, within limits %.1f %%",
                solved, poses, wrong, ours.p99_us, most_restarts, 100.0 * peer_solved / peer_poses, 100.0 * peer_inside / peer_poses);
  return {c.name, ours.mean_us, theirs.mean_us, "KDL ChainIkSolverPos_LMA", theirs.mean_us / ours.mean_us, "us", note};
}

// Tasks for which there is no peer: what is asked is the peer. Made and judged by kinematics that share nothing with the solvers.
class Asked {
 public:
  void ask(const PlainKinematics& judge, Ik& ik, const Mask& mask, const JointValues& q) {
    const IkTask task = task_of(mask, judge.pose(q));
    const double begin = microseconds();
    const IkResult& result = ik.solve(task, ik.chain().middle());
    times_us_.push_back(microseconds() - begin);
    most_restarts_ = std::max(most_restarts_, result.restarts);
    most_iterations_ = std::max(most_iterations_, result.iterations);
    iterations_ += result.iterations;
    if (!result.ok()) {
      refused_ += std::string(", ") + lf::chain::name(result.outcome);
      return;
    }
    ++solved_;
    closed_ += result.closed_form ? 1 : 0;
    wrong_ += judge.fulfils(task, result.q) && within_limits(ik.chain(), result.q) ? 0 : 1;
  }

  Row row(const std::string& title) {
    const auto asked = static_cast<double>(times_us_.size());
    Times times;
    times.take_better(times_us_);
    char note[200];
    std::snprintf(note, sizeof note,
                  "%d wrong, %d in closed form, mean %.1f us, p99 %.1f us, iterations %.1f, at most %u, restarts at most %u", wrong_,
                  closed_, times.mean_us, times.p99_us, iterations_ / asked, most_iterations_, most_restarts_);
    return {title,
            1.0 * solved_,
            asked,
            "asked",
            solved_ / asked,
            "poses",
            refused_.empty() ? note : note + ("; refused: " + refused_.substr(2))};
  }

 private:
  std::vector<double> times_us_;
  int solved_ = 0, wrong_ = 0, closed_ = 0;
  std::uint32_t most_restarts_ = 0, most_iterations_ = 0;
  double iterations_ = 0;
  std::string refused_;  // why, one by one
};

Row run_masked(const RealArm& arm, const Mask& mask) {
  const PlainKinematics judge(arm);
  Ik ik(chain_of(arm));
  RandomPostures random(ik.chain(), seed);
  Asked asked;
  for (int k = 0; k < poses; ++k) asked.ask(judge, ik, mask, random.next());
  return asked.row(arm.name + " " + mask.name);
}

Row run_random(Make make) {
  RandomArms made(make, seed);
  Asked asked;
  for (int n = 0; n < random_arms; ++n) {
    const RealArm arm = made.next();
    const PlainKinematics judge(arm);
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed);
    for (int k = 0; k < random_poses; ++k) asked.ask(judge, ik, mask_for(ik.chain().size()), random.next());
  }
  return asked.row(std::string("random arms, ") + lf::chain::name(make));
}

}  // namespace

std::vector<Row> run_chain_bench() {
  std::vector<Row> rows;
  const std::vector<RealArm> arms = real_arms();
  for (const RealArm& arm : arms) {
    rows.push_back(run({arm.name + " numeric, mid-limits", arm, masks[0], 0, false}));
    rows.push_back(run({arm.name + " numeric, 0.1 rad", arm, masks[0], 0.1, false}));
    if (classify(chain_of(arm)).family == Family::numeric) continue;
    rows.push_back(run({arm.name + " closed form", arm, masks[0], 0, true}));
  }
  for (const RealArm& arm : arms)
    for (const Mask& mask : {masks[1], masks[2], masks[3]}) rows.push_back(run_masked(arm, mask));
  for (const Make make : makes) rows.push_back(run_random(make));
  return rows;
}

}  // namespace lf::bench
