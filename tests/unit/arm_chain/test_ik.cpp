#include <gtest/gtest.h>

#include "hal/heap_guard/heap_guard.hpp"
#include "tests/unit/all_named.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/straight_arm.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261130;

// ARM 5E's chain as published: yaw, two parallel pitches, a roll along the tool.
RealArm arm5e() {
  return {"arm5e",
          {{UrdfJoint::Kind::revolute, {0, 0, 0}, {0, 0, pi}, Vec3::UnitZ(), -0.52, 1.46},
           {UrdfJoint::Kind::revolute, {0.08052, 0, 0}, {pi / 2, 0, 0}, Vec3::UnitZ(), -0.1471, 1.314},
           {UrdfJoint::Kind::revolute,
            {0.44278 * std::cos(0.139277), 0.44278 * std::sin(0.139277), 0},
            {0, 0, 0.139277 + 1.972222},
            Vec3::UnitZ(),
            -1.297,
            0.73},
           {UrdfJoint::Kind::revolute, {-0.083, 0, 0}, {pi / 2, 0, 0}, Vec3::UnitZ(), -pi, pi},
           {UrdfJoint::Kind::fixed, {0, 0, 0.34407 + 0.1485}, {0, 0, 0}}}};
}

// WidowX 200's kind: yaw, three parallel pitches, a roll.
RealArm widowx() {
  const auto revolute = UrdfJoint::Kind::revolute;
  return {"widowx",
          {{revolute, {0, 0, 0.072}, {0, 0, 0}, Vec3::UnitZ(), -pi, pi},
           {revolute, {0, 0, 0.039}, {0, 0, 0}, Vec3::UnitY(), -1.88, 1.97},
           {revolute, {0.05, 0, 0.2}, {0, 0, 0}, Vec3::UnitY(), -1.88, 1.62},
           {revolute, {0.2, 0, 0}, {0, 0, 0}, Vec3::UnitY(), -1.75, 2.15},
           {revolute, {0.065, 0, 0}, {0, 0, 0}, Vec3::UnitX(), -pi, pi},
           {UrdfJoint::Kind::fixed, {0.1, 0, 0}, {0, 0, 0}}},
          FrameAxis::x,
          FrameAxis::y};
}

std::vector<RealArm> closed_arms() { return {oberon7(), predator(), ur5(), open_manipulator_x(), arm5e(), widowx()}; }

TEST(FamilyNames, OfEachFamily) {
  test::expect_all_named<Family>(4, [](Family f) { return name(f); });
}

TEST(Classify, KnowsTheFamilyOfEachArm) {
  EXPECT_EQ(classify(chain_of(oberon7())).family, Family::spherical_wrist);
  EXPECT_EQ(classify(chain_of(predator())).family, Family::planar);
  EXPECT_EQ(classify(chain_of(ur5())).family, Family::three_parallel);
  EXPECT_EQ(classify(chain_of(open_manipulator_x())).family, Family::planar);
  EXPECT_EQ(classify(chain_of(arm5e())).family, Family::planar);
  EXPECT_EQ(classify(chain_of(widowx())).family, Family::planar);
  EXPECT_EQ(classify(StraightArm().chain()).family, Family::spherical_wrist);
  const AxisGeometry seven = classify(chain_of(panda()));
  EXPECT_EQ(seven.family, Family::numeric);
  EXPECT_STREQ(seven.reason, "more than six joints");
}

TEST(Classify, SaysWhyAnArmHasNoClosedForm) {
  const auto reason = [](RealArm arm, std::size_t joint, const Vec3& shift_m, const Vec3& turn_rad) {
    arm.joints[joint].xyz += shift_m;
    arm.joints[joint].rpy += turn_rad;
    const AxisGeometry g = classify(chain_of(arm));
    EXPECT_EQ(g.family, Family::numeric);
    return std::string(g.reason);
  };
  const Vec3 none = Vec3::Zero();
  EXPECT_EQ(reason(oberon7(), 4, {0.01, 0, 0}, none), "joints 2 and 3 are parallel, but 4, 5 and 6 do not meet in a point");
  EXPECT_EQ(reason(oberon7(), 2, none, {1e-3, 0, 0}), "joints 2 and 3 are not parallel");
  EXPECT_EQ(reason(ur5(), 6, {0.01, 0, 0}, none), "joints 2, 3 and 4 are parallel, but 5 and 6 do not meet");
  EXPECT_EQ(reason(open_manipulator_x(), 2, none, {1e-3, 0, 0}), "joints 2 and 3, or 2 to 4, are not all parallel");
  RealArm sliding = ur5();
  sliding.joints[1].kind = UrdfJoint::Kind::prismatic;
  EXPECT_EQ(reason(sliding, 1, none, none), "a joint slides");
  // What few digits leave is no other geometry.
  RealArm rounded = ur5();
  rounded.joints[2].rpy.x() += 4e-6;
  EXPECT_EQ(classify(chain_of(rounded)).family, Family::three_parallel);
}

class IkProtocol : public testing::TestWithParam<Mask> {};

TEST_P(IkProtocol, SolvesEveryReachablePoseByTheFormThereIs) {
  std::vector<RealArm> arms = closed_arms();
  arms.push_back(panda());
  for (const RealArm& arm : arms) {
    Ik ik(chain_of(arm));
    for (const double near : {0.0, 0.1}) {
      const Tally tally = run_protocol(arm, GetParam(), 1000, seed, near,
                                       [&](const IkTask& task, const JointValues& start) { return ik.solve(task, start); });
      EXPECT_EQ(tally.solved, 1000) << arm.name;
      EXPECT_EQ(tally.wrong, 0) << arm.name;
      EXPECT_EQ(tally.outside, 0) << arm.name;
      EXPECT_EQ(tally.unflagged, 0) << arm.name;
      IkTask task;
      task.axis = GetParam().axis;
      task.roll = GetParam().roll;
      if (ik.closed_form_for(task)) {
        EXPECT_GE(tally.closed, 990) << arm.name << ": the numeric solver is for the degenerate ones";
      }
    }
  }
}

std::string mask_id(const testing::TestParamInfo<Mask>& info) { return info.param.id; }
INSTANTIATE_TEST_SUITE_P(Masks, IkProtocol, testing::ValuesIn(masks), mask_id);

TEST(Ik, HasAClosedFormForTheTasksItSays) {
  const auto forms = [](const RealArm& arm) {
    const Ik ik(chain_of(arm));
    std::string list;
    for (const Mask& mask : {masks[0], masks[1], masks[2], masks[3]})
      if (ik.closed_form_for(task_of(mask, Pose::Identity()))) list += std::string(list.empty() ? "" : ", ") + mask.name;
    return list;
  };
  EXPECT_EQ(forms(oberon7()), "pose");
  EXPECT_EQ(forms(ur5()), "pose");
  EXPECT_EQ(forms(predator()), "pose");
  EXPECT_EQ(forms(open_manipulator_x()), "pose, position and axis");
  EXPECT_EQ(forms(widowx()), "pose, position and axis");
  EXPECT_EQ(forms(arm5e()), "pose, position, position and roll");
  EXPECT_EQ(forms(panda()), "");
}

// The posture that a target was made of is among the closed form's, and so is whatever the numeric solver finds.
TEST(ClosedForms, HoldThePostureAndTheNumericSolversAnswer) {
  for (const RealArm& arm : closed_arms()) {
    const Chain chain = chain_of(arm);
    const AxisGeometry geometry = classify(chain);
    RandomPostures random(chain, seed + 1);
    NumericIk numeric;
    int near_singular = 0;
    for (int k = 0; k < 1000; ++k) {
      const JointValues q = random.next();
      const IkTask task = task_of(masks[0], chain.base_from_tool(q));
      Postures postures;
      closed_forms(geometry, chain.size(), task, chain.middle(), postures);
      ASSERT_GT(postures.count, 0u);
      const auto nearest = [&](const JointValues& to) {
        double least = 1e9;
        for (std::size_t i = 0; i < postures.count; ++i) {
          double largest = 0;
          for (std::size_t j = 0; j < chain.size(); ++j) largest = std::max(largest, std::abs(wrap(postures.q[i][j] - to[j])));
          least = std::min(least, largest);
        }
        return least;
      };
      const JointValues found = numeric.solve(chain, task, chain.middle()).q;
      // Near a singular posture the joints of a target are known less well than the target.
      if (nearest(q) > 1e-5 || nearest(found) > 1e-5) ++near_singular;
      ASSERT_LT(nearest(q), 0.02) << arm.name << " " << k;
      ASSERT_LT(nearest(found), 0.02) << arm.name << " " << k;
    }
    EXPECT_LT(near_singular, 10) << arm.name;
  }
}

TEST(ClosedForms, OfAPumaAreEightAndEachReachesTheTarget) {
  const Chain chain = StraightArm(0.5, 0.4, 0.1, pi).chain();
  const AxisGeometry geometry = classify(chain);
  RandomPostures random(chain, seed + 2);
  for (int k = 0; k < 1000; ++k) {
    const Pose target = chain.base_from_tool(random.next());
    Postures postures;
    closed_forms(geometry, 6, task_of(masks[0], target), JointValues::Zero(), postures);
    ASSERT_EQ(postures.count, 8u);
    for (std::size_t i = 0; i < 8; ++i)
      ASSERT_LT((chain.base_from_tool(postures.q[i]).matrix() - target.matrix()).cwiseAbs().maxCoeff(), 1e-6) << k << " " << i;
  }
}

// From near the answer there is one: closed form and numeric solver give it alike.
TEST(Ik, AgreesWithTheNumericSolverFromNearTheAnswer) {
  for (const RealArm& arm : closed_arms()) {
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 3);
    NumericIk numeric;
    int compared = 0;
    for (int k = 0; k < 1000; ++k) {
      const JointValues q = random.next();
      const JointValues start = random.near(q, 0.1);
      const IkTask task = task_of(masks[0], ik.chain().base_from_tool(q));
      const IkResult& a = ik.solve(task, start);
      const IkResult& b = numeric.solve(ik.chain(), task, start);
      ASSERT_TRUE(a.ok() && b.ok());
      if ((a.q - b.q).cwiseAbs().maxCoeff() < 1e-6) ++compared;
      ASSERT_LE(a.travel_rad, b.travel_rad + 1e-3) << arm.name << ": of all postures the nearest";
    }
    EXPECT_GT(compared, 950) << arm.name;
  }
}

TEST(Ik, RefusesAsTheNumericSolverDoes) {
  constexpr double past = 0.05;
  for (const RealArm& arm : {oberon7(), predator(), open_manipulator_x()}) {
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 4);
    NumericIk numeric;
    int refused = 0;
    for (int k = 0; k < 100; ++k) {
      JointValues q = random.next();
      const auto joint = static_cast<std::size_t>(k) % 4;
      q[joint] = k % 8 < 4 ? ik.chain().joint(joint).upper + past : ik.chain().joint(joint).lower - past;
      const IkTask task = task_of(masks[0], ik.chain().base_from_tool(q));
      const IkResult& a = ik.solve(task, ik.chain().middle());
      const IkResult& b = numeric.solve(ik.chain(), task, ik.chain().middle());
      ASSERT_EQ(a.outcome, b.outcome) << arm.name << " " << k;
      if (a.ok()) continue;
      ++refused;
      ASSERT_LE(a.excess, b.excess + 1e-6) << arm.name << " " << k << ": of all postures the one that passes least";
      Referee kdl(arm);
      ASSERT_TRUE(kdl.fulfils(task, a.nearest));
    }
    EXPECT_GT(refused, 30);
  }
}

TEST(Ik, SaysByHowMuchATargetIsOutOfReach) {
  const StraightArm arm;
  Ik ik(arm.chain());
  IkTask task;
  task.base_from_tool.translation() = arm.shoulder_m() + Vec3(0, 0.6, 0.8) * (arm.reach_m() + 0.2);
  EXPECT_EQ(ik.solve(task, JointValues::Zero()).outcome, IkOutcome::out_of_reach);
  EXPECT_NEAR(ik.result().excess, 0.2, 1e-3);
  // Less than the sum of the parts away, yet turned so that the hand's length counts against it.
  task.base_from_tool.translation() = arm.shoulder_m() + Vec3(0.85, 0, 0);
  task.base_from_tool.linear() << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  EXPECT_EQ(ik.solve(task, JointValues::Zero()).outcome, IkOutcome::orientation_unreachable) << name(ik.result().outcome);
}

// On the first axis the first joint's angle does not matter: it stays at the seed.
TEST(Ik, KeepsTheJointThatDoesNotMatter) {
  Ik ik(StraightArm().chain());
  JointValues q;
  q << 0.7, -pi / 2, 0, 0.4, 0.5, -0.3, 0, 0;  // straight up
  const IkTask task = task_of(masks[0], ik.chain().base_from_tool(q));
  JointValues start = q;
  start.tail<7>().array() += 0.05;
  start.tail<2>().setZero();
  ASSERT_TRUE(ik.solve(task, start).ok());
  EXPECT_FALSE(ik.result().jump);
  // A straight wrist: only the sum of joints 4 and 6 matters.
  q << 0.3, -0.5, 0.9, 0.4, 0, 0.6, 0, 0;
  start = q;
  start[3] += 0.2;
  ASSERT_TRUE(ik.solve(task_of(masks[0], ik.chain().base_from_tool(q)), start).ok());
  EXPECT_NEAR(ik.result().q[3], 0.6, 1e-5);
  EXPECT_NEAR(ik.result().q[5], 0.4, 1e-5);
}

TEST(Ik, FlagsAJump) {
  Ik ik(chain_of(ur5()));
  JointValues q;
  q << 0.3, -1.2, 1.1, -0.8, 0.9, 0.2, 0, 0;
  const IkTask task = task_of(masks[0], ik.chain().base_from_tool(q));
  JointValues start = q;
  start[1] += 0.29;
  EXPECT_FALSE(ik.solve(task, start).jump);
  start[1] += 0.02;
  EXPECT_TRUE(ik.solve(task, start).jump);
  EXPECT_NEAR(ik.result().travel_rad, 0.31, 1e-9);
}

TEST(Ik, AnswersTheSameHoweverItsWorkIsDivided) {
  for (const RealArm& arm : closed_arms()) {
    Ik ik(chain_of(arm)), divided(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 5);
    for (int k = 0; k < 40; ++k) {
      IkTask task = task_of(masks[k % 4], ik.chain().base_from_tool(random.next()));
      if (k % 5 == 0) task.base_from_tool.translation() *= 1.5;
      const IkResult& whole = ik.solve(task, ik.chain().middle());
      divided.begin(task, ik.chain().middle());
      while (divided.advance(3) == IkStatus::running) continue;
      ASSERT_EQ(divided.result().outcome, whole.outcome);
      ASSERT_TRUE(divided.result().nearest == whole.nearest) << arm.name << " " << k;
      ASSERT_EQ(divided.result().excess, whole.excess);
    }
  }
}

TEST(Ik, WorksWithoutTheHeap) {
  if (!hal::HeapGuard::available()) GTEST_SKIP() << "sanitizers bring their own allocator";
  for (const RealArm& arm : closed_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed + 6);
    for (int k = 0; k < 20; ++k) {
      IkTask task = task_of(masks[k % 4], chain.base_from_tool(random.next()));
      if (k % 4 == 3) task.base_from_tool.translation().x() += 3;
      const std::uint64_t before = hal::HeapGuard::calls();
      {
        const hal::CoreSection core;
        Ik ik(chain);
        ik.solve(task, chain.middle());
      }
      EXPECT_EQ(hal::HeapGuard::calls() - before, 0u);
    }
  }
}

}  // namespace
}  // namespace lf::chain
