#include "shared/arm/make_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/inverse_kinematics.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/arm_description/drawn_arm.hpp"

namespace lf {
namespace {

constexpr std::uint64_t seed = 20261128;

ArmDescription shipped() { return load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf"); }

void expect_same(const ArmModel::Capsule& a, const ArmModel::Capsule& b) {
  EXPECT_EQ(a.link(), b.link());
  EXPECT_LT((a.a_m() - b.a_m()).norm(), 1e-7);
  EXPECT_LT((a.b_m() - b.b_m()).norm(), 1e-7);
  EXPECT_NEAR(a.radius_m(), b.radius_m(), 1e-7);
}

// The build's own numbers come of another program, in another language.
TEST(MakeModel, GivesWhatTheBuildMakesOfTheShippedArm) {
  const ArmModel ours = make_model(shipped());
  const ArmModel& built = test::arm5e.model();
  EXPECT_NEAR(wrap(ours.planar.mount_yaw_rad - built.planar.mount_yaw_rad), 0, 1e-12);
  EXPECT_NEAR(ours.planar.a0_m, built.planar.a0_m, 1e-12);
  EXPECT_NEAR(ours.planar.a1_m, built.planar.a1_m, 1e-12);
  EXPECT_NEAR(ours.planar.a2_m, built.planar.a2_m, 1e-12);
  EXPECT_NEAR(ours.planar.d_m, built.planar.d_m, 1e-12);
  EXPECT_NEAR(ours.planar.shoulder_offset_rad, built.planar.shoulder_offset_rad, 1e-12);
  EXPECT_NEAR(ours.planar.elbow_offset_rad, built.planar.elbow_offset_rad, 1e-12);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_EQ(ours.joints[i].lower_rad, built.joints[i].lower_rad);
    EXPECT_EQ(ours.joints[i].effort_nm, built.joints[i].effort_nm);
    EXPECT_EQ(ours.joints[i].stiffness_nm_rad, built.joints[i].stiffness_nm_rad);
    EXPECT_EQ(ours.joints[i].actuator.counts_per_m, built.joints[i].actuator.counts_per_m);
    EXPECT_EQ(ours.joints[i].actuator.counts_per_rad, built.joints[i].actuator.counts_per_rad);
  }
  for (std::size_t i = 0; i < arm5e_joint::count + 1; ++i) EXPECT_TRUE(ours.origins[i].isApprox(built.origins[i], 1e-12)) << i;
  EXPECT_NEAR(ours.jaw.pivot_x_m, built.jaw.pivot_x_m, 1e-12);
  EXPECT_NEAR(ours.jaw.pivot_z_m, built.jaw.pivot_z_m, 1e-12);
  EXPECT_NEAR(ours.jaw.face_x_m, built.jaw.face_x_m, 1e-12);
  EXPECT_NEAR(ours.jaw.face_z_m, built.jaw.face_z_m, 1e-12);
  ASSERT_EQ(ours.capsules.size(), built.capsules.size());
  for (std::size_t i = 0; i < ours.capsules.size(); ++i) expect_same(ours.capsules[i], built.capsules[i]);
}

// The description as a chain of plain transforms, joint after joint.
Pose tool_of(const ArmDescription& arm, const arm::JointVector& q) {
  Pose base_from_body = Pose::Identity();
  for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i)
    base_from_body =
        base_from_body * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], arm.joints[i].axis);
  return base_from_body * arm.wrist_from_tool;
}

// Arms of the form that nobody chose: their tools stand where their URDF puts them, and inverse kinematics finds each pose again.
TEST(MakeModel, OfDrawnArmsTheToolIsWhereTheUrdfPutsIt) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  for (int draw = 0; draw < 300; ++draw) {
    const test::DrawnArm drawn(random);
    const ArmDescription description = load_arm_urdf(drawn.path());
    const arm::Arm arm(make_model(description));
    for (int pose = 0; pose < 100; ++pose) {
      const arm::JointVector q = drawn.posture(description, random);
      const Pose tool = tool_of(description, q);
      ASSERT_TRUE(arm.base_from_tool(q).isApprox(tool, 1e-9)) << "draw " << draw << ", " << q.transpose();
      const arm::IkResult same = arm::inverse_kinematics(arm, arm::posture_of(arm, q), tool.translation(), q[3], 0);
      ASSERT_TRUE(same.ok()) << "draw " << draw << ", " << q.transpose() << ": " << arm::name(same.outcome) << " by " << same.excess;
      ASSERT_LT((same.q_rad - q).cwiseAbs().maxCoeff(), 1e-6) << "draw " << draw;
      const arm::IkResult any = arm::inverse_kinematics(arm, tool.translation(), q[3], 0);
      ASSERT_TRUE(any.ok()) << "draw " << draw;
      ASSERT_LT((arm.base_from_tool(any.q_rad).translation() - tool.translation()).norm(), 1e-9) << "draw " << draw;
      const arm::IkResult near = arm::inverse_kinematics(arm, tool.translation(), q[3], 0, q);
      ASSERT_LT((near.q_rad - q).cwiseAbs().maxCoeff(), 1e-6) << "draw " << draw;
    }
  }
}

// Each pad's face, carried by its finger as the description has it, is as far off the tool's plane as the jaw's numbers say.
TEST(MakeModel, OfDrawnArmsThePadsStandWhereTheUrdfPutsThem) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed + 1);
  for (int draw = 0; draw < 100; ++draw) {
    const test::DrawnArm drawn(random);
    const ArmDescription description = load_arm_urdf(drawn.path());
    const arm::Arm arm(make_model(description));
    const ArmJoint& jaw = description.joints[arm5e_joint::jaw];
    for (const double share : {0.0, 0.3, 0.7, 1.0}) {
      const double jaw_rad = std::lerp(jaw.lower_rad, jaw.upper_rad, share);
      const auto face = [&](const ArmJoint& joint, double side) {
        const Vec3 in_finger = description.pad.body_from_shape.translation().cwiseProduct(Vec3(side, 1, 1)) +
                               Vec3(side * description.pad.size_m.x() / 2, 0, 0);
        return Vec3(description.wrist_from_tool.inverse() * joint.parent_from_joint * Eigen::AngleAxisd(jaw_rad, joint.axis) * in_finger);
      };
      const Vec3 a = face(jaw, 1), b = face(description.finger_b, -1);
      ASSERT_NEAR(arm::gap_from_jaw(arm.jaw(), jaw_rad), b.x() - a.x(), 1e-12) << "draw " << draw;
      ASSERT_NEAR(arm::jaw_from_gap(arm.jaw(), b.x() - a.x()), jaw_rad, 1e-6) << "draw " << draw;
    }
  }
}

// What collides lies within the core's capsules: all points of the surface of each shape.
TEST(MakeModel, CapsulesContainWhatCollides) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed + 2);
  std::uniform_real_distribution<double> unit(-1, 1);
  const ArmDescription description = shipped();
  const ArmModel model = make_model(description);
  std::size_t next = 0;
  for (std::size_t link = 1; link < arm5e_joint::links; ++link) {
    for (const scene::Shape& shape : description.links[link].shapes) {
      if (!shape.collides) continue;
      ASSERT_LT(next, model.capsules.size());
      const ArmModel::Capsule& capsule = model.capsules[next++];
      ASSERT_EQ(capsule.link(), link);
      for (int i = 0; i < 2000; ++i) {
        Vec3 p(unit(random), unit(random), unit(random));
        if (shape.kind == scene::ShapeKind::box) {
          p = p.cwiseProduct(shape.size_m / 2);
        } else if (shape.kind == scene::ShapeKind::cylinder) {
          const double angle = pi * p.x(), radius = shape.size_m.x() * std::abs(p.y());
          p = Vec3(radius * std::cos(angle), radius * std::sin(angle), p.z() * shape.size_m.z() / 2);
        } else {
          p = p.normalized() * shape.size_m.x();
        }
        p = shape.body_from_shape * p;
        const Vec3 way = capsule.b_m() - capsule.a_m();
        const double length2 = way.squaredNorm();
        const double along = length2 > 0 ? std::clamp((p - capsule.a_m()).dot(way) / length2, 0.0, 1.0) : 0.0;
        ASSERT_LE((capsule.a_m() + along * way - p).norm(), capsule.radius_m()) << description.links[link].name;
      }
    }
  }
  EXPECT_EQ(next, model.capsules.size());
}

}  // namespace
}  // namespace lf
