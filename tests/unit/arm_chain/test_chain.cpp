#include <gtest/gtest.h>

#include <kdl/chainjnttojacsolver.hpp>
#include <limits>

#include "hal/heap_guard/heap_guard.hpp"
#include "tests/unit/all_named.hpp"
#include "tests/unit/arm_chain/random_postures.hpp"
#include "tests/unit/arm_chain/referee.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261127;

// Three joints of both kinds with crooked axes, which none of the real arms has.
RealArm crooked() {
  return {"crooked",
          {{UrdfJoint::Kind::prismatic, {0.1, -0.2, 0.3}, {0.4, 0.5, -0.6}, Vec3(1, 2, -1).normalized(), -0.2, 0.5},
           {UrdfJoint::Kind::revolute, {0.3, 0, 0.1}, {-0.2, 0.1, 0.9}, Vec3(-1, 0.5, 0.2).normalized(), -2, 2},
           {UrdfJoint::Kind::fixed, {0, 0.1, 0}, {0.3, 0, 0}},
           {UrdfJoint::Kind::continuous, {0, 0.2, 0}, {0, 0, 0}, -Vec3::UnitZ()},
           {UrdfJoint::Kind::fixed, {0.05, 0, 0.2}, {1, 1, 1}}}};
}

std::vector<RealArm> all_arms() {
  std::vector<RealArm> arms = real_arms();
  arms.push_back(crooked());
  return arms;
}

TEST(ChainNames, OfEachFault) {
  test::expect_all_named<ChainFault>(8, [](ChainFault f) { return name(f); });
}

TEST(Chain, PutsTheToolWhereKdlDoes) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : all_arms()) {
    const Chain chain = chain_of(arm, true);
    Referee kdl(arm);
    RandomPostures random(chain, seed);
    for (int k = 0; k < 1000; ++k) {
      const JointValues q = random.next();
      ASSERT_LT((chain.base_from_tool(q).matrix() - kdl.raw_tool(q).matrix()).cwiseAbs().maxCoeff(), 1e-12)
          << arm.name << " " << q.transpose();
    }
  }
}

// The reference rows that came with the UR5's file: 12 digits.
TEST(Chain, PutsTheUr5WhereItsReferenceDoes) {
  const Chain chain = chain_of(ur5(), true);
  JointValues q;
  q << 5.9741, 0.0619, 0.7945, 2.1146, -5.8282, 1.6086, 0, 0;
  const Pose tool = chain.base_from_tool(q);
  EXPECT_LT((tool.translation() - Vec3(0.655324037261, -0.017072961752, -0.146336010855)).norm(), 1e-11);
  const Eigen::Quaterniond wanted(0.475075754968, -0.580210484661, 0.447948264083, 0.486827662768);
  EXPECT_LT(Eigen::Quaterniond(tool.linear()).angularDistance(wanted), 1e-10);
}

TEST(Chain, PutsItsLinksWhereKdlDoes) {
  for (const RealArm& arm : all_arms()) {
    const Chain chain = chain_of(arm, true);
    Referee kdl(arm);
    KDL::ChainFkSolverPos_recursive fk(kdl.chain());
    RandomPostures random(chain, seed + 1);
    for (int k = 0; k < 100; ++k) {
      const JointValues q = random.next();
      const std::array<Pose, max_joints> links = chain.base_from_links(q);
      std::size_t link = 0;
      for (unsigned segment = 0; segment < kdl.chain().getNrOfSegments(); ++segment) {
        if (arm.joints[segment].kind == UrdfJoint::Kind::fixed) continue;
        KDL::Frame frame;
        ASSERT_GE(fk.JntToCart(kdl.joints(q), frame, static_cast<int>(segment) + 1), 0);
        ASSERT_LT((links[link++].matrix() - Referee::pose_of(frame).matrix()).cwiseAbs().maxCoeff(), 1e-12) << arm.name << " link " << link;
      }
      ASSERT_EQ(link, chain.size());
    }
  }
}

TEST(Chain, HasKdlsJacobian) {
  for (const RealArm& arm : all_arms()) {
    const Chain chain = chain_of(arm);
    Referee kdl(arm);
    KDL::ChainJntToJacSolver solver(kdl.chain());
    KDL::Jacobian wanted(kdl.chain().getNrOfJoints());
    RandomPostures random(chain, seed + 2);
    for (int k = 0; k < 1000; ++k) {
      const JointValues q = random.next();
      ASSERT_GE(solver.JntToJac(kdl.joints(q), wanted), 0);
      const Jacobian ours = chain.jacobian(q);
      const auto n = static_cast<Eigen::Index>(chain.size());
      ASSERT_LT((ours.leftCols(n) - wanted.data).cwiseAbs().maxCoeff(), 1e-12) << arm.name;
      ASSERT_TRUE(ours.rightCols(static_cast<Eigen::Index>(max_joints) - n).isZero(0));
    }
  }
}

TEST(Chain, HasTheJacobianOfItsOwnDifferences) {
  constexpr double h = 1e-6;
  for (const RealArm& arm : all_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 3);
    for (int k = 0; k < 100; ++k) {
      const JointValues q = random.next();
      const Jacobian j = chain.jacobian(q);
      for (std::size_t i = 0; i < chain.size(); ++i) {
        JointValues a = q, b = q;
        a[i] -= h;
        b[i] += h;
        const Pose from = chain.base_from_tool(a), to = chain.base_from_tool(b);
        const Vec3 linear = (to.translation() - from.translation()) / (2 * h);
        const Eigen::AngleAxisd turn(Mat3(to.linear() * from.linear().transpose()));
        const Vec3 angular = turn.angle() * turn.axis() / (2 * h);
        ASSERT_LT((j.col(i).head<3>() - linear).norm(), 1e-8) << arm.name;
        ASSERT_LT((j.col(i).tail<3>() - angular).norm(), 1e-8) << arm.name;
      }
    }
  }
}

TEST(Chain, IsNeverLongerThanItSays) {
  for (const RealArm& arm : all_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 4);
    double farthest = 0;
    for (int k = 0; k < 3000; ++k) {
      const JointValues q = random.next();
      ChainState state;
      chain.evaluate(q, state);
      // A slide's own travel moves its origin: the way counts from where the joint is at 0.
      const Vec3 first = chain.joint(0).parent_from_joint.translation();
      farthest = std::max(farthest, (state.tool_m - first).norm());
    }
    EXPECT_LE(farthest, chain.length_m()) << arm.name;
    EXPECT_GT(farthest, 0.5 * chain.length_m()) << arm.name << ": and not idly long";
  }
}

TEST(Chain, RefusesWhatIsNoChain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ChainJoint good{JointKind::revolute, Pose::Identity(), Vec3::UnitZ(), -1, 1, true};
  Chain chain;
  const auto fault = [&](const auto& change) {
    std::array<ChainJoint, 2> joints{good, good};
    change(joints[1]);
    return chain.set(joints, Pose::Identity());
  };
  EXPECT_EQ(fault([](ChainJoint&) {}), ChainFault::none);
  EXPECT_EQ(chain.size(), 2u);
  EXPECT_EQ(fault([&](ChainJoint& j) { j.axis.x() = nan; }), ChainFault::not_a_number);
  EXPECT_EQ(fault([&](ChainJoint& j) { j.upper = nan; }), ChainFault::not_a_number);
  EXPECT_EQ(fault([&](ChainJoint& j) { j.parent_from_joint.translation().y() = -1 / 0.0; }), ChainFault::not_a_number);
  EXPECT_EQ(fault([](ChainJoint& j) { j.axis.setZero(); }), ChainFault::no_axis);
  EXPECT_EQ(fault([](ChainJoint& j) { j.parent_from_joint.linear() *= 1.1; }), ChainFault::not_a_rotation);
  EXPECT_EQ(fault([](ChainJoint& j) { j.parent_from_joint.linear().col(0) *= -1; }), ChainFault::not_a_rotation);
  EXPECT_EQ(fault([](ChainJoint& j) { j.lower = 2; }), ChainFault::limits_crossed);
  EXPECT_EQ(fault([](ChainJoint& j) {
              j.kind = JointKind::prismatic;
              j.limited = false;
            }),
            ChainFault::unlimited_prismatic);
  EXPECT_EQ(chain.set({}, Pose::Identity()), ChainFault::no_joint);
  const std::array<ChainJoint, 9> nine{good, good, good, good, good, good, good, good, good};
  EXPECT_EQ(chain.set(nine, Pose::Identity()), ChainFault::too_many_joints);
  Pose mirrored = Pose::Identity();
  mirrored.linear()(2, 2) = -1;
  EXPECT_EQ(chain.set(std::array{good}, mirrored), ChainFault::not_a_rotation);
  EXPECT_EQ(chain.size(), 2u) << "a fault leaves the chain as it was";
}

TEST(Chain, TakesAnAxisOfAnyLength) {
  ChainJoint joint{JointKind::revolute, Pose::Identity(), Vec3(0, 0, 25), -1, 1, true};
  Pose tool = Pose::Identity();
  tool.translation().x() = 1;
  Chain chain;
  ASSERT_EQ(chain.set(std::array{joint}, tool), ChainFault::none);
  JointValues q = JointValues::Zero();
  q[0] = 0.5;
  EXPECT_LT((chain.base_from_tool(q).translation() - Vec3(std::cos(0.5), std::sin(0.5), 0)).norm(), 1e-15);
}

TEST(Chain, UnwindsToTheTurnThatIsNearestAndWithinTheLimits) {
  const Chain chain = chain_of(ur5());
  const auto first = [&](double value, double near) {
    JointValues q = JointValues::Zero(), n = JointValues::Zero();
    q[0] = value;
    n[0] = near;
    return chain.unwound(q, n)[0];
  };
  EXPECT_NEAR(first(0.1, 6.0), 0.1 + 2 * pi - 2 * pi, 1e-12) << "0.1 + 2 pi is past the limit";
  EXPECT_NEAR(first(-0.1, 6.0), -0.1 + 2 * pi, 1e-12);
  EXPECT_NEAR(first(20, 0), 20 - 6 * pi, 1e-12);
  EXPECT_NEAR(first(3, -3), 3 - 2 * pi, 1e-12);
  EXPECT_EQ(first(2 * pi, 6.2), 2 * pi) << "a limit is inside";
  const Chain narrow = chain_of(predator());  // +-1.0472
  JointValues q = JointValues::Zero();
  q[0] = 1.2 - 2 * pi;
  EXPECT_NEAR(narrow.unwound(q, JointValues::Zero())[0], 1.2, 1e-12) << "outside either way: the side that passes less";
}

TEST(Chain, EvaluatesWithoutTheHeap) {
  if (!hal::HeapGuard::available()) GTEST_SKIP() << "sanitizers bring their own allocator";
  const Chain chain = chain_of(panda());
  double sum = 0;
  const std::uint64_t before = hal::HeapGuard::calls();
  {
    const hal::CoreSection core;
    const Chain copy = chain;
    sum += copy.jacobian(copy.middle()).sum() + copy.base_from_links(copy.middle())[6].translation().sum();
  }
  EXPECT_EQ(hal::HeapGuard::calls() - before, 0u) << sum;
}

}  // namespace
}  // namespace lf::chain
