#include "tests/bench/arm/arm_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>

#include "firmware/arm/inverse_kinematics.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/arm/kdl_arm.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::bench {
namespace {

using arm::JointVector;

constexpr std::size_t target_count = 4000;
constexpr int rounds = 5;

struct Target {
  JointVector q_rad;
  JointVector guess_rad;  // for the peer, which needs one: 0.3 rad off on each joint
  Vec3 tool_m;
  KDL::Frame frame;
};

std::vector<Target> targets() {
  arm::RandomJoints random(20137);
  std::vector<Target> targets(target_count);
  for (Target& t : targets) {
    t.q_rad = random.next();
    for (int i = 0; i < 4; ++i) t.guess_rad[i] = t.q_rad[i] + random.uniform(-0.3, 0.3);
    const Pose tool = test::arm5e.base_from_tool(t.q_rad);
    t.tool_m = tool.translation();
    const Mat3& r = tool.linear();
    t.frame = KDL::Frame(KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
                         KDL::Vector(t.tool_m.x(), t.tool_m.y(), t.tool_m.z()));
  }
  return targets;
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Nanoseconds a target, the best of the rounds of each, taken in turns.
template <class Ours, class Peer>
Row compare(const char* name, const char* peer_name, int ours_repeats, int peer_repeats, const Ours& ours, const Peer& peer) {
  double best_ours = 1e9, best_peer = 1e9;
  const auto repeated = [](int n, const auto& work) {
    return [n, &work] {
      for (int i = 0; i < n; ++i) work();
    };
  };
  for (int i = 0; i < rounds; ++i) {
    best_ours = std::min(best_ours, seconds_of(repeated(ours_repeats, ours)) / ours_repeats);
    best_peer = std::min(best_peer, seconds_of(repeated(peer_repeats, peer)) / peer_repeats);
  }
  const double per_target = 1e9 / static_cast<double>(target_count);
  return {name, best_ours * per_target, best_peer * per_target, peer_name, best_peer / best_ours, "ns", ""};
}

}  // namespace

std::vector<Row> run_arm_bench() {
  const std::vector<Target> all = targets();
  const KDL::Chain chain = arm::kdl_arm();
  KDL::ChainFkSolverPos_recursive peer_fk(chain);
  // Four joints cannot hold an orientation: position and the turn about the tool's axis count, as they do for ours.
  Eigen::Matrix<double, 6, 1> weights;
  weights << 1, 1, 1, 0.01, 0.01, 0.01;
  KDL::ChainIkSolverPos_LMA peer_ik(chain, weights);

  double ours_worst_m = 0, peer_worst_m = 0, sum = 0;
  std::size_t ours_solved = 0, peer_solved = 0;
  const auto ours_ik = [&] {
    for (const Target& t : all) sum += arm::inverse_kinematics(test::arm5e, t.tool_m, t.q_rad[3], 0).q_rad.sum();
  };
  KDL::JntArray q(4);
  const auto kdl_ik = [&] {
    for (const Target& t : all) {
      peer_ik.CartToJnt(arm::kdl_joints(t.guess_rad), t.frame, q);
      sum += q(0);
    }
  };
  const auto ours_fk = [&] {
    for (const Target& t : all) sum += test::arm5e.base_from_tool(t.q_rad).translation().x();
  };
  std::vector<KDL::JntArray> joints;
  for (const Target& t : all) joints.push_back(arm::kdl_joints(t.q_rad));
  KDL::Frame frame;
  const auto kdl_fk = [&] {
    for (const KDL::JntArray& j : joints) {
      peer_fk.JntToCart(j, frame);
      sum += frame.p.x();
    }
  };

  std::vector<Row> rows{compare("ik", "KDL ChainIkSolverPos_LMA", 10, 1, ours_ik, kdl_ik),
                        compare("fk", "KDL ChainFkSolverPos_recursive", 10, 10, ours_fk, kdl_fk)};
  for (const Target& t : all) {
    const arm::IkResult ik = arm::inverse_kinematics(test::arm5e, t.tool_m, t.q_rad[3], 0);
    ours_solved += ik.ok() ? 1 : 0;
    ours_worst_m = std::max(ours_worst_m, (test::arm5e.base_from_tool(ik.q_rad).translation() - t.tool_m).norm());
    if (peer_ik.CartToJnt(arm::kdl_joints(t.guess_rad), t.frame, q) < 0) continue;
    ++peer_solved;
    peer_fk.JntToCart(q, frame);
    peer_worst_m = std::max(peer_worst_m, (frame.p - t.frame.p).Norm());
  }
  char note[160];
  std::snprintf(note, sizeof note, "solved %.1f %% to %.1g m, peer %.1f %% to %.1g m from 0.3 rad off%s",
                100.0 * ours_solved / target_count, ours_worst_m, 100.0 * peer_solved / target_count, peer_worst_m, sum == 0 ? "!" : "");
  rows[0].note = note;
  return rows;
}

}  // namespace lf::bench
