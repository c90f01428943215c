// An arm of a form that has no closed forms of its own: its kinematics against its description's chain of transforms, written out here.
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>

#include "firmware/arm/clear_way.hpp"
#include "firmware/arm/inverse_kinematics.hpp"
#include "firmware/arm/kinematics.hpp"
#include "firmware/arm/trajectory.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20261128;

class AnyArm : public testing::Test {
 protected:
  AnyArm() : random_(seed) {}

  JointVector draw() {
    JointVector q = JointVector::Zero();
    for (std::size_t i = 0; i < arm.arm_joints(); ++i)
      q[static_cast<Eigen::Index>(i)] = std::uniform_real_distribution<double>(arm.joint(i).lower_rad, arm.joint(i).upper_rad)(random_);
    return q;
  }

  // base_from_link of every link of the description, the base first.
  std::vector<Pose> links_of(const JointVector& q, double jaw_rad) const {
    std::vector<Pose> links{Pose::Identity()};
    for (std::size_t i = 0; i < description.joints.size(); ++i) {
      const ArmJoint& joint = description.joints[i];
      const double angle = i < description.arm_joints() ? q[static_cast<Eigen::Index>(i)] : jaw_rad;
      links.push_back(links.back() * joint.parent_from_joint * Eigen::AngleAxisd(angle, joint.axis));
    }
    links.push_back(links[description.arm_joints()] * description.finger_b.parent_from_joint *
                    Eigen::AngleAxisd(jaw_rad, description.finger_b.axis));
    return links;
  }

  Pose tool_of(const JointVector& q) const { return links_of(q, 0)[description.arm_joints()] * description.wrist_from_tool; }

  ArmDescription description = load_arm_urdf(LANTERNFISH_TEST_DATA "/arms/six_joints/six_joints.urdf");
  Arm arm{make_model(description)};
  std::mt19937_64 random_;
};

TEST_F(AnyArm, ItsJointsAreThoseOfTheFileFromTheBaseToTheTool) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  EXPECT_EQ(description.names(), JointNames({"azimuth", "lift", "bend", "twist", "pitch", "spin", "jaw"}));
  EXPECT_EQ(description.form, ArmModel::Form::chain);
  EXPECT_EQ(arm.arm_joints(), 6u);
  EXPECT_EQ(arm.joint_count(), 7u);
  EXPECT_FALSE(arm.is_planar());
}

TEST_F(AnyArm, TheToolIsWhereTheDescriptionPutsIt) {
  for (int k = 0; k < 200; ++k) {
    const JointVector q = draw();
    const Pose tool = tool_of(q);
    ASSERT_TRUE(arm.base_from_tool(q).isApprox(tool, 1e-12)) << q.transpose();
    ASSERT_TRUE(arm.approach_axis(q).isApprox(tool.linear().col(2), 1e-12));
    JointVector unrolled = q;
    unrolled[5] = 0;
    ASSERT_TRUE(arm.base_from_unrolled_tool(q).isApprox(tool_of(unrolled), 1e-12));
  }
}

TEST_F(AnyArm, TheJacobianIsTheDifferenceOfTwoTools) {
  constexpr double step = 1e-6;
  for (int k = 0; k < 50; ++k) {
    const JointVector q = draw();
    const Jacobian j = arm.jacobian(q);
    for (Eigen::Index i = 0; i < j.cols(); ++i) {
      if (i >= 6) {
        EXPECT_TRUE(j.col(i).isZero());
        continue;
      }
      JointVector low = q, high = q;
      low[i] -= step, high[i] += step;
      const Pose a = tool_of(low), b = tool_of(high);
      const Vec3 linear = (b.translation() - a.translation()) / (2 * step);
      const Eigen::AngleAxisd turn(b.linear() * a.linear().transpose());
      ASSERT_LT((j.col(i).head<3>() - linear).norm(), 1e-8) << i;
      ASSERT_LT((j.col(i).tail<3>() - turn.angle() / (2 * step) * turn.axis()).norm(), 1e-8) << i;
    }
  }
}

// Points of every shape that collides, wherever the arm is.
TEST_F(AnyArm, CapsulesContainItsShapesInEveryPose) {
  for (int k = 0; k < 60; ++k) {
    const JointVector q = draw();
    const double jaw_rad = std::uniform_real_distribution<double>(arm.jaw().lower_rad, arm.jaw().upper_rad)(random_);
    const std::vector<Pose> links = links_of(q, jaw_rad);
    const LinkCapsules capsules = arm.link_capsules(q, jaw_rad);
    for (std::size_t link = 1; link < links.size(); ++link) {
      for (const scene::Shape& shape : description.links[link].shapes) {
        if (!shape.collides) continue;
        for (int corner = 0; corner < 8; ++corner) {
          Vec3 half = shape.size_m / 2;
          if (shape.kind == scene::ShapeKind::cylinder)
            half = Vec3(shape.size_m.x() / std::sqrt(2), shape.size_m.x() / std::sqrt(2), shape.size_m.z() / 2);
          const Vec3 p = links[link] * shape.body_from_shape *
                         half.cwiseProduct(Vec3((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1));
          bool inside = false;
          for (const Capsule& c : capsules) inside = inside || (c.link == link && clearance_between(c, {link, p, p, 0}) <= 0);
          ASSERT_TRUE(inside) << description.links[link].name;
        }
      }
    }
  }
}

// By what ClearWay vouches for the way between two poses.
TEST_F(AnyArm, NoPointMovesFartherThanItsReachSays) {
  double nearest_share = 0;
  for (int k = 0; k < 300; ++k) {
    const JointVector from = draw();
    JointVector to = from;
    for (std::size_t i = 0; i < arm.arm_joints(); ++i)
      to[static_cast<Eigen::Index>(i)] += 1e-3 * std::uniform_real_distribution<double>(-1, 1)(random_);
    const double jaw_rad = std::uniform_real_distribution<double>(arm.jaw().lower_rad, arm.jaw().upper_rad)(random_);
    const double bound_m = (to - from).cwiseAbs().dot(arm.reach_m(jaw_rad));
    const LinkCapsules before = arm.link_capsules(from, jaw_rad), after = arm.link_capsules(to, jaw_rad);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double moved_m = std::max((after[i].a_m - before[i].a_m).norm(), (after[i].b_m - before[i].b_m).norm());
      ASSERT_LE(moved_m, bound_m);
      nearest_share = std::max(nearest_share, moved_m / bound_m);
    }
  }
  EXPECT_GT(nearest_share, 0.2) << "a bound, and not any number";
}

// Not neighbours, not the fingers with each other, and not with the two links that they open ahead of.
TEST_F(AnyArm, HoldsTheLinksAgainstEachOtherThatCanMeet) {
  const std::set<std::pair<std::size_t, std::size_t>> pairs{{1, 3}, {1, 4}, {1, 5}, {1, 6}, {1, 7}, {1, 8}, {2, 4}, {2, 5}, {2, 6},
                                                            {2, 7}, {2, 8}, {3, 5}, {3, 6}, {3, 7}, {3, 8}, {4, 6}, {4, 7}, {4, 8}};
  for (int k = 0; k < 200; ++k) {
    const LinkCapsules capsules = arm.link_capsules(draw(), 0.3);
    double least = HUGE_VAL;
    for (const Capsule& a : capsules) {
      for (const Capsule& b : capsules) {
        if (pairs.count({a.link, b.link}) > 0) least = std::min(least, clearance_between(a, b));
      }
    }
    ASSERT_EQ(clearance_to_itself(capsules), least);
  }
}

// The planar form's closed forms do not answer for it.
TEST_F(AnyArm, HasNotThePlanarFormsPostures) {
  const JointVector q = draw();
  EXPECT_EQ(inverse_kinematics(arm, Vec3(0.4, 0, 0.4), 0).outcome, IkOutcome::other_form);
  EXPECT_EQ(inverse_kinematics(arm, posture_of(arm, q), Vec3(0.4, 0, 0.4), 0).outcome, IkOutcome::other_form);
}

// Four joints before the roll place a tool and do not point it: no straight way is planned for such an arm.
TEST_F(AnyArm, WithFewerJointsThanPointingTakesItGoesNoStraightWay) {
  ArmModel few = make_model(description);
  few.arm_joints = 5;
  const Arm of_few(few);
  const JointVector q = draw();
  CartesianLine line;
  const LinePlan plan = line.plan(of_few, q, Vec3(0.4, 0, 0.4), 0, {}, of_few.limits());
  EXPECT_NE(plan.outcome, PlanOutcome::ok);
  EXPECT_EQ(plan.ik, IkOutcome::other_form);
  EXPECT_EQ(line.sample(0.1).q_rad, q) << "stands where it is";
}

TEST_F(AnyArm, MotionsMoveAllOfItsJoints) {
  const JointLimits limits = arm.limits(0.05, 0.5);
  EXPECT_EQ(limits.joints, 6u);
  JointVector from = JointVector::Zero(), to = JointVector::Zero();
  to.head<6>() << 0.3, 0.4, -0.5, 0.6, 0.2, -1.0;
  JointTrajectory motion;
  ASSERT_EQ(motion.plan(from, to, limits), PlanOutcome::ok);
  for (int i = 0; i <= 200; ++i) {
    const JointState state = motion.sample(motion.duration_s() * i / 200);
    for (Eigen::Index k = 0; k < 6; ++k) {
      ASSERT_LE(std::abs(state.qd_rad_s[k]), limits.velocity_rad_s[k] * (1 + 1e-9));
      ASSERT_LE(std::abs(state.qdd_rad_s2[k]), limits.acceleration_rad_s2[k] * (1 + 1e-9));
    }
    ASSERT_TRUE(state.q_rad.tail<2>().isZero());
  }
  EXPECT_TRUE(motion.sample(motion.duration_s()).q_rad.isApprox(to));
  const JointStop stop(motion.sample(motion.duration_s() / 2), limits);
  EXPECT_TRUE(stop.sample(stop.duration_s()).qd_rad_s.isZero(1e-9));
  EXPECT_GT(stop.duration_s(), 0);
}

}  // namespace
}  // namespace lf::arm
