#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <limits>

#include "hal/heap_guard/heap_guard.hpp"
#include "tests/unit/all_named.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/straight_arm.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261129;

TEST(NumericIkNames, OfEachOutcome) {
  test::expect_all_named<IkOutcome>(8, [](IkOutcome o) { return name(o); });
}

class Protocol : public testing::TestWithParam<Mask> {};

// The long form, 10,000 poses an arm, is `lanternfish bench chain`.
TEST_P(Protocol, SolvesEveryReachablePoseFromMidLimits) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : real_arms()) {
    const Chain chain = chain_of(arm);
    NumericIk ik;
    const Tally tally = run_protocol(arm, GetParam(), 1000, seed, 0,
                                     [&](const IkTask& task, const JointValues& start) { return ik.solve(chain, task, start); });
    EXPECT_EQ(tally.solved, 1000) << arm.name;
    EXPECT_EQ(tally.wrong, 0) << arm.name;
    EXPECT_EQ(tally.outside, 0) << arm.name;
    EXPECT_EQ(tally.unflagged, 0) << arm.name;
    EXPECT_LT(tally.most_restarts, 250u) << arm.name << ": half of what is allowed";
    EXPECT_LT(tally.iterations / 1000, 30) << arm.name;
  }
}

TEST_P(Protocol, SolvesEveryPoseWithinATenthOfARadianOfTheSeed) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : real_arms()) {
    const Chain chain = chain_of(arm);
    NumericIk ik;
    const Tally tally = run_protocol(arm, GetParam(), 1000, seed + 1, 0.1,
                                     [&](const IkTask& task, const JointValues& start) { return ik.solve(chain, task, start); });
    EXPECT_EQ(tally.solved, 1000) << arm.name;
    EXPECT_EQ(tally.wrong, 0) << arm.name;
    EXPECT_EQ(tally.outside, 0) << arm.name;
    EXPECT_EQ(tally.unflagged, 0) << arm.name;
    EXPECT_LT(tally.jumps, 60) << arm.name;
    EXPECT_LT(tally.iterations / 1000, 10) << arm.name;
  }
}

std::string mask_id(const testing::TestParamInfo<Mask>& info) { return info.param.id; }
INSTANTIATE_TEST_SUITE_P(Masks, Protocol, testing::ValuesIn(masks), mask_id);

// Seven joints: what is left of the way to the seed along the free direction is a small part of the whole way.
TEST(NumericIk, AnswersNearestToTheSeedWhereItIsFreeTo) {
  const Chain chain = chain_of(panda());
  RandomPostures random(chain, seed + 2);
  NumericIk ik;
  int judged = 0, nearest = 0;
  for (int k = 0; k < 1000; ++k) {
    const JointValues start = random.next();
    const IkResult result = ik.solve(chain, task_of(masks[0], chain.base_from_tool(random.next())), start);
    ASSERT_TRUE(result.ok());
    const Eigen::Matrix<double, 6, 7> j = chain.jacobian(result.q).leftCols<7>();
    const Eigen::JacobiSVD<Eigen::Matrix<double, 6, 7>> svd(j, Eigen::ComputeFullV);
    if (svd.singularValues()[5] < 0.03) continue;  // two free directions, nearly
    bool at_limit = false;
    for (int i = 0; i < 7; ++i)
      at_limit = at_limit || std::min(result.q[i] - chain.joint(i).lower, chain.joint(i).upper - result.q[i]) < 0.02;
    if (at_limit) continue;
    const Eigen::Matrix<double, 7, 1> way = (start - result.q).head<7>();
    const double left = std::abs(svd.matrixV().col(6).dot(way)) / way.norm();
    ++judged;
    nearest += left < 0.3 ? 1 : 0;
  }
  EXPECT_GT(judged, 300);
  // The rest was stopped by a limit on the way that it could have passed along.
  EXPECT_GT(nearest, 0.97 * judged) << judged;
}

// Where nothing forces it to move it stays.
TEST(NumericIk, StaysWhereItIsWhenItIsThere) {
  for (const RealArm& arm : real_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 3);
    for (int k = 0; k < 100; ++k) {
      const JointValues q = random.next();
      for (const Mask& mask : masks) {
        NumericIk ik;
        const IkResult result = ik.solve(chain, task_of(mask, chain.base_from_tool(q)), q);
        ASSERT_TRUE(result.ok());
        ASSERT_LT((result.q - q).cwiseAbs().maxCoeff(), 1e-6) << arm.name << ", " << mask.name;
      }
    }
  }
}

TEST(NumericIk, AnswersTheSameHoweverItsWorkIsDivided) {
  for (const RealArm& arm : real_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 4);
    for (int k = 0; k < 60; ++k) {
      IkTask task = task_of(masks[k % 4], chain.base_from_tool(random.next()));
      if (k % 5 == 0) task.base_from_tool.translation() *= 3;  // out of reach: the explanation is divided, too
      NumericIk at_once, divided;
      const IkResult& whole = at_once.solve(chain, task, chain.middle());
      divided.begin(chain, task, chain.middle());
      const std::uint32_t part = k % 3 == 0 ? 1 : k % 3 == 1 ? 7 : 20;
      std::uint32_t calls = 0;
      while (divided.advance(chain, part) == IkStatus::running) ++calls;
      const IkResult& parts = divided.result();
      ASSERT_EQ(parts.outcome, whole.outcome);
      ASSERT_TRUE(parts.nearest == whole.nearest) << "to the last bit";
      ASSERT_EQ(parts.excess, whole.excess);
      ASSERT_EQ(parts.iterations, whole.iterations);
      ASSERT_LE(calls, whole.iterations / part + 1);
    }
  }
}

// A straight arm's reach is the sum of its parts, whatever the direction.
TEST(NumericIk, SaysByHowMuchATargetIsOutOfReach) {
  const StraightArm arm;
  const Chain chain = arm.chain();
  RandomPostures random(chain, seed + 5);
  for (int k = 0; k < 100; ++k) {
    const double beyond_m = random.uniform(0.001, 2);
    IkTask task;
    const Vec3 direction = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    task.base_from_tool.translation() = arm.shoulder_m() + direction * (arm.reach_m() + beyond_m);
    task.axis = task.roll = k % 2 == 0;
    NumericIk ik;
    const IkResult result = ik.solve(chain, task, random.next());
    ASSERT_EQ(result.outcome, IkOutcome::out_of_reach) << k << " " << name(result.outcome);
    ASSERT_NEAR(result.excess, beyond_m, 1e-4 + 0.002 * beyond_m) << k;
    ASSERT_LE(result.iterations, NumericIk::most_iterations({}));
  }
}

TEST(NumericIkBound, GrowsWithTheRestartsAndDoesNotWrap) {
  std::uint32_t before = 0;
  for (const std::uint32_t restarts : {0U, 1U, 500U, 1'000'000U}) {
    const std::uint32_t most = NumericIk::most_iterations({.max_restarts = restarts});
    EXPECT_GT(most, before) << restarts;
    before = most;
  }
  EXPECT_EQ(NumericIk::most_iterations({.max_restarts = 0xFFFFFFFF}), before);
}

TEST(NumericIk, SaysByHowMuchATargetIsTooNear) {
  const StraightArm arm(0.5, 0.2, 0.1);  // nothing within 0.2 m of the shoulder
  const Chain chain = arm.chain();
  IkTask task;
  task.axis = task.roll = false;
  task.base_from_tool.translation() = arm.shoulder_m() + Vec3(0.03, 0.04, 0);
  NumericIk ik;
  const IkResult result = ik.solve(chain, task, chain.middle());
  EXPECT_EQ(result.outcome, IkOutcome::out_of_reach) << name(result.outcome);
  EXPECT_NEAR(result.excess, 0.15, 1e-3);
}

// Four joints: a pose turned about the approach axis keeps its position and cannot be had.
TEST(NumericIk, SaysByHowMuchAnOrientationIsMissed) {
  const Chain chain = chain_of(open_manipulator_x());
  RandomPostures random(chain, seed + 6);
  int told = 0;
  for (int k = 0; k < 50; ++k) {
    const double roll = random.uniform(0.05, 0.5);
    IkTask task = task_of(masks[0], chain.base_from_tool(random.next()));
    task.base_from_tool.linear() = task.base_from_tool.linear() * Eigen::AngleAxisd(roll, Vec3::UnitZ()).toRotationMatrix();
    NumericIk ik;
    const IkResult result = ik.solve(chain, task, chain.middle());
    ASSERT_EQ(result.outcome, IkOutcome::orientation_unreachable) << k << " " << name(result.outcome);
    ASSERT_LT(result.error.position_m, 0.01);
    ASSERT_LT(result.excess, roll * 1.01) << "the roll alone would do";
    told += result.excess > 0.9 * roll ? 1 : 0;
  }
  EXPECT_GT(told, 40) << "near the yaw axis a little yaw saves some of it";
}

// One joint is put past its limit; if no other posture helps, it is named.
TEST(NumericIk, NamesTheJointThatWouldHaveToPassItsLimit) {
  constexpr double past = 0.05;
  for (const RealArm& arm : {oberon7(), predator(), open_manipulator_x()}) {
    const Chain chain = chain_of(arm);
    Referee kdl(arm);
    RandomPostures random(chain, seed + 7);
    int named = 0, refused = 0;
    for (int k = 0; k < 100; ++k) {
      JointValues q = random.next();
      const auto joint = static_cast<std::size_t>(k) % 4;
      q[joint] = k % 8 < 4 ? chain.joint(joint).upper + past : chain.joint(joint).lower - past;
      const IkTask task = task_of(masks[0], kdl.tool(q));
      NumericIk ik;
      const IkResult result = ik.solve(chain, task, chain.middle());
      if (result.ok()) {
        ASSERT_TRUE(kdl.fulfils(task, result.q) && within_limits(chain, result.q));
        continue;
      }
      ++refused;
      ASSERT_EQ(result.outcome, IkOutcome::joint_limit) << arm.name << k << " " << name(result.outcome);
      ASSERT_TRUE(kdl.fulfils(task, result.nearest)) << "what would be needed";
      ASSERT_EQ(result.q, chain.middle());
      ASSERT_NEAR(std::abs(chain.excess(static_cast<std::size_t>(result.joint), result.nearest[result.joint])), result.excess, 1e-12);
      ASSERT_LT(result.excess, past + 1e-6);
      named += result.joint == static_cast<int>(joint) && std::abs(result.excess - past) < 1e-6 ? 1 : 0;
    }
    EXPECT_GT(refused, 30) << arm.name;
    EXPECT_GT(named, refused / 2) << arm.name;
  }
}

TEST(NumericIk, SaysThatAStretchedArmCannotStartInward) {
  const StraightArm arm;
  const Chain chain = arm.chain();
  const JointValues stretched = JointValues::Zero();
  IkTask task;
  task.base_from_tool = chain.base_from_tool(stretched);
  task.base_from_tool.translation().x() -= 0.1;
  NumericIk ik;
  EXPECT_EQ(ik.solve(chain, task, stretched, {0, 1}).outcome, IkOutcome::singular) << name(ik.result().outcome);
  EXPECT_TRUE(ik.solve(chain, task, stretched).ok()) << "from elsewhere it can";
}

TEST(NumericIk, GivesUpWithoutRestartsWhereTheyAreNeeded) {
  const Chain chain = chain_of(ur5());
  RandomPostures random(chain, seed + 8);
  int gave_up = 0;
  for (int k = 0; k < 200; ++k) {
    const IkTask task = task_of(masks[0], chain.base_from_tool(random.next()));
    NumericIk ik;
    const IkResult alone = ik.solve(chain, task, chain.middle(), {0, 1});
    const IkResult whole = ik.solve(chain, task, chain.middle());
    ASSERT_TRUE(whole.ok());
    ASSERT_EQ(alone.restarts, 0u);
    if (whole.restarts == 0) {
      ASSERT_TRUE(alone.ok());
    }
    gave_up += alone.outcome == IkOutcome::gave_up ? 1 : 0;
  }
  EXPECT_GT(gave_up, 5);
}

TEST(NumericIk, RefusesWhatIsNotANumber) {
  const Chain chain = chain_of(ur5());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e200}) {
    IkTask task;
    task.base_from_tool.translation().y() = bad;
    NumericIk ik;
    EXPECT_EQ(ik.solve(chain, task, chain.middle()).outcome, IkOutcome::not_a_number) << bad;
    JointValues start = JointValues::Zero();
    start[2] = bad;
    if (!std::isfinite(bad)) {
      EXPECT_EQ(ik.solve(chain, IkTask(), start).outcome, IkOutcome::not_a_number) << bad;
    }
  }
  NumericIk ik;
  EXPECT_EQ(ik.solve(Chain(), IkTask(), JointValues::Zero()).outcome, IkOutcome::not_a_number) << "no chain";
}

TEST(NumericIk, WorksWithoutTheHeap) {
  if (!hal::HeapGuard::available()) GTEST_SKIP() << "sanitizers bring their own allocator";
  const Chain chain = chain_of(panda());
  RandomPostures random(chain, seed + 9);
  for (int k = 0; k < 20; ++k) {
    IkTask task = task_of(masks[k % 4], chain.base_from_tool(random.next()));
    if (k % 4 == 3) task.base_from_tool.translation().x() += 3;
    NumericIk ik;
    const std::uint64_t before = hal::HeapGuard::calls();
    {
      const hal::CoreSection core;
      ik.solve(chain, task, chain.middle());
    }
    EXPECT_EQ(hal::HeapGuard::calls() - before, 0u);
  }
}

}  // namespace
}  // namespace lf::chain
