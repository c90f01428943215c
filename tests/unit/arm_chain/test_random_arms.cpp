#include <gtest/gtest.h>

#include "tests/unit/arm_chain/plain_kinematics.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/random_arms.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261201;
constexpr int arms = 40, poses = 25;  // of each make

class RandomArm : public testing::TestWithParam<Make> {
 protected:
  void SetUp() override { RecordProperty("seed", std::to_string(seed)); }
};
std::string make_id(const testing::TestParamInfo<Make>& info) { return name(info.param); }
INSTANTIATE_TEST_SUITE_P(Makes, RandomArm, testing::ValuesIn(makes), make_id);

TEST_P(RandomArm, HasItsToolWhereThePlainKinematicsHaveIt) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomArms made(GetParam(), seed);
  for (int n = 0; n < arms; ++n) {
    const RealArm arm = made.next();
    const Chain chain = chain_of(arm);
    ASSERT_GT(chain.size(), 0u) << arm.name;
    RandomPostures random(chain, seed);
    for (int k = 0; k < poses; ++k) {
      const JointValues q = random.next();
      ASSERT_LT((chain.base_from_tool(q).matrix() - PlainKinematics(arm).pose(q).matrix()).cwiseAbs().maxCoeff(), 1e-12) << arm.name;
    }
  }
}

// From the middle of the limits. The long form, 100,000 poses of 2000 arms, is `lanternfish bench chain`.
TEST_P(RandomArm, ReachesEveryPoseThatItsPosturesHave) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomArms made(GetParam(), seed);
  int solved = 0, wrong = 0, closed = 0;
  std::uint32_t most_restarts = 0;
  double iterations = 0;
  for (int n = 0; n < arms; ++n) {
    const RealArm arm = made.next();
    const PlainKinematics judge(arm);
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 1);
    for (int k = 0; k < poses; ++k) {
      const IkTask task = task_of(mask_for(ik.chain().size()), judge.pose(random.next()));
      const IkResult& result = ik.solve(task, ik.chain().middle());
      closed += result.closed_form ? 1 : 0;
      iterations += result.iterations;
      if (!result.ok()) {
        ADD_FAILURE() << arm.name << " pose " << k << ": " << name(result.outcome) << " " << result.excess;
        continue;
      }
      most_restarts = std::max(most_restarts, result.restarts);
      ++solved;
      wrong += judge.fulfils(task, result.q) && within_limits(ik.chain(), result.q) ? 0 : 1;
    }
  }
  EXPECT_EQ(solved, arms * poses);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(closed, 0) << "none of these has a form";
  RecordProperty("iterations", std::to_string(iterations / (arms * poses)));
  RecordProperty("most_restarts", std::to_string(most_restarts));
}

TEST_P(RandomArm, FollowsWithoutAJump) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomArms made(GetParam(), seed);
  int solved = 0, wrong = 0, jumps = 0;
  for (int n = 0; n < arms; ++n) {
    const RealArm arm = made.next();
    const PlainKinematics judge(arm);
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 2);
    for (int k = 0; k < poses; ++k) {
      const JointValues q = random.next();
      const IkTask task = task_of(mask_for(ik.chain().size()), judge.pose(q));
      const IkResult& result = ik.solve(task, random.near(q, 0.02), {.stay = true});
      jumps += result.jump ? 1 : 0;
      if (!result.ok()) continue;
      ++solved;
      wrong += judge.fulfils(task, result.q) && within_limits(ik.chain(), result.q) ? 0 : 1;
    }
  }
  EXPECT_EQ(solved, arms * poses);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(jumps, 0);
}

// Chain::travel_rad() says what a motion may come to, slides included.
TEST_P(RandomArm, MovesItsToolNoFartherThanTheTravelSays) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomArms made(GetParam(), seed);
  double most = 0;
  for (int n = 0; n < arms; ++n) {
    const RealArm arm = made.next();
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 3);
    for (int k = 0; k < poses; ++k) {
      const JointValues from = random.next(), to = random.near(from, 0.5);
      const double moved_m = (PlainKinematics(arm).pose(to).translation() - PlainKinematics(arm).pose(from).translation()).norm();
      const double bound_m = static_cast<double>(chain.size()) * chain.lever_m() * chain.travel_rad(from, to);
      ASSERT_LE(moved_m, bound_m) << arm.name;
      most = std::max(most, moved_m / bound_m);
    }
  }
  EXPECT_GT(most, 0.1) << "and not idly large";
}

TEST(OffsetWrist, HasNoClosedForm) {
  RandomArms made(Make::offset_wrist, seed);
  EXPECT_STREQ(classify(chain_of(made.next())).reason, "joints 2, 3 and 4 are parallel, but 5 and 6 do not meet");
}

// A rail's own length is no reason to call half a metre of it a short way.
TEST(Slide, OfALongRailIsMeasuredByTheArmOnIt) {
  RealArm arm = ur5();
  arm.joints.insert(arm.joints.begin(), {UrdfJoint::Kind::prismatic, {0, 0, 0}, {0, 0, 0}, Vec3::UnitX(), 0, 20});
  const Chain chain = chain_of(arm);
  const double alone_m = chain_of(ur5()).lever_m();
  EXPECT_NEAR(chain.lever_m(), std::max(alone_m, 0.1 * chain.length_m()), 1e-12);
  JointValues from = JointValues::Zero(), to = from;
  from[1] = to[1] = 0.4;
  to[0] = 0.5 * chain.lever_m();
  EXPECT_NEAR(chain.travel_rad(from, to), 0.5, 1e-12);
  Ik ik(chain);
  const IkResult& result = ik.solve(task_of(masks[1], chain.base_from_tool(to)), to);
  ASSERT_TRUE(result.ok());
  EXPECT_LT(result.travel_rad, 1e-6);
}

}  // namespace
}  // namespace lf::chain
