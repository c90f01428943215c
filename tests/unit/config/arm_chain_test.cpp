// The core's chains of arms that others describe, against what Orocos KDL 1.5.1 computed of the same files (fk.csv beside each).
#include "hal/config/arm_chain.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "shared/input_error.hpp"
#include "shared/urdf/read_urdf.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::config {
namespace {

struct Arm {
  std::string name, tool;
  std::size_t joints;
};

void PrintTo(const Arm& arm, std::ostream* stream) { *stream << arm.name; }

urdf::Mechanism mechanism_of(const std::string& name) {
  return urdf::read_urdf(LANTERNFISH_TEST_DATA "/arms/" + name + "/" + name + ".urdf").mechanism;
}

class ArmChains : public testing::TestWithParam<Arm> {};

INSTANTIATE_TEST_SUITE_P(Files, ArmChains,
                         testing::Values(Arm{"oberon7", "tool", 6}, Arm{"predator", "tool", 5}, Arm{"ur5", "tool0", 6},
                                         Arm{"panda", "tool", 7}, Arm{"open_manipulator_x", "end_effector_link", 4}),
                         [](const auto& test) { return test.param.name; });

TEST_P(ArmChains, HaveTheToolWhereKdlHasIt) {
  const urdf::Mechanism mechanism = mechanism_of(GetParam().name);
  const ArmChain arm = arm_chain(mechanism, {.base_link = "", .tool_link = GetParam().tool});
  ASSERT_EQ(arm.joints.size(), GetParam().joints);
  ASSERT_EQ(arm.chain.size(), GetParam().joints);
  std::ifstream file(LANTERNFISH_TEST_DATA "/arms/" + GetParam().name + "/fk.csv");
  std::string line, cell;
  ASSERT_TRUE(std::getline(file, line));
  std::istringstream header(line);
  for (const std::size_t joint : arm.joints) {
    ASSERT_TRUE(std::getline(header, cell, ','));
    EXPECT_EQ(cell, mechanism.joints[joint].name);
  }
  int rows = 0;
  for (; std::getline(file, line); ++rows) {
    std::istringstream row(line);
    std::vector<double> values;
    while (std::getline(row, cell, ',')) values.push_back(std::stod(cell));
    ASSERT_EQ(values.size(), arm.joints.size() + 7);
    chain::JointValues q = chain::JointValues::Zero();
    for (std::size_t i = 0; i < arm.joints.size(); ++i) q[Eigen::Index(i)] = values[i];
    const double* at = values.data() + arm.joints.size();
    const Pose tool = arm.chain.base_from_tool(q);
    EXPECT_LT((tool.translation() - Vec3(at[0], at[1], at[2])).norm(), 3e-12) << "row " << rows;
    EXPECT_LT((tool.linear() - Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized().toRotationMatrix()).norm(), 1e-11)
        << "row " << rows;
  }
  EXPECT_GE(rows, 4);
}

TEST_P(ArmChains, HaveTheFilesLimits) {
  const urdf::Mechanism mechanism = mechanism_of(GetParam().name);
  const ArmChain arm = arm_chain(mechanism, {.base_link = "", .tool_link = GetParam().tool});
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const urdf::Joint& joint = mechanism.joints[arm.joints[i]];
    EXPECT_EQ(arm.chain.joint(i).limited, joint.range.has_value()) << joint.name;
    if (!joint.range) continue;
    EXPECT_EQ(arm.chain.joint(i).lower, joint.range->lower) << joint.name;
    EXPECT_EQ(arm.chain.joint(i).upper, joint.range->upper) << joint.name;
  }
}

TEST(ArmChain, BeginsAtTheGivenLinkAndTurnsTheToolAsItIsTold) {
  const urdf::Mechanism mechanism = mechanism_of("ur5");
  const chain::JointValues zero = chain::JointValues::Zero();
  const ArmChain whole = arm_chain(mechanism, {}),
                 turned = arm_chain(mechanism, {.base_link = "", .tool_link = "", .approach = "x", .opening = "-z"});
  const Mat3 before = whole.chain.base_from_tool(zero).linear(), after = turned.chain.base_from_tool(zero).linear();
  EXPECT_LT((after.col(2) - before.col(0)).norm(), 1e-15);
  EXPECT_LT((after.col(0) + before.col(2)).norm(), 1e-15);
  EXPECT_NEAR(after.determinant(), 1, 1e-15);
  const ArmChain upper = arm_chain(mechanism, {.base_link = "upper_arm_link", .tool_link = "tool0"});
  EXPECT_EQ(upper.joints.size(), 4u);
  EXPECT_EQ(mechanism.joints[upper.joints.front()].name, "elbow_joint");
}

std::string refusal(const urdf::Mechanism& mechanism, const ArmEnds& ends) {
  try {
    (void)arm_chain(mechanism, ends);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ArmChain, IsRefusedWithTheCause) {
  const urdf::Mechanism ur5 = mechanism_of("ur5"), gripper = mechanism_of("open_manipulator_x");
  const auto says = [](const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(says(refusal(ur5, {.base_link = "", .tool_link = "tool1"}), "tool1"))
      << refusal(ur5, {.base_link = "", .tool_link = "tool1"});
  EXPECT_TRUE(says(refusal(ur5, {.base_link = "tool0", .tool_link = "base_link"}), "'tool0' does not carry 'base_link'"));
  EXPECT_TRUE(says(refusal(ur5, {.base_link = "tool0", .tool_link = "tool0"}), "no joint moves"));
  EXPECT_TRUE(says(refusal(ur5, {.base_link = "", .tool_link = "", .approach = "up", .opening = "x"}), "up"));
  EXPECT_TRUE(says(refusal(gripper, {}), "say which link is the tool")) << refusal(gripper, {});
  const std::string mimics = refusal(gripper, {.base_link = "", .tool_link = "gripper_right_link"});
  EXPECT_TRUE(says(mimics, "mimics 'gripper_left_joint'")) << mimics;
  EXPECT_TRUE(says(mimics, "open_manipulator_x.urdf:1")) << mimics;
}

TEST(ArmChain, WhoseToolCannotMoveIsRefused) {
  const urdf::Mechanism ur5 = mechanism_of("ur5");
  // The first link turns about its own origin; the second's joint is 0.1 m beside it.
  const std::string said = refusal(ur5, {.base_link = "", .tool_link = "shoulder_link"});
  EXPECT_NE(said.find("the tool cannot move: link 'shoulder_link' has its origin on the axis of each joint from 'base_link' on"),
            std::string::npos)
      << said;
  EXPECT_EQ(refusal(ur5, {.base_link = "", .tool_link = "forearm_link"}), "");
}

TEST(ArmChain, OfTooManyJointsIsRefusedWithTheLimitAndTheCount) {
  for (const int count : {8, 9, 30}) {
    std::string text = "<robot name=\"snake\">\n<link name=\"l0\"/>\n";
    for (int i = 1; i <= count; ++i) {
      const std::string n = std::to_string(i);
      text += "<link name=\"l" + n + "\"/>\n<joint name=\"j" + n + "\" type=\"revolute\"><parent link=\"l" + std::to_string(i - 1) +
              "\"/><child link=\"l" + n +
              "\"/><origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"1\"/></joint>\n";
    }
    const test::TemporaryFolder folder;
    folder.write("snake.urdf", text + "</robot>\n");
    const std::string said = refusal(urdf::read_urdf(folder / "snake.urdf").mechanism, {});
    if (count <= 8)
      EXPECT_EQ(said, "");
    else
      EXPECT_NE(said.find(std::to_string(count) + " joints move between 'l0' and 'l" + std::to_string(count) + "', an arm has 8 at most"),
                std::string::npos)
          << said;
  }
}

}  // namespace
}  // namespace lf::config
