#include "tests/bench/chain/chain_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <kdl/chainiksolverpos_lma.hpp>

#include "tests/unit/arm_chain/protocol.hpp"

namespace lf::bench {
namespace {

using namespace lf::chain;

constexpr int poses = 10'000;
// KDL takes 0.2 ms a pose: of every tenth only, so that the whole takes seconds. Poses are taken in turns with ours.
constexpr int peer_share = 10;
constexpr std::uint64_t seed = 20261127;

double microseconds() { return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// What one solver did on its poses. The times are sorted at the end: another process that interrupts one pose shall not spoil the mean.
struct Score {
  std::vector<double> times_us;
  int solved = 0, wrong = 0;

  // The mean without the slowest thousandth.
  double mean_us() {
    std::sort(times_us.begin(), times_us.end());
    const std::size_t kept = times_us.size() - times_us.size() / 1000;
    double sum = 0;
    for (std::size_t i = 0; i < kept; ++i) sum += times_us[i];
    return sum / static_cast<double>(kept);
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

Row run(const Case& c) {
  const Chain chain = chain_of(c.arm);
  Ik ik(chain);
  NumericIk numeric;
  Referee kdl(c.arm);
  KDL::ChainIkSolverPos_LMA peer(kdl.chain());
  RandomPostures random(chain, seed);
  Score ours, theirs;
  std::uint32_t most_restarts = 0;
  for (int k = 0; k < poses; ++k) {
    const JointValues q = random.next();
    const JointValues start = c.near_rad > 0 ? random.near(q, c.near_rad) : chain.middle();
    const IkTask task = task_of(c.mask, kdl.tool(q));
    const double begin = microseconds();
    const IkResult& result = c.closed ? ik.solve(task, start) : numeric.solve(chain, task, start);
    ours.times_us.push_back(microseconds() - begin);
    most_restarts = std::max(most_restarts, result.restarts);
    if (result.ok()) {
      ++ours.solved;
      ours.wrong += kdl.fulfils(task, result.q) && within_limits(chain, result.q) ? 0 : 1;
    }
    if (k % peer_share != 0) continue;
    KDL::JntArray found(kdl.chain().getNrOfJoints());
    const KDL::JntArray from = kdl.joints(start);
    const KDL::Frame target = frame_of(kdl.raw_tool(q));
    const double peer_begin = microseconds();
    const int outcome = peer.CartToJnt(from, target, found);
    theirs.times_us.push_back(microseconds() - peer_begin);
    JointValues its = JointValues::Zero();
    its.head(found.data.size()) = found.data;
    its = chain.unwound(its, start);
    theirs.solved += outcome >= 0 && kdl.fulfils(task, its) && within_limits(chain, its) ? 1 : 0;
  }
  const double mean = ours.mean_us(), peer_mean = theirs.mean_us();
  char note[200];
  std::snprintf(note, sizeof note, "solved %d of %d, %d wrong, p99 %.1f us, restarts at most %u; peer %.1f %% within limits", ours.solved,
                poses, ours.wrong, ours.times_us[poses * 99 / 100], most_restarts, 100.0 * theirs.solved * peer_share / poses);
  return {c.name, mean, peer_mean, "KDL ChainIkSolverPos_LMA", peer_mean / mean, "us", note};
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
  return rows;
}

}  // namespace lf::bench
