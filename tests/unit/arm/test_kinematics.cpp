#include <gtest/gtest.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e.hpp"
#include "tests/unit/arm/kdl_arm.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20131;

Pose pose_of(const KDL::Frame& frame) {
  Pose pose = Pose::Identity();
  for (int r = 0; r < 3; ++r) {
    pose.translation()[r] = frame.p[r];
    for (int c = 0; c < 3; ++c) pose.linear()(r, c) = frame.M(r, c);
  }
  return pose;
}

TEST(Kinematics, EqualsKdlToTwelveDigits) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const KDL::Chain chain = kdl_arm();
  KDL::ChainFkSolverPos_recursive solver(chain);
  RandomJoints random(seed);
  for (int i = 0; i < 20'000; ++i) {
    const JointVector q = random.next();
    KDL::Frame frame;
    ASSERT_EQ(solver.JntToCart(kdl_joints(q), frame), 0);
    ASSERT_LT((test::arm5e.base_from_tool(q).matrix() - pose_of(frame).matrix()).cwiseAbs().maxCoeff(), 1e-12) << q.transpose();
    ASSERT_LT((test::arm5e.approach_axis(q) - pose_of(frame).linear().col(2)).norm(), 1e-12);
  }
}

TEST(Kinematics, JacobianEqualsKdls) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const KDL::Chain chain = kdl_arm();
  KDL::ChainJntToJacSolver solver(chain);
  RandomJoints random(seed + 1);
  for (int i = 0; i < 5'000; ++i) {
    const JointVector q = random.next();
    KDL::Jacobian peer(4);
    ASSERT_EQ(solver.JntToJac(kdl_joints(q), peer), 0);
    ASSERT_LT((test::arm5e.jacobian(q).leftCols<4>() - peer.data).cwiseAbs().maxCoeff(), 1e-12) << q.transpose();
  }
}

TEST(Kinematics, JacobianEqualsFiniteDifferencesOfThePose) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 2);
  constexpr double h = 1e-6;
  for (int i = 0; i < 500; ++i) {
    const JointVector q = random.next();
    const Jacobian j = test::arm5e.jacobian(q);
    for (int k = 0; k < 4; ++k) {
      const Pose above = test::arm5e.base_from_tool(q + h * JointVector::Unit(k));
      const Pose below = test::arm5e.base_from_tool(q - h * JointVector::Unit(k));
      const Vec3 linear = (above.translation() - below.translation()) / (2 * h);
      const Mat3 spin = (above.linear() - below.linear()) / (2 * h) * test::arm5e.base_from_tool(q).linear().transpose();
      ASSERT_LT((j.col(k).head<3>() - linear).norm(), 1e-8);
      ASSERT_LT((j.col(k).tail<3>() - Vec3(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 1e-8);
    }
  }
}

// The checked layout of the docked panel: joints, tool point in the base frame, tilt to the panel's normal (base x).
TEST(Kinematics, ReproducesTheLayoutTable) {
  struct Row {
    JointVector q_rad;
    Vec3 tool_m;
    double tilt_deg;
  };
  const Row rows[] = {{planar_joints(0, 1.307, 1.151, 0), {0.340, 0, 0.592}, 8.2},
                      {planar_joints(0, 1.083, 1.355, 0), {0.241, 0, 0.578}, 9.3},
                      {planar_joints(0, 1.414, 1.425, 0), {0.410, 0, 0.407}, 13.7},
                      {planar_joints(0.155, 1.423, 1.321, 0), {0.410, 0.064, 0.455}, 12.0},
                      {planar_joints(-0.155, 1.423, 1.321, 0), {0.410, -0.064, 0.455}, 12.0}};
  for (const Row& row : rows) {
    EXPECT_LT((test::arm5e.base_from_tool(row.q_rad).translation() - row.tool_m).norm(), 0.001) << row.q_rad.transpose();
    EXPECT_NEAR(deg_from_rad(std::acos(test::arm5e.approach_axis(row.q_rad).x())), row.tilt_deg, 0.1) << row.q_rad.transpose();
  }
}

TEST(Kinematics, ToolXPointsUpWhenTheToolIsLevelAtRollZero) {
  const Pose tool = test::arm5e.base_from_tool(planar_joints(0, 1.307, 1.151, 0));
  EXPECT_LT(tool.linear()(2, 0), -0.98);  // base z is down
}

TEST(Kinematics, ReachesAsFarAsPublished) {
  RandomJoints random(seed + 3);
  double farthest = 0;
  for (int i = 0; i < 200'000; ++i) farthest = std::max(farthest, test::arm5e.base_from_tool(random.next()).translation().norm());
  EXPECT_LE(farthest, 1.0145);
  EXPECT_GE(farthest, 1.0100);
}

TEST(Kinematics, LaserIsCarriedByTheForearmAndIgnoresTheRoll) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  LaserCalibration laser;
  laser.tool_from_laser.translation() = Vec3(-0.090, 0.001, -0.365);
  laser.tool_from_laser.linear() = Eigen::AngleAxisd(0.01, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  RandomJoints random(seed + 4);
  for (int i = 0; i < 100; ++i) {
    JointVector q = random.next();
    const Pose with_roll = test::arm5e.base_from_laser(q, laser);
    q[3] = 0;
    EXPECT_LT((with_roll.matrix() - (test::arm5e.base_from_tool(q) * laser.tool_from_laser).matrix()).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(Kinematics, LinkPosesAreTheUrdfsChain) {
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed + 5);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = random.next();
    const double jaw = random.uniform(-0.05, 1.3);
    const LinkPoses links = test::arm5e.base_from_links(q, jaw);
    const auto turn = [](const ArmJoint& joint, double angle) { return joint.parent_from_joint * Eigen::AngleAxisd(angle, joint.axis); };
    Pose pose = Pose::Identity();
    for (std::size_t k = 0; k < 4; ++k) {
      pose = pose * turn(arm.joints[k], q[static_cast<int>(k)]);
      ASSERT_LT((links[k].matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-14) << k;
    }
    ASSERT_LT((links[4].matrix() - (pose * turn(arm.joints[4], jaw)).matrix()).cwiseAbs().maxCoeff(), 1e-14);
    ASSERT_LT((links[5].matrix() - (pose * turn(arm.finger_b, jaw)).matrix()).cwiseAbs().maxCoeff(), 1e-14);
    ASSERT_LT((test::arm5e.base_from_tool(q).matrix() - (pose * arm.wrist_from_tool).matrix()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

}  // namespace
}  // namespace lf::arm
