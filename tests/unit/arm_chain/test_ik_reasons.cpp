// Reasons that can be proved, against closed forms. The rest are found: ik_result.hpp.
#include <gtest/gtest.h>

#include "tests/unit/arm_chain/plain_kinematics.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/random_arms.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261203;

// The sum of what lies between the first joint's axis and the tool, from the arm's numbers.
double length_of(const RealArm& arm) {
  double sum_m = 0;
  bool first = true;
  for (const UrdfJoint& joint : arm.joints) {
    if (!first) sum_m += joint.xyz.norm();
    first = false;
    if (joint.kind == UrdfJoint::Kind::prismatic) sum_m += std::max(std::abs(joint.lower), std::abs(joint.upper));
  }
  return sum_m;
}

// Beyond the sum of the links nothing reaches: refused at once, without a restart, by at least what is missing to the sum.
TEST(IkReasons, ATargetBeyondTheSumOfTheLinksIsRefusedAtOnce) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Make make : makes) {
    RandomArms made(make, seed);
    for (int n = 0; n < 20; ++n) {
      const RealArm arm = made.next();
      bool slides = false;
      for (const UrdfJoint& joint : arm.joints) slides = slides || joint.kind == UrdfJoint::Kind::prismatic;
      const Chain chain = chain_of(arm);
      ASSERT_NEAR(chain.length_m(), length_of(arm), 1e-12);
      for (int k = 0; k < 5; ++k) {
        const double beyond_m = 0.001 + 0.5 * (1 + unit(engine));
        IkTask task = task_of(masks[k % 4], Pose::Identity());
        task.base_from_tool.translation() =
            arm.joints[0].xyz + Vec3(unit(engine), unit(engine), unit(engine)).normalized() * (length_of(arm) + beyond_m);
        Ik ik(chain);
        const IkResult& result = ik.solve(task, chain.middle());
        ASSERT_FALSE(result.ok());
        ASSERT_EQ(result.restarts, 0u) << arm.name;
        if (slides) {  // a longer slide would do
          ASSERT_TRUE(result.outcome == IkOutcome::out_of_reach || result.outcome == IkOutcome::joint_limit) << name(result.outcome);
        } else {
          ASSERT_EQ(result.outcome, IkOutcome::out_of_reach) << arm.name;
          ASSERT_GE(result.excess, beyond_m - 1e-9) << arm.name;
        }
      }
    }
  }
}

// Yaw and three pitches, no offsets: the approach axis stays in the vertical plane through the base and the tool.
RealArm planar_arm() {
  const auto revolute = UrdfJoint::Kind::revolute;
  return {"planar",
          {{revolute, {0, 0, 0.2}, {0, 0, 0}, Vec3::UnitZ(), -pi, pi},
           {revolute, {0, 0, 0}, {0, 0, 0}, Vec3::UnitY(), -pi, pi},
           {revolute, {0.4, 0, 0}, {0, 0, 0}, Vec3::UnitY(), -pi, pi},
           {revolute, {0.3, 0, 0}, {0, 0, 0}, Vec3::UnitY(), -pi, pi},
           {UrdfJoint::Kind::fixed, {0.2, 0, 0}, {0, 0, 0}}},
          FrameAxis::x,
          FrameAxis::y};
}

TEST(IkReasons, AnApproachOutOfAPlanarArmsPlaneMissesByItsAngleToThePlane) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const Chain chain = chain_of(planar_arm());
  RandomPostures random(chain, seed);
  Ik ik(chain);
  NumericIk numeric;
  int judged = 0;
  while (judged < 100) {
    const Pose tool = chain.base_from_tool(random.next());
    const Vec3 outward(tool.translation().x(), tool.translation().y(), 0);
    if (outward.norm() < 0.3) continue;  // near the yaw axis a little yaw turns far
    ++judged;
    const double out_rad = random.uniform(0.05, 0.6);
    const Vec3 normal = Vec3::UnitZ().cross(outward).normalized();
    IkTask task = task_of(masks[2], tool);
    task.base_from_tool.linear() = Eigen::AngleAxisd(out_rad, tool.linear().col(2).cross(normal).normalized()) * tool.linear();
    ASSERT_NEAR(std::asin(task.base_from_tool.linear().col(2).dot(normal)), out_rad, 1e-9);
    for (const IkResult& result : {ik.solve(task, chain.middle()), numeric.solve(chain, task, chain.middle())}) {
      ASSERT_EQ(result.outcome, IkOutcome::orientation_unreachable) << name(result.outcome);
      // The position is held firmly, not rigidly: it gives way by a thousandth of the arm for a hundredth of the angle.
      ASSERT_NEAR(result.excess, out_rad, 0.03 * out_rad);
      ASSERT_LE(result.excess, out_rad + 1e-6);
    }
  }
}

// Three slides along x, y and z and a yaw: what a slide lacks the tool lacks, and the tool's axis stays upright.
RealArm gantry() {
  const auto slide = [](const Vec3& axis) { return UrdfJoint{UrdfJoint::Kind::prismatic, {0, 0, 0}, {0, 0, 0}, axis, -0.5, 0.5}; };
  return {"gantry",
          {slide(Vec3::UnitX()),
           slide(Vec3::UnitY()),
           slide(Vec3::UnitZ()),
           {UrdfJoint::Kind::revolute, {0, 0, 0}, {0, 0, 0}, Vec3::UnitZ(), -3, 3},
           {UrdfJoint::Kind::fixed, {0, 0, 0.1}, {0, 0, 0}}}};
}

// A slide past its end would put the tool there, but not so turned: it would not do the task, so the reason is not its limit.
TEST(IkReasons, ALimitIsTheReasonOnlyWherePassingItDoesTheWholeTask) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const Chain chain = chain_of(gantry());
  const PlainKinematics judge(gantry());
  RandomPostures random(chain, seed);
  Ik ik(chain);
  NumericIk numeric;
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(k);
    const double beyond = random.uniform(0.01, 2), tilt_rad = random.uniform(0.1, 1);
    const int joint = k % 3;
    JointValues q = random.next();
    q[joint] = k % 2 == 0 ? 0.5 + beyond : -0.5 - beyond;
    const Pose tool = judge.pose(q);
    Pose tilted = tool;
    tilted.rotate(Eigen::AngleAxisd(tilt_rad, Vec3::UnitX()));
    for (const std::uint32_t restarts : {0U, 20U}) {
      const NumericIkConfig config{.max_restarts = restarts};
      const IkTask there = task_of(masks[1], tilted), turned = task_of(masks[2], tilted);
      for (const IkResult& result : {ik.solve(there, chain.middle(), config), numeric.solve(chain, there, chain.middle(), config)}) {
        ASSERT_EQ(result.outcome, IkOutcome::joint_limit) << name(result.outcome);
        ASSERT_EQ(result.joint, joint);
        ASSERT_NEAR(result.excess, beyond, 1e-6);
        ASSERT_TRUE(judge.fulfils(there, result.nearest));
      }
      for (const IkResult& result : {ik.solve(turned, chain.middle(), config), numeric.solve(chain, turned, chain.middle(), config)}) {
        if (restarts == 0 && result.outcome == IkOutcome::gave_up) continue;
        ASSERT_EQ(result.outcome, IkOutcome::out_of_reach) << name(result.outcome);
        ASSERT_GE(result.excess, beyond - 1e-9);
        ASSERT_LE(result.excess, 1.0001 * beyond) << "a descent ends where six iterations save less than that share";
        ASSERT_TRUE(within_limits(chain, result.nearest));
      }
    }
  }
}

}  // namespace
}  // namespace lf::chain
