// An arm whose last joint swings its hand: what of its description the core gets, against the product of the description's own transforms, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "firmware/arm/collision.hpp"
#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/changed_text.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf {
namespace {

const std::string file = LANTERNFISH_SOURCE_DIR "/shared/arm/predator/predator.urdf";

class NoRoll : public testing::Test {
 protected:
  // base_from_link of the description, as its file has it: link 0 is the base.
  Pose base_from_link(std::size_t link, const arm::JointVector& q) const {
    Pose pose = Pose::Identity();
    for (std::size_t i = 0; i < link; ++i)
      pose =
          pose * description.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], description.joints[i].axis);
    return pose;
  }
  arm::JointVector draw() {
    arm::JointVector q = arm::JointVector::Zero();
    for (std::size_t i = 0; i < arm.arm_joints(); ++i)
      q[static_cast<Eigen::Index>(i)] = std::uniform_real_distribution<double>(arm.joint(i).lower_rad, arm.joint(i).upper_rad)(random);
    return q;
  }

  static constexpr std::uint64_t seed = 20261129;
  std::mt19937_64 random{seed};
  ArmDescription description = load_arm_urdf(file);
  arm::Arm arm{make_model(description)};
};

TEST_F(NoRoll, IsToldByItsLastJointsAxis) {
  EXPECT_FALSE(description.rolls);
  EXPECT_FALSE(arm.rolls());
  EXPECT_EQ(arm.pointing_joints(), 5u);
  EXPECT_TRUE(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/oberon7/oberon7.urdf").rolls);
  EXPECT_TRUE(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf").rolls);
}

TEST_F(NoRoll, ToolLaserAndPadsAreCarriedByTheLastLink) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  LaserCalibration laser;
  laser.tool_from_laser = Pose(Eigen::Translation3d(0.01, 0.12, -0.3) * Eigen::AngleAxisd(-1.5, Vec3::UnitZ()));
  for (int k = 0; k < 100; ++k) {
    const arm::JointVector q = draw();
    const Pose hand = base_from_link(description.arm_joints(), q), tool = hand * description.wrist_from_tool;
    ASSERT_LT((arm.base_from_tool(q).matrix() - tool.matrix()).norm(), 1e-12);
    ASSERT_LT((arm.base_from_unrolled_tool(q).matrix() - tool.matrix()).norm(), 1e-12);
    ASSERT_LT((arm.base_from_laser(q, laser).matrix() - (tool * laser.tool_from_laser).matrix()).norm(), 1e-12);
    ASSERT_LT((hand * description.laser_link_from_tool().matrix() - tool.matrix()).norm(), 1e-12);
    // A point of each finger, carried by the description and by the core.
    const double jaw_rad = 0.4;
    const arm::LinkPoses links = arm.base_from_links(q, jaw_rad);
    const Vec3 in_finger_m(0.03, 0.01, 0.09);
    const Vec3 a_m = hand * description.jaw().parent_from_joint * Eigen::AngleAxisd(jaw_rad, description.jaw().axis) * in_finger_m;
    const Vec3 b_m = hand * description.finger_b.parent_from_joint * Eigen::AngleAxisd(jaw_rad, description.finger_b.axis) * in_finger_m;
    ASSERT_LT((links[arm.jaw_joint()] * in_finger_m - a_m).norm(), 1e-12);
    ASSERT_LT((links[arm.jaw_joint() + 1] * in_finger_m - b_m).norm(), 1e-12);
  }
}

TEST_F(NoRoll, JacobianIsWhatSmallTurnsDo) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  constexpr double h = 1e-6;
  for (int k = 0; k < 50; ++k) {
    const arm::JointVector q = draw();
    const arm::Jacobian jacobian = arm.jacobian(q);
    for (Eigen::Index i = 0; i < 5; ++i) {
      arm::JointVector more = q, less = q;
      more[i] += h, less[i] -= h;
      const Pose after = base_from_link(5, more) * description.wrist_from_tool,
                 before = base_from_link(5, less) * description.wrist_from_tool;
      ASSERT_LT(((after.translation() - before.translation()) / (2 * h) - jacobian.col(i).head<3>()).norm(), 1e-7) << i;
      const Eigen::AngleAxisd turn(after.linear() * before.linear().transpose());
      ASSERT_LT((turn.angle() * turn.axis() / (2 * h) - jacobian.col(i).tail<3>()).norm(), 1e-7) << i;
    }
  }
}

// Swung far enough, fingers meet the link before the hand: no roll keeps them off.
TEST_F(NoRoll, ItsFingersAreHeldAgainstTheLinkBeforeTheHand) {
  ArmModel model = make_model(description);
  for (ArmModel::Capsule& capsule : model.capsules) {
    if (capsule.link() == 4)
      capsule = ArmModel::Capsule(4, Vec3(0.1, 0, 0), Vec3(0.6, 0, 0), 0.05);  // as if the wrist reached past the hand
  }
  const arm::Arm long_wrist(model);
  arm::JointVector q = arm::JointVector::Zero();
  EXPECT_LT(arm::clearance_to_itself(long_wrist.link_capsules(q, 0)), 0);
  model.rolls = true;
  EXPECT_GT(arm::clearance_to_itself(arm::Arm(model).link_capsules(q, 0)), 0) << "a jaw that rolls opens ahead of it";
}

class Told : public testing::Test {
 protected:
  std::string complaint(const std::string& text) {
    try {
      (void)load_arm_urdf(folder.write("arm.urdf", text));
    } catch (const InputError& refused) {
      return refused.what();
    }
    return "";
  }
  test::TemporaryFolder folder;
  std::string urdf = (std::ostringstream() << std::ifstream(file).rdbuf()).str();
};

// Between rolling and swinging it would do both.
TEST_F(Told, AHandThatRollsAslantIsRefused) {
  const auto with_axis = [&](const char* axis) {
    std::string changed = urdf;
    test::change(changed, "<axis xyz=\"0 1 0\"/>", std::string("<axis xyz=\"") + axis + "\"/>");
    return complaint(changed);
  };
  EXPECT_THAT(with_axis("0 0.4 0.916515138991168"), testing::HasSubstr("'wrist_yaw' must turn about its own z, and so roll the tool"));
  EXPECT_EQ(with_axis("0 0.6 0.8"), "");
  EXPECT_EQ(with_axis("0.6 0.8 0"), "");
}

TEST_F(Told, EightJointsWithoutARollAreMoreThanTheCoreHolds) {
  const std::size_t begin = urdf.find("  <link name=\"wrist\">"), end = urdf.find("</link>\n", begin) + 8;
  const std::string link = urdf.substr(begin, end - begin);
  const std::size_t from = urdf.find("  <joint name=\"pitch\""), to = urdf.find("</joint>\n", from) + 9;
  const std::string joint = urdf.substr(from, to - from);
  std::string parent = "wrist", longer = urdf;
  for (const std::string name : {"one", "two", "three"}) {
    std::string more_link = link, more_joint = joint;
    test::change(more_link, "\"wrist\"", "\"" + name + "_link\"");
    test::change(more_joint, "\"pitch\"", "\"" + name + "\"");
    test::change(more_joint, "<parent link=\"forearm\"/>", "<parent link=\"" + parent + "\"/>");
    test::change(more_joint, "<child link=\"wrist\"/>", "<child link=\"" + name + "_link\"/>");
    test::change(longer, "  <joint name=\"azimuth\"", more_link + more_joint + "  <joint name=\"azimuth\"");
    test::change(longer, "<parent link=\"" + parent + "\"/>\n    <child link=\"hand\"/>",
                 "<parent link=\"" + name + "_link\"/>\n    <child link=\"hand\"/>");
    parent = name + "_link";
    const std::string told = complaint(longer);
    EXPECT_EQ(told.empty(), name != "three") << name << ": " << told;
  }
  EXPECT_THAT(complaint(longer), testing::HasSubstr("has 8 joints and none that rolls the tool: the core holds 7 of such an arm"));
}

}  // namespace
}  // namespace lf
